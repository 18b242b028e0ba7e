//! Cases that were given and have no part in a cohort.

use std::fmt;

use crate::warning::counted;

/// Step at which a case was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RefusalStep {
    /// Its file could not be read.
    Reading,
    /// Its films could not be analysed.
    Analysis,
    /// It was analysed, and cannot be counted beside the others.
    Counting,
}

impl RefusalStep {
    /// All steps, in their order.
    pub const ALL: [Self; 3] = [Self::Reading, Self::Analysis, Self::Counting];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Reading => "reading",
            Self::Analysis => "analysis",
            Self::Counting => "counting",
        }
    }
}

impl fmt::Display for RefusalStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Reading => "the file could not be read",
            Self::Analysis => "the films could not be analysed",
            Self::Counting => "the case cannot be counted beside the others",
        })
    }
}

/// A case that was given and has no result. Every output of a cohort names it.
#[derive(Debug, Clone, PartialEq, Eq)]
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
