//! Results of unrecorded events, for the drag of a corner or an axis.

use axum::extract::State;
use spineline::anatomy::Level;
use spineline::spatial::Pixel;
use spineline_marking::turn_axis_towards;
use spineline_store::{Event, FilmRecord, ReadingId, Store};

use super::live::{followed, in_hand};
use crate::access::seen_reading;
use crate::api::{Preview, PreviewRequest, Problem, ReadingView, TurnAxis};
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::readings;
use crate::state::AppState;
use crate::user::User;

/// Results of unrecorded events on a reading.
#[utoipa::path(post, path = "/api/readings/{reading}/preview", params(("reading" = i64, Path)),
    request_body = PreviewRequest,
    responses((status = 200, body = Preview), Problem))]
pub async fn preview(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
    Json(request): Json<PreviewRequest>,
) -> Answer<Json<Preview>> {
    let reading = ReadingId(reading);
    let found = state.ask(move |store| {
        let (view, events) = before(store, &user, reading, request)?;
        Ok((view, in_hand(store, &user, reading, &events)?))
    });
    let (reading, hand) = found.await?;
    let live = followed(hand).await?;
    Ok(Json(Preview { reading, live }))
}

/// The reading with the events, and the events.
fn before(
    store: &Store,
    user: &User,
    reading: ReadingId,
    request: PreviewRequest,
) -> Answer<(ReadingView, Vec<Event>)> {
    let mut events = request.events;
    let seen = seen_reading(store, user, reading)?;
    let mut view = readings::view(store, user, &seen, &events)?;
    if let Some(turn) = &request.turn_axis {
        events.push(turned(&seen.film, &view, turn)?);
        view = readings::view(store, user, &seen, &events)?;
    }
    Ok((view, events))
}

/// The rotation of an axis towards the pointer as an event.
fn turned(film: &FilmRecord, view: &ReadingView, turn: &TurnAxis) -> Answer<Event> {
    let refused = |text: String, help| Failure::refused(text).help(help);
    let level: Level = turn.level.parse().map_err(|error: spineline::anatomy::UnknownLevel| {
        refused(error.to_string(), "name a vertebra that has landmarks")
    })?;
    let vertebra = view.vertebrae.iter().find(|vertebra| vertebra.level == turn.level);
    let midpoint = vertebra.and_then(|vertebra| vertebra.midpoint_px).ok_or_else(|| {
        let text = format!("{level} has no axis: it needs four corners");
        refused(text, "place the missing corners first")
    })?;
    let image = film.geometry()?;
    let [from, towards] = [midpoint, turn.towards_px].map(|[column, row]| Pixel::new(column, row));
    let axis = turn_axis_towards(&image, from, towards).ok_or_else(|| {
        refused(
            format!("{level}: this direction is not possible for the axis"),
            "point above the vertebra, within 90° of the picture's vertical",
        )
    })?;
    Ok(Event::SetAxis { level, axis_deg: Some(axis.deg()) })
}
