//! A report as PDF, dated by its run.

use chrono::{DateTime, Datelike, Utc};
use spineline_pdf::PdfError;
use spineline_report::Document;

use crate::run::failure::Failure;

/// The bytes of the PDF.
///
/// # Errors
/// If a PDF cannot have the year of the date, or the report cannot be typeset.
pub fn pdf(document: &Document, date_utc: &str) -> Result<Vec<u8>, Failure> {
    spineline_pdf::pdf(document, made(date_utc)?).map_err(|error| match error {
        PdfError::Date(_) => Failure::usage(error.to_string()),
        _ => Failure::internal(format!("{}: {error}", document.subject)),
    })
}

/// The date of a run, as RFC 3339 has it.
fn made(date_utc: &str) -> Result<DateTime<Utc>, Failure> {
    let date = date_utc.parse::<DateTime<Utc>>().ok();
    date.filter(|date| u16::try_from(date.year()).is_ok()).ok_or_else(|| {
        Failure::usage(format!("{date_utc} is not a date for a PDF; expected a year of our era"))
    })
}

/// The analysis JSON that is attached to a report.
///
/// # Errors
/// None in a build with the typesetter.
pub fn attached(bytes: &[u8]) -> Result<Option<String>, Failure> {
    Ok(spineline_pdf::embedded(bytes))
}

/// Refuses, before any work, a format that this build cannot write.
///
/// # Errors
/// None in a build with the typesetter.
pub const fn check_is_built() -> Result<(), Failure> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_date_is_that_of_the_run() {
        let date = made("2026-01-02T03:04:05Z").expect("a date");
        assert_eq!(date.to_rfc3339(), "2026-01-02T03:04:05+00:00");
        assert!(made("-0044-03-15T12:00:00Z").is_err() && made("soon").is_err());
    }
}
