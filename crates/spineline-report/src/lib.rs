//! Reports and figures of results.
//!
//! [`figures`] turns an analysis, or samples of a cohort, into SVG text. [`patient::report`] and [`cohort::report`] make a
//! [`Document`] of them, which [`html()`], [`markdown()`] and, in a crate of its own, a typesetter write. [`patient::summary`],
//! [`cohort::summary`] and [`reliability::summary`] make short documents without figures, which [`terminal()`] writes.
//!
//! All are pure functions without files and with the same bytes for the same input, and the word `synthetic` is on every
//! picture of synthetic films. The one exception is [`fonts`]: what the fonts within cannot draw is looked for among those of
//! the machine.

pub mod cohort;
pub mod document;
mod embedded;
pub mod figures;
pub mod fonts;
mod html;
mod hypotheses;
pub mod loaded_tables;
mod loaded_words;
mod markdown;
pub mod number;
pub mod paper;
pub mod patient;
mod phrases;
mod png;
pub mod reliability;
pub mod reproduction;
pub mod rotation_prior;
pub mod terminal;
mod warnings;

pub use document::{Document, file_stem};
pub use embedded::embedded;
pub use html::{html, html_fragment};
pub use markdown::markdown;
pub use png::{PRINT_SCALE, PngError, png};
pub use terminal::terminal;
pub use warnings::{WarningCounts, warnings};
