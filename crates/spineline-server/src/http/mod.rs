//! The browser app's server: thin. It asks the store and the library, and puts their answers into words and pixels.

pub mod api;
mod assets;
mod changes;
mod demo;
mod films;
mod problem;
mod readings;
mod session;
mod state;
mod studies;
mod words;

pub use problem::{Answer, Failure};
pub use session::User;
pub use state::{AppState, ServeOptions};

use std::net::SocketAddr;

use axum::Router;
use tokio::net::TcpListener;
use utoipa::openapi::OpenApi;
use utoipa_axum::router::OpenApiRouter;

use crate::store::Store;

/// A server that listens, and can be run.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    state: AppState,
}

impl Server {
    /// Listens.
    ///
    /// # Errors
    /// Whatever keeps a port from being listened on.
    pub async fn bind(
        store: Store,
        address: SocketAddr,
        options: ServeOptions,
    ) -> std::io::Result<Self> {
        let listener = TcpListener::bind(address).await?;
        let state = AppState::new(store, listener.local_addr()?, options);
        Ok(Self { listener, state })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.state.address()
    }

    /// The address to open. Its one-time token stands behind `#`, which browsers send to nobody.
    #[must_use]
    pub fn address_to_open(&self) -> String {
        format!("http://{}/#token={}", self.address(), self.state.token())
    }

    /// Answers until `end` comes.
    ///
    /// # Errors
    /// Whatever ends a listener.
    pub async fn run(self, end: impl Future<Output = ()> + Send + 'static) -> std::io::Result<()> {
        let state = self.state.clone();
        let end = async move {
            end.await;
            // A stream of changes would keep its connection open for ever.
            state.changes().close();
        };
        axum::serve(self.listener, app(self.state)).with_graceful_shutdown(end).await
    }
}

/// The description of the interface, of which the browser's types are made.
#[must_use]
pub fn openapi() -> OpenApi {
    let mut description = routes().into_openapi();
    description.merge(<Planned as utoipa::OpenApi>::openapi());
    description.info = utoipa::openapi::Info::new("Spineline", env!("CARGO_PKG_VERSION"));
    description
}

/// Types of handlers that are being written.
#[derive(utoipa::OpenApi)]
#[openapi(components(schemas(
    api::AccountView,
    api::AccountEdit,
    api::Grant,
    api::StudySummary,
    api::StudyDetail,
    api::UploadView,
    api::NewStudy,
    api::CaseImport,
    api::FilmChange,
    api::Change,
    api::NewPlan,
    api::NewReading,
    api::ReadingView,
    api::NewEvent,
    api::Finish,
    api::PreviewRequest,
    api::Preview,
    api::ConflictAnswer,
    api::LiveView,
    api::ModelView,
    api::LoadRequest,
    api::LoadAnswer,
    api::CohortView,
)))]
struct Planned;

fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .merge(session::routes())
        .merge(studies::routes())
        .merge(demo::routes())
        .merge(films::routes())
        .merge(readings::routes())
        .merge(changes::routes())
}

fn app(state: AppState) -> Router {
    let (api, _) = routes().split_for_parts();
    api.fallback(assets::serve).with_state(state)
}
