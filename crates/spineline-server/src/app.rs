//! The browser app's server. It calls the store and the library, and converts their answers to text and pixels.

use std::any::Any;

use axum::extract::DefaultBodyLimit;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::{Router, middleware, routing};
use tower_http::catch_panic::CatchPanicLayer;
use utoipa::openapi::OpenApi;
use utoipa_axum::router::OpenApiRouter;

use crate::problem::Failure;
use crate::state::AppState;
use crate::user::User;
use crate::{
    accounts, archives, assets, changes, demo, films, grants, guard, readings, results, session,
    studies,
};

/// The description of the interface, from which the browser's types are generated.
#[must_use]
pub fn openapi() -> OpenApi {
    let mut description = routes().into_openapi();
    description.info = utoipa::openapi::Info::new("Spineline", env!("CARGO_PKG_VERSION"));
    description
}

fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .merge(session::routes())
        .merge(accounts::routes())
        .merge(grants::routes())
        .merge(studies::routes())
        .merge(demo::routes())
        .merge(films::routes())
        .merge(archives::routes())
        .merge(readings::routes())
        .merge(changes::routes())
        .merge(results::routes())
}

/// The whole app, for the server and for tests.
pub fn app(state: AppState) -> Router {
    let (api, _) = routes().split_for_parts();
    api.route("/api", routing::any(unknown))
        // `{*unknown}` needs at least one character.
        .route("/api/", routing::any(unknown))
        .route("/api/{*unknown}", routing::any(unknown))
        .fallback(assets::serve)
        .method_not_allowed_fallback(wrong_method)
        .layer(DefaultBodyLimit::max(guard::MAX_BODY_BYTES))
        .layer(middleware::from_fn_with_state(state.clone(), guard::guard))
        .layer(CatchPanicLayer::custom(panicked))
        .layer(middleware::from_fn_with_state(state.clone(), guard::headers))
        .with_state(state)
}

async fn unknown(_user: User) -> Failure {
    Failure::not_found()
}

async fn wrong_method() -> Failure {
    Failure::new(
        StatusCode::METHOD_NOT_ALLOWED,
        "wrong_method",
        "this address does not accept this HTTP method",
    )
}

/// A panic message may quote the request, so the answer does not contain it.
fn panicked(_: Box<dyn Any + Send>) -> Response {
    Failure::internal("internal error: the program has a bug")
        .help("this step was not saved; the terminal shows where the error occurred")
        .into_response()
}

#[cfg(test)]
mod tests {
    use axum::body::{Body, to_bytes};
    use axum::http::Request;
    use axum::{Router, routing};
    use tower::ServiceExt;
    use tower_http::catch_panic::CatchPanicLayer;

    #[tokio::test]
    async fn f71_the_answer_to_a_panic_does_not_quote_the_request() {
        async fn bug() -> &'static str {
            panic!("a patient called Doe^Jane")
        }
        let app = Router::new()
            .route("/", routing::get(bug))
            .layer(CatchPanicLayer::custom(super::panicked));
        let answer = app.oneshot(Request::new(Body::empty())).await.expect("an answer");
        assert_eq!(answer.status(), 500);
        let body = to_bytes(answer.into_body(), 1000).await.expect("a body");
        let problem: crate::api::Problem = serde_json::from_slice(&body).expect("a problem");
        assert_eq!(problem.code, "internal");
        assert!(!format!("{problem:?}").contains("Doe"));
    }
}
