//! How sure the levels of a film are.

use std::fmt;

use spineline::number::fixed;
use spineline::warning::levels_apart;

/// Below this probability a person is asked to check the levels.
const MIN_PROBABILITY: f64 = 0.90;

/// The probability of the levels of all vertebrae of a film, and of the most probable other count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelCount {
    /// Probability that the vertebrae have their levels: geometric mean over the vertebrae.
    pub probability: f64,
    /// By how many levels the most probable other count is further down; negative: further up.
    pub other_shift: isize,
    /// Probability of the other count.
    pub other_probability: f64,
}

impl LevelCount {
    /// Whether a person need not doubt the levels more than usual.
    #[must_use]
    pub fn is_sure(&self) -> bool {
        self.probability >= MIN_PROBABILITY
    }
}

impl fmt::Display for LevelCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| fixed(100.0 * share, 0);
        write!(
            f,
            "{} % probable, {} {} %",
            percent(self.probability),
            levels_apart(-self.other_shift),
            percent(self.other_probability)
        )
    }
}
