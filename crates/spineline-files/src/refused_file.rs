//! A case without a result, as it stands among analyses and in the file of a cohort.

use schemars::JsonSchema;
use serde::Serialize;
use spineline::cohort::RefusedCase;

/// An item of a list of analyses that stands for a case without a result.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(title = "Spineline refused case, version 1")]
pub struct RefusedFile {
    format: String,
    version: u32,
    refused: RefusedCase,
}

impl RefusedFile {
    /// The item of a refused case.
    #[must_use]
    pub fn new(refused: &RefusedCase) -> Self {
        Self { format: "spineline-refused-case".to_owned(), version: 1, refused: refused.clone() }
    }
}
