use std::fmt;

use super::SIGNIFICANCE;

/// How the test of a hypothesis ends. All outputs use these three words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TestOutcome {
    /// The data contradict the hypothesis: its probability is below [`SIGNIFICANCE`].
    Rejected,
    /// The test was made and does not reject the hypothesis. This does not prove it.
    Kept,
    /// The test could not be made, so that the data say nothing about the hypothesis.
    NotTested,
}

impl TestOutcome {
    /// All outcomes.
    pub const ALL: [Self; 3] = [Self::Rejected, Self::Kept, Self::NotTested];

    /// The outcome of a test with this p value; `None` where the test could not be made.
    #[must_use]
    pub fn of(p_value: Option<f64>) -> Self {
        match p_value {
            Some(p) if p < SIGNIFICANCE => Self::Rejected,
            Some(_) => Self::Kept,
            None => Self::NotTested,
        }
    }

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Rejected => "rejected",
            Self::Kept => "kept",
            Self::NotTested => "not_tested",
        }
    }
}

impl fmt::Display for TestOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Rejected => "rejected",
            Self::Kept => "kept",
            Self::NotTested => "not tested",
        })
    }
}
