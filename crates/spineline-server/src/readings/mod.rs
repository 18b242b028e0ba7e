//! Readings: begin, record, undo, finish, withdraw, correct.

mod detection;
mod erect;
mod landmarks;
mod lost;
mod markable;
mod view;

use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use spineline_store::{FilmCode, FilmId, ReadingId, Role, SeenReading, Store, StoreError};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::{seen_film, seen_reading};
use crate::api::{
    Change, ConflictAnswer, Finish, FinishedReading, NewReading, NewWithdrawal, Problem,
    ReadingView,
};
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::state::AppState;
use crate::user::User;

pub use lost::{
    of_film as lost_of_film, of_options as lost_of_options, of_reading as lost_of_reading,
    of_study as lost_of_study,
};
pub use markable::may_mark;
use markable::{Markable, markable};
use view::{need_sound, view_after_loss};
pub use view::{view, withdrawal_view};

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(begin))
        .routes(routes!(begin_planned))
        .routes(routes!(reading))
        .routes(routes!(finish))
        .routes(routes!(withdraw))
        .routes(routes!(correct))
        .routes(routes!(detection::detection))
        .routes(routes!(detection::misfits))
}

/// Begins a reading of a film.
#[utoipa::path(post, path = "/api/films/{film}/readings", params(("film" = i64, Path)), request_body = NewReading,
    responses((status = 200, body = ReadingView), Problem))]
async fn begin(
    State(state): State<AppState>,
    user: User,
    Path(film): Path<i64>,
    Json(new): Json<NewReading>,
) -> Answer<Json<ReadingView>> {
    let by = user.sign();
    let asker = state.clone();
    let view = state.ask(move |store| {
        let film = seen_film(store, &user, FilmId(film))?;
        user.need_on_study(store, &film.study, Role::Editor)?;
        let id = store.begin_reading(film.id, new.repeat, &by)?;
        announced(&asker, store, &user, id)
    });
    view.await.map(Json)
}

/// Begins the planned reading of a code.
#[utoipa::path(post, path = "/api/codes/{code}/readings", params(("code" = String, Path)),
    responses((status = 200, body = ReadingView), Problem))]
async fn begin_planned(
    State(state): State<AppState>,
    user: User,
    Path(code): Path<String>,
) -> Answer<Json<ReadingView>> {
    let by = user.sign();
    let asker = state.clone();
    let view = state.ask(move |store| {
        let code = FilmCode::new(&code);
        let study = store.observer(&user.name).study_of(&code)?;
        user.need_on_study(store, &study, Role::Editor)?;
        let id = store.begin_planned(&code, &by)?;
        announced(&asker, store, &user, id)
    });
    view.await.map(Json)
}

/// The current state of a reading.
#[utoipa::path(get, path = "/api/readings/{reading}", params(("reading" = i64, Path)),
    responses((status = 200, body = ReadingView), Problem))]
async fn reading(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
) -> Answer<Json<ReadingView>> {
    let view = state.ask(move |store| {
        let seen = seen_reading(store, &user, ReadingId(reading))?;
        view(store, &user, &seen, &[])
    });
    view.await.map(Json)
}

/// Finishes a reading, which can then no longer be changed.
#[utoipa::path(post, path = "/api/readings/{reading}/finish", params(("reading" = i64, Path)), request_body = Finish,
    responses((status = 200, body = FinishedReading),
        (status = 409, body = ConflictAnswer), Problem))]
async fn finish(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
    Json(new): Json<Finish>,
) -> Answer<Response> {
    let by = user.sign();
    let asker = state.clone();
    let answer = state.ask(move |store| {
        let id = ReadingId(reading);
        let known = match markable(store, &user, id)? {
            Markable::Shown(seen) => seen,
            Markable::Closed(closed) if closed.revision == new.expected_revision => {
                return Ok(Ok(finished(closed.revision, None)));
            }
            Markable::Closed(_) => return Err(StoreError::Finished { reading: id }.into()),
        };
        let before = known.state(&[])?;
        // A repeated request after a lost acknowledgement.
        let is_repeated = before.finished && before.revision == new.expected_revision;
        if !(is_repeated && known.record.observer == user.name) {
            if before.revision == new.expected_revision {
                need_sound(&known, &before, new.nothing_to_mark)?;
            }
            if let Err(refused) = store.finish_reading(id, new.expected_revision, &by) {
                return refusal(&asker, store, &user, id, refused).map(Err);
            }
        }
        announce(&asker, &user, &known, before.revision);
        let shown = match markable(store, &user, id)? {
            Markable::Shown(seen) => Some(view(store, &user, &seen, &[])?),
            Markable::Closed(_) => None,
        };
        Ok(Ok(finished(before.revision, shown)))
    });
    Ok(match answer.await? {
        Ok(finished) => Json(finished).into_response(),
        Err(lost) => conflict(lost),
    })
}

fn finished(revision: u64, reading: Option<ReadingView>) -> FinishedReading {
    FinishedReading { finished: true, revision, reading }
}

/// Withdraws a reading: it stays in the store and counts nowhere. Its observer may do so, or an admin.
#[utoipa::path(post, path = "/api/readings/{reading}/withdrawal", params(("reading" = i64, Path)),
    request_body = NewWithdrawal,
    responses((status = 200, body = ReadingView), Problem))]
async fn withdraw(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
    Json(new): Json<NewWithdrawal>,
) -> Answer<Json<ReadingView>> {
    let by = user.sign();
    let asker = state.clone();
    let view = state.ask(move |store| {
        let seen = seen_reading(store, &user, ReadingId(reading))?;
        let is_own = seen.record.observer == user.name;
        let least = if is_own { Role::Editor } else { Role::Admin };
        user.need_on_study(store, &seen.study.id, least)?;
        if let Some(correction) = store.withdraw_reading(seen.record.id, &new.reason, &by)? {
            announced(&asker, store, &user, correction)?;
        }
        announced(&asker, store, &user, seen.record.id)
    });
    view.await.map(Json)
}

/// Begins a correction of a finished reading of the requester: a copy with all landmarks, which replaces the reading when it is
/// finished.
#[utoipa::path(post, path = "/api/readings/{reading}/correction", params(("reading" = i64, Path)),
    responses((status = 200, body = ReadingView), Problem))]
async fn correct(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
) -> Answer<Json<ReadingView>> {
    let by = user.sign();
    let asker = state.clone();
    let view = state.ask(move |store| {
        let seen = seen_reading(store, &user, ReadingId(reading))?;
        user.need_on_study(store, &seen.study.id, Role::Editor)?;
        let correction = store.correct_reading(seen.record.id, &by)?;
        announced(&asker, store, &user, correction)
    });
    view.await.map(Json)
}

/// The reading after a change, or its current state if the change was refused.
pub fn answer_of(
    state: &AppState,
    store: &Store,
    user: &User,
    reading: ReadingId,
    changed: Result<(), StoreError>,
) -> Answer<Result<ReadingView, ConflictAnswer>> {
    match changed {
        Ok(()) => announced(state, store, user, reading).map(Ok),
        Err(refused) => refusal(state, store, user, reading, refused).map(Err),
    }
}

/// The current state of a reading after a refused stale change; other refusals are returned.
fn refusal(
    state: &AppState,
    store: &Store,
    user: &User,
    reading: ReadingId,
    refused: StoreError,
) -> Answer<ConflictAnswer> {
    let StoreError::Conflict { conflict, .. } = refused else { return Err(refused.into()) };
    let problem = Failure::from(refused).into_problem();
    let seen = seen_reading(store, user, reading)?;
    let view = view_after_loss(store, user, &seen, conflict)?;
    // A refused change is reported too, because it is kept.
    announce(state, user, &seen, view.revision);
    Ok(ConflictAnswer { problem, reading: view })
}

/// The answer to a refused change.
pub fn conflict(lost: ConflictAnswer) -> Response {
    (StatusCode::CONFLICT, Json(lost)).into_response()
}

/// The reading after a change; all open pages of its study are notified.
fn announced(
    state: &AppState,
    store: &Store,
    user: &User,
    reading: ReadingId,
) -> Answer<ReadingView> {
    let seen = seen_reading(store, user, reading)?;
    let view = view(store, user, &seen, &[])?;
    announce(state, user, &seen, view.revision);
    Ok(view)
}

fn announce(state: &AppState, user: &User, seen: &SeenReading, revision: u64) {
    let change = Change {
        who: user.name.to_string(),
        film: Some(seen.film.id.0),
        reading: Some(seen.record.id.0),
        revision: Some(revision),
    };
    state.changes.send(&seen.study.id, change);
}
