//! Reports and pictures of what Spineline found.
//!
//! [`figures`] turns an analysis, or samples of a cohort, into SVG text. [`patient::report`] and [`cohort::report`] make a
//! [`Document`] of them, which [`html`], [`markdown`] and, in a crate of its own, a typesetter write. All are pure
//! functions without files and with the same bytes for the same input, and the word `synthetic` is on every picture of
//! made-up films. The one exception is [`fonts`]: what the fonts within cannot draw is looked for among those of the machine.

pub mod cohort;
pub mod document;
mod embedded;
pub mod figures;
pub mod fonts;
mod html;
mod markdown;
pub mod patient;
mod png;

pub use document::{Document, file_stem};
pub use embedded::embedded;
pub use html::html;
pub use markdown::markdown;
pub use png::{PngError, png};
