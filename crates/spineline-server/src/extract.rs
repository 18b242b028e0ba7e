//! Extractors that refuse with a [`Problem`](crate::api::Problem). Axum's extractors refuse with text that may quote the request.

use std::error::Error;

use axum::body::Bytes;
use axum::extract::rejection::BytesRejection;
use axum::extract::{FromRequest, FromRequestParts, Request};
use axum::http::request::Parts;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use serde::de::{DeserializeOwned, IgnoredAny};

use crate::body_rate::TooSlow;
use crate::problem::Failure;
use crate::state::AppState;
use crate::user::{self, User};

/// A JSON body, of a request or of an answer.
#[derive(Debug, Clone, Copy)]
pub struct Json<T>(pub T);

impl<T: Serialize> IntoResponse for Json<T> {
    fn into_response(self) -> Response {
        axum::Json(self.0).into_response()
    }
}

impl<T: DeserializeOwned> FromRequest<AppState> for Json<T> {
    type Rejection = Failure;

    async fn from_request(request: Request, state: &AppState) -> Result<Self, Failure> {
        let JsonText(text) = JsonText::from_request(request, state).await?;
        serde_json::from_str(&text).map(Self).map_err(|error| bad(&text, &error))
    }
}

/// A body, and rights that are asked for when it has arrived: they may change while a slow body arrives.
pub struct WithBody<B, R>(pub B, pub R);

impl<B, R> FromRequest<AppState> for WithBody<B, R>
where
    B: FromRequest<AppState, Rejection = Failure> + Send,
    R: FromRequestParts<AppState, Rejection = Failure>,
{
    type Rejection = Failure;

    async fn from_request(request: Request, state: &AppState) -> Result<Self, Failure> {
        let (mut parts, body) = request.into_parts();
        let body = B::from_request(Request::from_parts(parts.clone(), body), state).await?;
        Ok(Self(body, R::from_request_parts(&mut parts, state).await?))
    }
}

/// The text of a JSON body, for files with their own messages.
#[derive(Debug, Clone)]
pub struct JsonText(pub String);

impl FromRequest<AppState> for JsonText {
    type Rejection = Failure;

    async fn from_request(request: Request, state: &AppState) -> Result<Self, Failure> {
        let body = json_body(request, state).await?;
        let text = String::from_utf8(body.into()).map_err(|_| {
            Failure::new(StatusCode::BAD_REQUEST, "bad_json", "the body is not UTF-8")
        })?;
        Ok(Self(text))
    }
}

async fn json_body(request: Request, state: &AppState) -> Result<Bytes, Failure> {
    if !is_json(request.headers()) {
        return Err(Failure::new(
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            "not_json",
            "the body must be JSON with Content-Type: application/json",
        ));
    }
    let (asker, headers) = (request.extensions().get::<User>().cloned(), request.headers().clone());
    let body = Bytes::from_request(request, state).await.map_err(|refused| unread(&refused))?;
    // The role may change while a slow body arrives.
    match asker {
        Some(asker) if user::user_of(state, &headers).await? != asker => {
            let text = "your role was changed while the request arrived";
            let refused = Failure::new(StatusCode::FORBIDDEN, "not_allowed", text);
            Err(refused.help("load the page again"))
        }
        _ => Ok(body),
    }
}

fn is_json(headers: &HeaderMap) -> bool {
    let kind = headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    let kind = kind.map(|kind| kind.split(';').next().unwrap_or_default().trim());
    kind.is_some_and(|kind| kind.eq_ignore_ascii_case("application/json"))
}

/// Why a body was not read.
pub fn unread(refused: &BytesRejection) -> Failure {
    let mut cause = refused.source();
    while let Some(error) = cause {
        if error.is::<TooSlow>() {
            return Failure::new(StatusCode::REQUEST_TIMEOUT, "slow", error.to_string());
        }
        cause = error.source();
    }
    if refused.status() == StatusCode::PAYLOAD_TOO_LARGE {
        return Failure::new(refused.status(), "too_large", "the body is too large");
    }
    Failure::new(StatusCode::BAD_REQUEST, "broken_off", "the body is incomplete")
}

/// Reports the place and not the content, because serde's messages quote keys and values.
fn bad(text: &str, error: &serde_json::Error) -> Failure {
    // `serde_json` takes more values than a list has, numbers beyond the largest one, and deep nesting for errors of syntax.
    let is_json = error.is_data() || serde_json::from_str::<IgnoredAny>(text).is_ok();
    let (status, code, what) = if is_json {
        let what = "an unknown or missing key, or a value that does not fit";
        (StatusCode::UNPROCESSABLE_ENTITY, "bad_request", what)
    } else {
        (StatusCode::BAD_REQUEST, "bad_json", "not JSON")
    };
    let (line, column) = (error.line(), error.column());
    Failure::new(status, code, format!("line {line}, column {column} of the body: {what}"))
}

/// Parts of the path. An invalid part is answered as not found.
#[derive(Debug, Clone, Copy)]
pub struct Path<T>(pub T);

impl<T: DeserializeOwned + Send> FromRequestParts<AppState> for Path<T> {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, Failure> {
        let path = axum::extract::Path::from_request_parts(parts, state).await;
        path.map(|path| Self(path.0)).map_err(|_| Failure::not_found())
    }
}
