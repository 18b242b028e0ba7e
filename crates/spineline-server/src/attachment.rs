//! Answers that a browser saves as a file.

use axum::http::header;
use axum::response::{IntoResponse, Response};

/// An answer that a browser saves as a file. A study's name is always a valid file name.
pub fn attachment(file: &str, kind: &str, content: impl IntoResponse) -> Response {
    let headers = [
        (header::CONTENT_TYPE, kind.to_owned()),
        (header::CONTENT_DISPOSITION, format!("attachment; filename=\"{file}\"")),
    ];
    (headers, content).into_response()
}
