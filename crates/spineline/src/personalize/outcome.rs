//! The outcome of a test.

use super::SIGNIFICANCE;
use crate::anatomy::named;

named! {
    /// How the test of a hypothesis ends. All outputs use these three words.
    pub enum TestOutcome {
        /// The data contradict the hypothesis (p < 0.05).
        ///
        /// [`SIGNIFICANCE`] is this limit.
        Rejected = "rejected",
        /// The test was made and does not reject the hypothesis. This does not prove it.
        Kept = "kept",
        /// The test could not be made, so that the data say nothing about the hypothesis.
        NotTested = "not_tested" as "not tested",
    }
}

impl TestOutcome {
    /// The outcome of a test with this p value; `None` where the test could not be made.
    #[must_use]
    pub fn of(p_value: Option<f64>) -> Self {
        match p_value {
            Some(p) if p < SIGNIFICANCE => Self::Rejected,
            Some(_) => Self::Kept,
            None => Self::NotTested,
        }
    }
}
