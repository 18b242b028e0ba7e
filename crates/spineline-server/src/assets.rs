//! The embedded pages.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use rust_embed::RustEmbed;

use crate::gzip::Gzipped;

#[derive(RustEmbed)]
#[folder = "$OUT_DIR/web"]
struct Pages;

/// Whether the browser app was built before this program; else its address shows a page that says how to build it.
#[must_use]
pub fn has_app() -> bool {
    Pages::iter().any(|name| name.starts_with("assets/"))
}

/// The licences of the npm packages in the app, as Markdown; empty without the app.
#[must_use]
pub fn licences_of_app() -> String {
    let file = Pages::get("licences.md");
    file.map_or_else(String::new, |file| String::from_utf8_lossy(&file.data).into_owned())
}

/// The files by name, compressed at the first request.
static PACKED: LazyLock<BTreeMap<String, Gzipped>> = LazyLock::new(|| {
    let pages = Pages::iter().filter_map(|name| Some((name.to_string(), Pages::get(&name)?.data)));
    pages.map(|(name, data)| (name, Gzipped::new(&data, Compression::best()))).collect()
});

/// A file of the app; the app itself at `/`.
pub async fn serve(uri: Uri, asked: HeaderMap) -> Response {
    let path = uri.path().trim_start_matches('/');
    let path = if path.is_empty() { "index.html" } else { path };
    let (Some(page), Some(packed)) = (Pages::get(path), PACKED.get(path)) else {
        return StatusCode::NOT_FOUND.into_response();
    };
    // Names of built files contain a hash of their content, except for the page itself.
    let keep = if path.starts_with("assets/") { "max-age=31536000, immutable" } else { "no-cache" };
    let kind = page.metadata.mimetype().to_owned();
    let headers = [(header::CONTENT_TYPE, kind), (header::CACHE_CONTROL, keep.to_owned())];
    (headers, packed.answer(&asked)).into_response()
}
