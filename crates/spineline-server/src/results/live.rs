//! Results of a reading together with the other films of its study.

use std::slice;

use axum::extract::State;
use spineline::analysis::check_repeated;
use spineline::anatomy::{FilmView, Level, Posture};
use spineline::error::Error;
use spineline::measure::{check_landmarks, judge_reading};
use spineline::warning::Warnings;
use spineline_store::{
    CaseReadings, CurrentCase, CurrentFilm, Event, FilmId, Name, ReadingId, Store,
};

use super::{findings, heights, notices, overlay};
use crate::access::{blinded, seen_reading};
use crate::api::{FilmOverlay, LiveStatus, LiveView, Notice, Problem, Severity, Wire};
use crate::extract::{Json, Path};
use crate::problem::Answer;
use crate::result_cache::{Outcome, StudyResult, computed};
use crate::state::AppState;
use crate::user::User;
use crate::words::{marked_text, progress};

/// Results of the current reading.
#[utoipa::path(get, path = "/api/readings/{reading}/live", params(("reading" = i64, Path)),
    responses((status = 200, body = LiveView), Problem))]
pub async fn live(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
) -> Answer<Json<LiveView>> {
    let found = state.ask(move |store| in_hand(store, &user, ReadingId(reading), &[]));
    followed(found.await?).await?.map(Json).ok_or_else(blinded)
}

/// The study of an open reading, prepared for results.
pub struct InHand {
    study: Name,
    film: FilmId,
    current: CurrentCase,
}

/// The study of a reading with unrecorded events; `None` where results are hidden from the requester.
pub fn in_hand(
    store: &Store,
    user: &User,
    reading: ReadingId,
    pending: &[Event],
) -> Answer<Option<InHand>> {
    let seen = seen_reading(store, user, reading)?;
    if seen.code.is_some() {
        return Ok(None);
    }
    let (study, film) = (seen.study.id, seen.film.id);
    let current = store.current_case(&study, CaseReadings::InHand { reading, pending })?;
    Ok(Some(InHand { study, film, current }))
}

/// Results for the film of the reading; the store is not locked during the computation.
pub async fn followed(hand: Option<InHand>) -> Answer<Option<LiveView>> {
    let Some(InHand { study, film, current }) = hand else { return Ok(None) };
    computed(move || of_film(&StudyResult::of(&study, current), film)).await.map(Some)
}

/// Results for one film of a study. The lateral film has no fitted curve to draw.
fn of_film(result: &StudyResult, film: FilmId) -> LiveView {
    let hand = result.current.film(film);
    let view = hand.map_or(FilmView::Frontal(Posture::Erect), |hand| hand.record.view);
    let missing = hand.map(CurrentFilm::missing).unwrap_or_default();
    let fault = match view {
        FilmView::Frontal(posture) => fault_of(result, posture),
        FilmView::Lateral => lateral_fault(result),
    };
    let (status, status_text) = status(result, &missing, fault.as_ref());
    LiveView {
        status,
        status_text,
        overlay: hand.filter(|_| fault.is_none()).and_then(|hand| drawn(result, hand)),
        heights: heights::on_film(&result.current, view),
        study: result.analysis().map(findings::of_study),
        options_text: result.options_text(),
        notices: film_notices(result, view, fault.as_ref()),
    }
}

/// Why the lateral film cannot be measured, or repeats another film.
fn lateral_fault(result: &StudyResult) -> Option<Error> {
    let case = &result.current.case;
    let film = case.lateral.as_ref()?;
    if let Err(error) = film.measure(&mut Warnings::default()) {
        return Some(error.into());
    }
    let mut frontal = case.films.iter().map(slice::from_ref);
    frontal.find_map(|one| check_repeated(one, Some(film)).err()).map(Error::from)
}

/// Why the film of the reading cannot be measured, or repeats another film.
fn fault_of(result: &StudyResult, posture: Posture) -> Option<Error> {
    let landmarks = result.current.landmarks(posture)?;
    if let Err(error) = check_landmarks(landmarks) {
        return Some(error.into());
    }
    // The error names another film of the study if its reading is open.
    let films = &result.current.case.films;
    let others = films.iter().filter(|film| film.posture != posture);
    let pairs = others.map(|other| [other.clone(), landmarks.clone()]);
    let lateral = result.current.case.lateral.as_ref();
    let beside_lateral = || check_repeated(slice::from_ref(landmarks), lateral).err();
    let repeated = pairs.map(|pair| check_repeated(&pair, None)).find_map(Result::err);
    repeated.or_else(beside_lateral).map(Error::from)
}

fn status(result: &StudyResult, missing: &[Level], fault: Option<&Error>) -> (LiveStatus, String) {
    if let Some(fault) = fault {
        return (LiveStatus::Refused, fault.to_string());
    }
    let marked = marked_text(missing);
    match &result.outcome {
        Outcome::Refused { text, .. } => (LiveStatus::Refused, text.clone()),
        _ if !missing.is_empty() => (LiveStatus::Partial, marked),
        Outcome::Analysed(_) => (LiveStatus::Complete, marked),
        Outcome::Waiting => {
            let text =
                format!("{marked}; no results of the study yet: {}", progress(&result.current));
            (LiveStatus::Complete, text)
        }
    }
}

/// Notices of a study during a reading of one of its films, without the notice that this film is incomplete, which its status
/// contains.
fn film_notices(result: &StudyResult, view: FilmView, fault: Option<&Error>) -> Vec<Notice> {
    let name = view.posture().map(Wire);
    let mut notices = notices::of_result(result);
    notices.retain(|n| !(n.code == "film_left_out" && n.posture == name));
    if let Some(fault) = fault {
        let text = format!("{fault}: {}", fault.help());
        let mut notice = Notice::new(Severity::Error, fault.code(), text);
        notice.posture = name;
        notices.retain(|other| other.severity != Severity::Error);
        notices.insert(0, notice);
    } else if let Some(compared) = &result.current.compared {
        // The analysis does not include the other readings of this film.
        notices::add_new(&mut notices, &judge_reading(&compared.film, &compared.id));
    }
    notices::sorted(notices)
}

/// An overlay of a film from the finished readings of its study.
pub fn overlay_of(result: &StudyResult, film: FilmId) -> Option<FilmOverlay> {
    drawn(result, result.current.film(film)?)
}

/// The overlay of a frontal film that takes part in the analysis.
fn drawn(result: &StudyResult, film: &CurrentFilm) -> Option<FilmOverlay> {
    let posture = film.record.view.posture()?;
    film.is_usable().then(|| overlay::of_film(result, posture)).flatten()
}
