//! The HTTP server of the browser app. It reads and writes a [`spineline_store::Store`], computes with the library, and answers
//! in JSON and pictures; [`synthetic`] draws the films of its demonstration.

mod access;
mod accounts;
pub mod api;
mod app;
mod archive_client;
mod archives;
mod assets;
mod attachment;
mod body_rate;
mod changes;
mod channel;
mod connection_slots;
mod decoded;
mod demo;
pub mod extract;
mod film_cache;
mod films;
mod grants;
mod guard;
mod guard_rate;
mod guard_token;
mod gzip;
mod hosts;
mod jobs;
mod limits;
mod listen;
mod overview_cache;
mod places;
mod problem;
mod readings;
mod request_source;
mod result_cache;
mod results;
mod secret;
mod session;
mod state;
mod studies;
pub mod synthetic;
mod user;
mod words;

pub use app::{app, openapi};
pub use assets::{has_app, licences_of_app};
pub use guard::MAX_UPLOAD_BYTES;
pub use hosts::is_host;
pub use limits::{BodyRate, Places, RequestPlaces, ServeLimits, Shares, UploadLimits, UploadRoom};
pub use listen::Server;
pub use problem::{Answer, Failure};
pub use state::{AppState, ServeOptions};
pub use user::User;

/// This program and its version, as in the provenance of files.
const PROGRAM: &str = concat!("spineline ", env!("CARGO_PKG_VERSION"));
