//! The inputs of an analysis, read from its file.

use serde::Deserialize;
use serde_json::Value;
use spineline::analysis::Case;
use spineline::warning::{WarningCode, Warnings};

use super::{FORMAT, VERSION};
use crate::case_file::parse_case_file;
use crate::json::{format_of, parse};
use crate::{CaseFile, FileError, Provenance, Request};

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

/// The two parts that are needed to repeat it; results of other versions are ignored.
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

/// The warnings about pictures beside the case in the file of an analysis: without the pictures they cannot be found again.
#[must_use]
pub fn picture_warnings(file: &Value) -> Warnings {
    let mut found = Warnings::default();
    for warning in file["warnings"].as_array().into_iter().flatten() {
        let code = warning["code"].as_str().and_then(|key| key.parse().ok());
        let Some(code) = code.filter(|code: &WarningCode| code.is_of_picture()) else { continue };
        let text = warning["message"].as_str().unwrap_or_default();
        match warning["posture"].as_str().and_then(|key| key.parse().ok()) {
            Some(posture) => found.film(code, posture, text),
            None => found.push(code, text),
        }
    }
    found
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
