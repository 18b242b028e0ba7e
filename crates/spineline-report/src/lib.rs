//! Reports and figures of results.
//!
//! [`figures`] turns an analysis, or samples of a cohort, into SVG text. [`patient::report`] and [`cohort::report`] make a
//! [`Document`] of them, which [`html()`], [`markdown()`] and a typesetter in another crate write. [`patient::summary`],
//! [`cohort::summary`] and [`reliability::summary`] make short documents without figures, which [`terminal()`] writes.
//!
//! All are pure functions without files: the same input gives the same bytes. Every picture of synthetic films has the word
//! `synthetic`. One exception: [`fonts`] looks in the installed fonts for letters that the built-in ones lack.

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
pub use phrases::sentence_case;
pub use png::{PRINT_SCALE, PngError, png};
pub use terminal::terminal;
pub use warnings::{WarningCounts, warnings};
