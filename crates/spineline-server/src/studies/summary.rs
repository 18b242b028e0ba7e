//! Studies and films in the list of studies.

use spineline::anatomy::{FilmView, ImageSide};
use spineline::measure::ImageGeometry;
use spineline_store::{FilmId, FilmRecord, Role, Store, Study, Visibility};

use crate::api::{FilmSummary, ReadingSummary, StudyStatus, StudySummary, Wire};
use crate::overview_cache::Overview;
use crate::problem::Answer;
use crate::readings::withdrawal_view;
use crate::state::AppState;
use crate::user::User;
use crate::{results, words};

/// A study in the list, as this user may see it.
pub fn study_summary(
    state: &AppState,
    store: &Store,
    user: &User,
    role: Role,
    study: &Study,
) -> Answer<StudySummary> {
    let changed = store.last_change(&study.id)?;
    let overview = state.overviews.of(store, &study.id, changed.sequence)?;
    let visibility = store.observer(&user.name).visibility(&study.id)?;
    let mut results = results::summary(&state.results, store, user, &study.id)?;
    if matches!(results.status, StudyStatus::ToMark | StudyStatus::Marking) {
        // Landmarks of unfinished readings count as progress.
        (results.status, results.status_text) = overview.status.clone();
    }
    let films = match visibility {
        // Postures would reveal the film.
        Visibility::Reader => Vec::new(),
        Visibility::Open | Visibility::Apart => overview
            .films
            .iter()
            .map(|film| summary_of(film, &overview, user, visibility))
            .collect(),
    };
    Ok(StudySummary {
        id: study.id.to_string(),
        label: study.label.clone().filter(|_| visibility != Visibility::Reader),
        synthetic: study.synthetic,
        archived: study.archived,
        revision: study.revision,
        role: Wire(role),
        results,
        films,
        changed_ms: store.observer(&user.name).last_change(&study.id)?.at.unix_ms(),
    })
}

/// One film of a study whose readings this user may see, or which are left out.
pub fn film_summary(
    state: &AppState,
    store: &Store,
    user: &User,
    film: FilmId,
) -> Answer<FilmSummary> {
    let film = store.film(film)?;
    let changed = store.last_change(&film.study)?;
    let overview = state.overviews.of(store, &film.study, changed.sequence)?;
    let visibility = store.observer(&user.name).visibility(&film.study)?;
    Ok(summary_of(&film, &overview, user, visibility))
}

const UNREADABLE: ImageGeometry =
    ImageGeometry { columns: 0, rows: 0, spacing: None, patient_left: ImageSide::Left };

fn summary_of(
    film: &FilmRecord,
    overview: &Overview,
    user: &User,
    visibility: Visibility,
) -> FilmSummary {
    // A film with an invalid record must not hide all studies.
    let image = film.geometry().unwrap_or(UNREADABLE);
    let readings = overview.readings.iter().filter(|reading| reading.film == film.id);
    let readings =
        readings.filter(|_| visibility == Visibility::Open).map(|reading| ReadingSummary {
            reading: reading.id.0,
            observer: reading.observer.to_string(),
            repeat: reading.repeat,
            mine: reading.observer == user.name,
            finished: reading.finished_at.is_some(),
            withdrawn: reading.withdrawn.as_ref().map(withdrawal_view),
            corrects: reading.corrects.map(|corrected| corrected.0),
            complete_levels: overview.complete.get(&reading.id).copied().unwrap_or(0),
        });
    FilmSummary {
        film: film.id.0,
        posture: Wire(film.view),
        image: words::image_of(&image, film.view == FilmView::Lateral, film.inverted),
        row_mm: image.scale().map(|spacing| spacing.row_mm),
        checked: film.stated.checked,
        revision: film.revision,
        readings: readings.collect(),
    }
}
