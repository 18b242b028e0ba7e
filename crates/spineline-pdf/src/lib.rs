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

use chrono::{DateTime, Datelike, Timelike, Utc};
use spineline_report::Document;
use spineline_report::fonts::{Font, Fonts};
use typst::foundations::{Datetime, Smart};
use typst_layout::PagedDocument;
use typst_pdf::{PdfOptions, PdfStandard, PdfStandards, Timestamp};

pub use attached::embedded;
use text::Letters;
use world::Paper;

/// A report that cannot become a PDF.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PdfError {
    /// A year that a PDF cannot have.
    #[error("the time of the report, {:04}-{}, is not a valid date", .0.year(), .0.format("%m-%dT%H:%M:%SZ"))]
    Date(DateTime<Utc>),
    /// The template or a figure is invalid.
    #[error("the report could not be typeset: {0}")]
    Typeset(String),
    /// It contains something that PDF/A-3b forbids.
    #[error("the typeset report could not be written as PDF/A-3b: {0}")]
    Export(String),
}

/// The report as PDF/A-3b, made at this time, with the analysis attached. Letters that the fonts lack become boxes, and a
/// note on the first page names them.
pub fn pdf(document: &Document, made: DateTime<Utc>) -> Result<Vec<u8>, PdfError> {
    let date = datetime(made).ok_or(PdfError::Date(made))?;
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

/// The typesetter's date; `None` for a year that a PDF cannot have.
fn datetime(made: DateTime<Utc>) -> Option<Datetime> {
    let year = u16::try_from(made.year()).ok()?;
    // All of these are below 60, and fit.
    let [month, day] = [made.month(), made.day()].map(|part| part as u8);
    let [hour, minute, second] = [made.hour(), made.minute(), made.second()].map(|part| part as u8);
    Datetime::from_ymd_hms(year.into(), month, day, hour, minute, second)
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
