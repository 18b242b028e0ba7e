//! What the list of studies shows, kept until a study changes.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

use spineline::anatomy::{ImageSide, Level, Posture};
use spineline::measure::ImageGeometry;
use spineline_store::{
    FilmId, FilmRecord, Name, ReadingId, ReadingRecord, ReadingState, Role, Sight, Store,
    StoreError, Study,
};

use super::super::api::{FilmSummary, ReadingSummary, StudyStatus, StudySummary, Wire};
use super::super::{Answer, AppState, User, results, words};

/// What is known of studies as they were at a number of the log.
#[derive(Default)]
pub struct Overviews(Mutex<HashMap<String, (i64, Arc<Overview>)>>);

/// All that a list needs of a study, whoever asks.
struct Overview {
    films: Vec<FilmRecord>,
    readings: Vec<ReadingRecord>,
    /// Vertebrae of L4 to T2 with four corners.
    complete: BTreeMap<ReadingId, u32>,
    status: (StudyStatus, String),
}

impl Overview {
    /// The count of a reading that was finished already and so has not changed.
    fn final_count(&self, reading: &ReadingRecord) -> Option<u32> {
        let known = self.readings.iter().find(|known| known.id == reading.id)?;
        known.finished_at?;
        self.complete.get(&reading.id).copied()
    }
}

impl Overviews {
    fn of(&self, store: &Store, study: &Name, sequence: i64) -> Result<Arc<Overview>, StoreError> {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = known().get(study.as_str()).cloned();
        if let Some((at, overview)) = &before
            && *at == sequence
        {
            return Ok(overview.clone());
        }
        let (films, readings) = (store.films(study)?, store.readings(study)?);
        let mut complete = BTreeMap::new();
        for reading in &readings {
            let counted = before.as_ref().and_then(|(_, overview)| overview.final_count(reading));
            let count = match counted {
                Some(count) => count,
                None => complete_levels(&store.reading_state(reading.id)?),
            };
            complete.insert(reading.id, count);
        }
        let status = status_of(&films, &readings, &complete);
        let overview = Arc::new(Overview { films, readings, complete, status });
        known().insert(study.to_string(), (sequence, overview.clone()));
        Ok(overview)
    }
}

fn complete_levels(state: &ReadingState) -> u32 {
    let of_model = state.vertebrae.iter().filter(|(level, _)| level.model_index().is_some());
    of_model.filter(|(_, marks)| marks.is_complete()).count() as u32
}

/// How far a study has come, from its marks alone.
fn status_of(
    films: &[FilmRecord],
    readings: &[ReadingRecord],
    complete: &BTreeMap<ReadingId, u32>,
) -> (StudyStatus, String) {
    let all = Level::MODEL.len();
    let erect = films.iter().filter(|film| film.posture == Posture::Erect);
    let best = erect
        .flat_map(|film| readings.iter().filter(|reading| reading.film == film.id))
        .filter_map(|reading| complete.get(&reading.id).copied())
        .max()
        .unwrap_or(0);
    if best as usize == all {
        (
            StudyStatus::Marking,
            format!("all {all} vertebrae on the erect film; no finished reading"),
        )
    } else if best > 0 || complete.values().any(|&count| count > 0) {
        (StudyStatus::Marking, format!("{best} of {all} vertebrae on the erect film"))
    } else {
        (StudyStatus::ToMark, "no vertebra is marked yet".to_owned())
    }
}

/// A study in the list, as this user may see it.
pub fn study_summary(
    state: &AppState,
    store: &Store,
    user: &User,
    role: Role,
    study: &Study,
) -> Answer<StudySummary> {
    let changed = store.last_change(&study.id)?;
    let overview = state.studies().of(store, &study.id, changed.sequence)?;
    let sight = store.observer(&user.name).sight(&study.id)?;
    let found = results::summary(state.results(), store, user, &study.id)?;
    let (status, status_text) = match found.status {
        // Marks that nobody has finished count as progress.
        StudyStatus::ToMark | StudyStatus::Marking => overview.status.clone(),
        status => (status, found.status_text),
    };
    let films = match sight {
        // Postures would unblind.
        Sight::Reader => Vec::new(),
        Sight::Open | Sight::Apart => {
            overview.films.iter().map(|film| summary_of(film, &overview, user, sight)).collect()
        }
    };
    Ok(StudySummary {
        id: study.id.to_string(),
        label: study.label.clone(),
        synthetic: study.synthetic,
        role: Wire(role),
        status,
        status_text,
        films,
        curve: found.curve,
        warnings: found.warnings,
        contradictions: found.contradictions,
        changed_ms: changed.at.unix_ms(),
    })
}

/// One film of a study in which readings are not hidden from this user, or are left out.
pub fn film_summary(
    state: &AppState,
    store: &Store,
    user: &User,
    film: FilmId,
) -> Answer<FilmSummary> {
    let film = store.film(film)?;
    let changed = store.last_change(&film.study)?;
    let overview = state.studies().of(store, &film.study, changed.sequence)?;
    let sight = store.observer(&user.name).sight(&film.study)?;
    Ok(summary_of(&film, &overview, user, sight))
}

const UNREADABLE: ImageGeometry =
    ImageGeometry { columns: 0, rows: 0, spacing: None, patient_left: ImageSide::Left };

fn summary_of(film: &FilmRecord, overview: &Overview, user: &User, sight: Sight) -> FilmSummary {
    // One film that another program described must not hide all studies.
    let image = spineline_files::parse_image(&film.image, film.posture).unwrap_or(UNREADABLE);
    let readings = overview.readings.iter().filter(|reading| reading.film == film.id);
    let readings = readings.filter(|_| sight == Sight::Open).map(|reading| ReadingSummary {
        reading: reading.id.0,
        observer: reading.observer.to_string(),
        repeat: reading.repeat,
        mine: reading.observer == user.name,
        finished: reading.finished_at.is_some(),
        complete_levels: overview.complete.get(&reading.id).copied().unwrap_or(0),
    });
    FilmSummary {
        film: film.id.0,
        posture: Wire(film.posture),
        columns: image.columns,
        rows: image.rows,
        pixel_aspect: words::pixel_aspect(image.spacing),
        plane: words::plane_of(&image),
        row_mm: image.spacing.map(|spacing| spacing.row_mm),
        spacing_text: words::spacing_text(image.spacing),
        patient_left: Wire(image.patient_left),
        inverted: film.inverted,
        revision: film.revision,
        readings: readings.collect(),
    }
}
