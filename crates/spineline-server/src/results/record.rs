//! Records events and returns their results in the same answer.

use axum::extract::State;
use axum::response::{IntoResponse, Response};
use spineline_store::ReadingId;

use super::live::{followed, in_hand};
use crate::api::{ConflictAnswer, NewEvent, Preview, Problem};
use crate::extract::{Json, Path};
use crate::problem::Answer;
use crate::readings;
use crate::state::AppState;
use crate::user::User;

/// Records all events or none, and returns the results. A repeated request gets the same answer and records nothing.
#[utoipa::path(post, path = "/api/readings/{reading}/events", params(("reading" = i64, Path)), request_body = NewEvent,
    responses((status = 200, body = Preview),
        (status = 409, body = ConflictAnswer), Problem))]
pub async fn record(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
    Json(new): Json<NewEvent>,
) -> Answer<Response> {
    let by = user.sign();
    let (asker, reading) = (state.clone(), ReadingId(reading));
    let answer = state.ask(move |store| {
        readings::may_mark(store, &user, reading)?;
        let recorded = store.record_all(reading, &new.events, new.expected_revision, &by);
        let answer = readings::answer_of(&asker, store, &user, reading, recorded.map(drop))?;
        // Recorded events are acknowledged even if their results cannot be computed.
        Ok(answer.map(|view| (view, in_hand(store, &user, reading, &[]).ok().flatten())))
    });
    Ok(match answer.await? {
        Ok((reading, hand)) => {
            let live = followed(hand).await.ok().flatten();
            Json(Preview { reading, live }).into_response()
        }
        Err(lost) => readings::conflict(lost),
    })
}
