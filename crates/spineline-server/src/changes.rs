//! Changes of a study, as a stream of events.

use std::convert::Infallible;

use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Sse;
use axum::response::sse::{Event, KeepAlive};
use spineline_store::{Name, Role, Store, Visibility};
use tokio::time::{Instant, interval_at};
use tokio_stream::wrappers::{BroadcastStream, IntervalStream};
use tokio_stream::{Stream, StreamExt};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::study_name;
use crate::api::{Change, Problem};
use crate::channel::Message;
use crate::extract::Path;
use crate::problem::{Answer, Failure};
use crate::state::AppState;
use crate::user::{self, User};

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(changes))
}

/// Server-sent events `change` with a `Change`. A blinded reader receives own changes only. The stream ends with the
/// session, and when the role, the grant or the blinding of the account changes: the page then asks again.
#[utoipa::path(get, path = "/api/studies/{study}/changes", params(("study" = String, Path)),
    responses((status = 200, content_type = "text/event-stream", body = Change), Problem))]
async fn changes(
    State(state): State<AppState>,
    user: User,
    headers: HeaderMap,
    Path(study): Path<String>,
) -> Answer<Sse<impl Stream<Item = Result<Event, Infallible>>>> {
    let study = study_name(&study)?;
    // Subscribes before the lookup, so that no change is missed.
    let messages = BroadcastStream::new(state.changes.subscribe());
    let secret = user::secret_of(&state, &headers).unwrap_or_default();
    let (asked, who) = (study.clone(), user.clone());
    let found = state.ask(move |store| {
        let role = who.on_study(store, &asked)?;
        Ok((role, store.observer(&who.name).visibility(&asked)?))
    });
    let (role, visibility) = found.await?;
    let listener = Listener { state, secret, user, study, role, visibility };
    let every = listener.state.options.limits.recheck;
    let rechecks = IntervalStream::new(interval_at(Instant::now() + every, every));
    let messages = messages
        // A listener that missed messages may have missed a change of its rights.
        .map(|message| message.unwrap_or(Message::Rights))
        .merge(rechecks.map(|_| Message::Rights))
        .take_while(|message| !matches!(message, Message::End))
        .then(move |message| listener.clone().heard(message))
        // After an error the stream ends; the browser asks again and gets the reason.
        .map_while(Result::ok)
        .filter_map(|change| {
            let event = Event::default().event("change").json_data(change?).ok()?;
            Some(Ok(event))
        });
    Ok(Sse::new(messages).keep_alive(KeepAlive::default()))
}

/// A listener with its rights at the start.
#[derive(Clone)]
struct Listener {
    state: AppState,
    secret: String,
    user: User,
    study: Name,
    role: Role,
    visibility: Visibility,
}

impl Listener {
    /// The change to report for a message.
    async fn heard(self, message: Message) -> Answer<Option<Change>> {
        let change = match message {
            Message::Change(of, change) if of == self.study => Some(change),
            Message::Change(..) => return Ok(None),
            Message::Rights | Message::End => None,
        };
        let state = self.state.clone();
        state
            .ask(move |store| {
                self.still_may(store)?;
                Ok(change.and_then(|change| self.visible(change)))
            })
            .await
    }

    /// Refuses where the session has ended or its rights have changed.
    fn still_may(&self, store: &Store) -> Answer<()> {
        let access = self.state.options.access;
        let user = user::user_behind(store, &self.secret, access, self.state.now())?;
        if user == self.user
            && user.on_study(store, &self.study)? == self.role
            && store.observer(&user.name).visibility(&self.study)? == self.visibility
        {
            return Ok(());
        }
        Err(Failure::not_found())
    }

    /// A change as this user may see it, if at all.
    fn visible(&self, change: Change) -> Option<Change> {
        let own = change.who == self.user.name.as_str();
        match self.visibility {
            Visibility::Open => Some(change),
            Visibility::Reader => own.then_some(Change { film: None, ..change }),
            Visibility::Apart => Some(Change { reading: None, revision: None, ..change }),
        }
    }
}
