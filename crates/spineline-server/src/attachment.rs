//! Answers that are files: to save, and pictures to show.

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

/// An answer that is a PNG.
pub fn png(bytes: Vec<u8>) -> Response {
    ([(header::CONTENT_TYPE, "image/png")], bytes).into_response()
}
