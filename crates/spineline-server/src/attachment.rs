//! Answers that a browser saves as a file.

use axum::http::header;
use axum::response::{IntoResponse, Response};

/// JSON that a browser saves as a file. A study's name is always a valid file name.
pub fn attachment(file: &str, json: String) -> Response {
    let headers = [
        (header::CONTENT_TYPE, "application/json".to_owned()),
        (header::CONTENT_DISPOSITION, format!("attachment; filename=\"{file}\"")),
    ];
    (headers, json).into_response()
}
