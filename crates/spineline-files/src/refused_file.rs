//! A case without a result, as it stands among analyses and in the file of a cohort.

use serde::Serialize;
use spineline::cohort::{RefusalStep, RefusedCase};

/// A given case without a result.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct RefusedRecord {
    /// Name of its file, without folders.
    file: String,
    /// `null` where the file could not be read.
    case_id: Option<String>,
    /// Step at which it stopped.
    step: RefusalStep,
    /// What is wrong.
    reason: String,
}

impl RefusedRecord {
    pub fn new(refused: &RefusedCase) -> Self {
        Self {
            file: refused.file.clone(),
            case_id: refused.case_id.clone(),
            step: refused.step,
            reason: refused.reason.clone(),
        }
    }
}

/// An item of a list of analyses that stands for a case without a result.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[cfg_attr(test, schemars(title = "Spineline refused case, version 1"))]
pub struct RefusedFile {
    format: String,
    version: u32,
    refused: RefusedRecord,
}

impl RefusedFile {
    /// The item of a refused case.
    #[must_use]
    pub fn new(refused: &RefusedCase) -> Self {
        Self {
            format: "spineline-refused-case".to_owned(),
            version: 1,
            refused: RefusedRecord::new(refused),
        }
    }
}
