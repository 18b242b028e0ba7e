//! Why corners could not be completed.

use crate::anatomy::Level;

/// Why corners could not be completed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CompletionError {
    /// The program has provided no table ([`super::provide_shape`]).
    #[error("this program was built without the shape of spines that completes corners")]
    NoShape,
    /// Fewer than two clicks on vertebrae, or all at one place.
    #[error(
        "corners cannot be completed from {clicks} clicks on vertebrae: two that lie apart are needed"
    )]
    TooFew {
        /// Clicks on vertebrae.
        clicks: usize,
    },
    /// A coordinate is not finite.
    #[error("{level}: the place of a click is not a finite number")]
    NotFinite {
        /// Vertebra.
        level: Level,
    },
    /// The most probable shape was not found.
    #[error(
        "corners could not be completed: the shape did not converge in {iterations} iterations; check the levels of the clicks"
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
    },
}
