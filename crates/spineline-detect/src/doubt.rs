//! Doubts about the vertebrae that were found.

use std::fmt;

use spineline::number::fixed;

/// Why the levels of a film may be shifted, or vertebrae be missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Doubt {
    /// The upper third of the chain alone gives another count.
    CountFromAbove,
    /// The lower third of the chain alone gives another count.
    CountFromBelow,
    /// Another count is nearly as probable.
    OtherCount {
        /// Probability of the chosen count.
        probability: f64,
    },
    /// Another vertebra may follow above the uppermost one.
    MoreAbove,
    /// Another vertebra may follow below the lowest one.
    MoreBelow,
    /// The uppermost or the lowest vertebra is improbable.
    WeakEnd,
    /// Fewer than 17 vertebrae.
    Incomplete {
        /// Vertebrae that were found.
        found: usize,
    },
    /// A vertebra was interpolated between two others.
    FilledIn,
    /// Vertebrae with a corner beyond the edge of the film were left out.
    BeyondEdge {
        /// How many.
        vertebrae: usize,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CountFromAbove => f.write_str("the levels by a count from above differ"),
            Self::CountFromBelow => f.write_str("the levels by a count from below differ"),
            Self::OtherCount { probability } => {
                write!(
                    f,
                    "the probability of these levels is only {} %",
                    fixed(100.0 * probability, 0)
                )
            }
            Self::MoreAbove => f.write_str("another vertebra may follow above"),
            Self::MoreBelow => f.write_str("another vertebra may follow below"),
            Self::WeakEnd => f.write_str("the uppermost or the lowest vertebra is improbable"),
            Self::Incomplete { found } => write!(f, "{found} of 17 vertebrae were found"),
            Self::BeyondEdge { vertebrae } => {
                write!(
                    f,
                    "{vertebrae} of them would lie beyond the edge of the film and are left out"
                )
            }
            Self::FilledIn => f.write_str("an unseen vertebra was placed between its neighbours"),
        }
    }
}
