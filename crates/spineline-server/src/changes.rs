//! Changes of a study, as a stream of events.

use std::convert::Infallible;

use axum::extract::State;
use axum::response::Sse;
use axum::response::sse::{Event, KeepAlive};
use spineline_store::{Name, Visibility};
use tokio_stream::wrappers::BroadcastStream;
use tokio_stream::{Stream, StreamExt};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::study_name;
use crate::api::{Change, Problem};
use crate::channel::Message;
use crate::extract::Path;
use crate::problem::Answer;
use crate::session::User;
use crate::state::AppState;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(changes))
}

/// Server-sent events `change` with a `Change`. A blinded reader receives own changes only.
#[utoipa::path(get, path = "/api/studies/{study}/changes",
    responses((status = 200, content_type = "text/event-stream", body = Change),
        (status = 404, body = Problem)))]
async fn changes(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Sse<impl Stream<Item = Result<Event, Infallible>>>> {
    let study = study_name(&study)?;
    let (asked, who) = (study.clone(), user.clone());
    // Listening begins before the lookup, so that no change is missed.
    let messages = BroadcastStream::new(state.changes().subscribe());
    state.ask(move |store| who.on_study(store, &asked)).await?;
    let messages = messages
        .take_while(|message| !matches!(message, Ok(Message::End)))
        .filter_map(move |message| match message {
            Ok(Message::Change(of, change)) if of == study => Some((of, change)),
            _ => None,
        })
        .then(move |change| visible(state.clone(), user.clone(), change))
        .filter_map(|change| {
            let event = Event::default().event("change").json_data(change?).ok()?;
            Some(Ok(event))
        });
    Ok(Sse::new(messages).keep_alive(KeepAlive::default()))
}

/// A change as this user may see it, if at all.
async fn visible(state: AppState, user: User, change: (Name, Change)) -> Option<Change> {
    let (study, change) = change;
    let own = change.who == user.name.as_str();
    // Grants may have changed since the stream began.
    let visibility = state.ask(move |store| {
        user.on_study(store, &study)?;
        Ok(store.observer(&user.name).visibility(&study)?)
    });
    let visibility = visibility.await.ok()?;
    match visibility {
        Visibility::Open => Some(change),
        Visibility::Reader => own.then_some(Change { film: None, ..change }),
        Visibility::Apart => Some(Change { reading: None, revision: None, ..change }),
    }
}
