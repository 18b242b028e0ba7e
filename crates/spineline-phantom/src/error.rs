//! Phantoms that cannot be made.

use spineline::anatomy::Posture;

/// A phantom that cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PhantomError {
    /// Table 1 does not have this row.
    #[error("subject {number} is not one of the 18 of the paper's Table 1")]
    NoSubject {
        /// Requested number, from 1.
        number: usize,
    },
    /// No erect curve has these angles.
    #[error("no erect curve with the angles of subject {number} was found")]
    NoCurve {
        /// Number of the subject, from 1.
        number: usize,
    },
    /// The construction does not take the loading scenario.
    #[error("{scenario} moves spines of construction `rod`, not `{construction}`")]
    Construction {
        /// Loading scenario.
        scenario: &'static str,
        /// Construction.
        construction: &'static str,
    },
    /// The force that should move the spine was not found.
    #[error("subject {number}, {scenario}: the force for the {posture} posture was not found")]
    NoForce {
        /// Number of the subject, from 1.
        number: usize,
        /// Loading scenario.
        scenario: &'static str,
        /// Posture.
        posture: Posture,
    },
}
