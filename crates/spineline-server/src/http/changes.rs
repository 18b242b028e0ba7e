//! Changes of a study, told to everybody who looks at it.

use std::convert::Infallible;

use axum::extract::State;
use axum::response::Sse;
use axum::response::sse::{Event, KeepAlive};
use spineline_store::{Name, Sight};
use tokio::sync::broadcast;
use tokio_stream::wrappers::BroadcastStream;
use tokio_stream::{Stream, StreamExt};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::api::{Change, Problem};
use super::extract::Path;
use super::studies::study_name;
use super::{Answer, AppState, User};

/// Changes that a slow listener may lag behind before it misses some.
const LAG: usize = 256;

#[derive(Clone)]
enum Told {
    Change(Name, Change),
    End,
}

/// Who is told of changes.
pub struct Channel(broadcast::Sender<Told>);

impl Default for Channel {
    fn default() -> Self {
        Self(broadcast::channel(LAG).0)
    }
}

impl Channel {
    /// Tells of a change that is committed.
    pub fn tell(&self, study: &Name, change: Change) {
        // Nobody may be listening.
        let _ = self.0.send(Told::Change(study.clone(), change));
    }

    /// Ends all streams.
    pub fn close(&self) {
        let _ = self.0.send(Told::End);
    }
}

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(changes))
}

/// Server-sent events `change` with a `Change`. A blinded reader is told of own changes only.
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
    // Listening begins before anything is looked up, so that nothing falls in between.
    let told = BroadcastStream::new(state.changes().0.subscribe());
    state.ask(move |store| who.on_study(store, &asked)).await?;
    let told = told
        .take_while(|told| !matches!(told, Ok(Told::End)))
        .filter_map(move |told| match told {
            Ok(Told::Change(of, change)) if of == study => Some((of, change)),
            _ => None,
        })
        .then(move |change| visible(state.clone(), user.clone(), change))
        .filter_map(|change| {
            let event = Event::default().event("change").json_data(change?).ok()?;
            Some(Ok(event))
        });
    Ok(Sse::new(told).keep_alive(KeepAlive::default()))
}

/// A change as this user may see it, if at all.
async fn visible(state: AppState, user: User, change: (Name, Change)) -> Option<Change> {
    let (study, change) = change;
    let own = change.who == user.name.as_str();
    // Grants may have changed since the stream began.
    let sight = state.ask(move |store| {
        user.on_study(store, &study)?;
        Ok(store.observer(&user.name).sight(&study)?)
    });
    let sight = sight.await.ok()?;
    match sight {
        Sight::Open => Some(change),
        Sight::Reader => own.then_some(Change { film: None, ..change }),
        Sight::Apart => Some(Change { reading: None, revision: None, ..change }),
    }
}
