//! Given cases that are not part of a cohort.

use crate::anatomy::named;
use crate::warning::counted;

named! {
    /// Step at which a case was refused.
    pub enum RefusalStep {
        /// Its file could not be read.
        Reading = "reading" as "the file could not be read",
        /// Its films could not be analysed.
        Analysis = "analysis" as "the films could not be analysed",
        /// It was analysed, and cannot be counted beside the others.
        Counting = "counting" as "the case cannot be counted beside the others",
        /// The run was interrupted before the case was begun.
        Interruption = "interruption" as "the run was interrupted before the case",
    }
}

/// A given case without a result. Every output of a cohort names it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RefusedCase {
    /// Name of its file, without folders.
    pub file: String,
    /// Identifier of the case; `None` where the file could not be read.
    pub case_id: Option<String>,
    /// Step at which it stopped.
    pub step: RefusalStep,
    /// What is wrong, without what to do.
    pub reason: String,
}

impl RefusedCase {
    /// Its identifier, or else the name of its file.
    #[must_use]
    pub fn name(&self) -> &str {
        self.case_id.as_deref().unwrap_or(&self.file)
    }

    /// How many of all cases were refused; `None` where none was.
    #[must_use]
    pub fn sentence(refused: &[Self], analysed: usize) -> Option<String> {
        let all = counted(analysed + refused.len(), "case");
        (!refused.is_empty())
            .then(|| format!("{} of {all} refused, which no number below contains.", refused.len()))
    }
}
