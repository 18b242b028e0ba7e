//! The typeset PDF of a report.
//!
//! [`pdf`] gives a [`Document`] to one Typst template, as data and never as markup, and writes PDF/A-3b with the
//! analysis attached; [`embedded`] extracts the analysis. This crate uses no files, clock or network: the date is
//! given, and the same input gives the same bytes, if the built-in fonts have all letters.

#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare with exact values"))]

mod attached;
mod columns;
mod page;
mod text;
mod world;

use std::fmt;

use chrono::{DateTime, Datelike, Timelike, Utc};
use spineline_report::Document;
use spineline_report::fonts::{Font, Fonts};
use typst::foundations::{Datetime, Smart};
use typst_layout::PagedDocument;
use typst_pdf::{PdfOptions, PdfStandard, PdfStandards, Timestamp};

pub use attached::embedded;
use text::Letters;
use world::Paper;

/// When a report was made, in UTC.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Made {
    /// After Christ.
    pub year: u16,
    /// From 1.
    pub month: u8,
    /// From 1.
    pub day: u8,
    /// Of 24.
    pub hour: u8,
    /// Of 60.
    pub minute: u8,
    /// Of 60.
    pub second: u8,
}

impl Made {
    /// This time; `None` for years outside of 1 to 65535.
    #[must_use]
    pub fn of(time: DateTime<Utc>) -> Option<Self> {
        // All of them are below 60, and fit.
        Some(Self {
            year: u16::try_from(time.year()).ok()?,
            month: time.month() as u8,
            day: time.day() as u8,
            hour: time.hour() as u8,
            minute: time.minute() as u8,
            second: time.second() as u8,
        })
    }
}

impl fmt::Display for Made {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { year, month, day, hour, minute, second } = self;
        write!(f, "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
    }
}

/// A report that cannot become a PDF.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PdfError {
    /// Not in the calendar, such as a 30th of February.
    #[error("the time of the report, {0}, is not a valid date")]
    Date(Made),
    /// The template or a figure is invalid.
    #[error("the report could not be typeset: {0}")]
    Typeset(String),
    /// It contains something that PDF/A-3b forbids.
    #[error("the typeset report could not be written as PDF/A-3b: {0}")]
    Export(String),
}

/// The report as PDF/A-3b, with the analysis attached. Letters that the fonts lack become boxes, and a note on the
/// first page names them.
///
/// # Errors
/// [`PdfError`]
pub fn pdf(document: &Document, made: Made) -> Result<Vec<u8>, PdfError> {
    let Made { year, month, day, hour, minute, second } = made;
    let date = Datetime::from_ymd_hms(i32::from(year), month, day, hour, minute, second);
    let date = date.ok_or(PdfError::Date(made))?;
    let within = Fonts::within();
    let found = Fonts::for_texts(page::texts(document)).fonts;
    let is_more = found.len() > within.len();
    let bytes = match typeset(document, found, date) {
        // For example, a font forbids embedding: boxes are better than a missing report.
        Err(PdfError::Export(_)) if is_more => typeset(document, within, date),
        done => done,
    };
    // Free the typesetter's cache, which later reports do not use.
    typst::comemo::evict(0);
    bytes
}

fn typeset(document: &Document, fonts: Vec<Font>, date: Datetime) -> Result<Vec<u8>, PdfError> {
    let mut paper = Paper::new(&fonts);
    let letters = Letters::of(page::texts(document), paper.fonts());
    let missing = Fonts { fonts, missing: letters.lacking() }.missing_words();
    let report = page::page(document, &letters, missing.as_deref());
    paper.put("/report.json", report.to_string());
    for (i, figure) in document.figures().enumerate() {
        paper.put(&page::figure_path(i), letters.plain(&figure.svg));
    }
    paper.put(attached::PATH, document.analysis.clone());
    let pages = typst::compile::<PagedDocument>(&paper).output;
    let pages = pages.map_err(|faults| PdfError::Typeset(paper.words(&faults)))?;
    typst_pdf::pdf(&pages, &options(document, date))
        .map_err(|faults| PdfError::Export(paper.words(&faults)))
}

fn options(document: &Document, date: Datetime) -> PdfOptions {
    let content = (&document.title, &document.subject, &document.analysis);
    PdfOptions {
        ident: Smart::Custom(format!("{:032x}", typst::utils::hash128(&content))),
        creator: Smart::Custom(Some(document.generator.clone())),
        timestamp: Some(Timestamp::new_utc(date)),
        standards: PdfStandards::new(&[PdfStandard::A_3b]).expect("one standard contradicts none"),
        ..PdfOptions::default()
    }
}
