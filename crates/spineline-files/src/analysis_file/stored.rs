//! The inputs of an analysis, read from its file.

use serde::Deserialize;
use spineline::analysis::Case;

use super::{FORMAT, VERSION};
use crate::case_file::parse_case_file;
use crate::json::{format_of, parse};
use crate::{CaseFile, FileError, Provenance, Request};

/// Codes of the warnings about pictures beside a case. They are the only ones that an analysis cannot find again without the
/// pictures.
pub const PICTURE_WARNINGS: [&str; 3] =
    ["identifier_repeated", "other_body_part", "patient_differs"];

/// Inputs of an analysis, sufficient to repeat it.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredAnalysis {
    /// The case as it was read.
    pub case_file: CaseFile,
    /// The same in the library's types.
    pub case: Case,
    /// Provenance of the file.
    pub provenance: Provenance,
    /// What was requested.
    pub request: Request,
}

/// The two parts that say how to repeat it; results of other versions do not stand in the way.
#[derive(Deserialize)]
struct Origin {
    provenance: Option<Provenance>,
    case: Option<CaseFile>,
}

/// Reads the inputs of an analysis from its file.
///
/// # Errors
/// [`FileError`]: [`FileError::NotRepeatable`] where a part is missing, else where in the file something does not fit.
pub fn parse_analysis(text: &str) -> Result<StoredAnalysis, FileError> {
    let Origin { provenance, case } = parse(text, FORMAT, VERSION)?;
    let missing = |part| FileError::NotRepeatable { part };
    let provenance = provenance.ok_or(missing("provenance"))?;
    let case_file = case.ok_or(missing("case"))?;
    let request = provenance.request()?.ok_or(missing("provenance.options"))?;
    let case = case_file.clone().into_case()?;
    Ok(StoredAnalysis { case_file, case, provenance, request })
}

/// Reads a case, or the case within an analysis with the request.
///
/// # Errors
/// As [`parse_case_file`] and [`parse_analysis`].
pub fn parse_case_within(text: &str) -> Result<(CaseFile, Option<Request>), FileError> {
    if format_of(text).as_deref() == Some(FORMAT) {
        let stored = parse_analysis(text)?;
        Ok((stored.case_file, Some(stored.request)))
    } else {
        Ok((parse_case_file(text)?, None))
    }
}
