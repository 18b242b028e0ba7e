//! What stops an analysis, by step, with what the user can do about it.

use crate::anatomy::Posture;
use crate::chain::ChainError;
use crate::curve::CurveError;
use crate::measure::MeasureError;
use crate::multibody::StiffnessError;
use crate::spatial::Angle;
use crate::warning::Step;

/// A case whose films do not fit together.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError {
    /// No erect film.
    #[error("there is no erect film, which is the reference of every posture")]
    NoErectFilm,
    /// Two films of one posture.
    #[error("there are two {posture} films")]
    PostureTwice {
        /// The posture.
        posture: Posture,
    },
    /// The left bend leans to the right of the right bend.
    #[error("the lateral tilt is {} on the left bending film and {} on the right bending film: the two films are exchanged", left.leaning(), right.leaning())]
    BendsExchanged {
        /// Lean of the film called left.
        left: Angle,
        /// Lean of the film called right.
        right: Angle,
    },
}

/// Anything that stops an analysis. Always bad input: numerical endings are data, and bugs panic.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Films that do not fit together.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// Step 1.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// Step 2.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// Step 3.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// Step 6.
    #[error(transparent)]
    Stiffness(#[from] StiffnessError),
}

impl Error {
    /// The step that refused.
    #[must_use]
    pub const fn step(&self) -> Step {
        match self {
            Self::Case(_) | Self::Measure(_) => Step::Measure,
            Self::Curve(_) => Step::Curve,
            Self::Chain(_) => Step::Chain,
            Self::Stiffness(_) => Step::Multibody,
        }
    }

    /// A stable name, as for counts of endings.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Case(CaseError::NoErectFilm) => "no_erect_film",
            Self::Case(CaseError::PostureTwice { .. }) => "posture_twice",
            Self::Case(CaseError::BendsExchanged { .. }) => "bends_exchanged",
            Self::Measure(error) => error.code(),
            Self::Curve(CurveError::Order { .. }) => "curve_order",
            Self::Curve(CurveError::Singular { .. }) => "curve_singular",
            Self::Chain(ChainError::Window { .. }) => "segment_window",
            Self::Chain(ChainError::TooShort { .. }) => "curve_too_short",
            Self::Stiffness(_) => "stiffness",
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> &'static str {
        match self {
            Self::Case(CaseError::NoErectFilm) => "add the erect film",
            Self::Case(CaseError::PostureTwice { .. }) => {
                "give every posture one film; several readings belong to one film"
            }
            Self::Case(CaseError::BendsExchanged { .. }) => {
                "exchange the postures of the two films, or correct `patient_left` of both images"
            }
            Self::Measure(error) => error.help(),
            Self::Curve(_) => "use an order from 4 to 12, or `leave-one-out`",
            Self::Chain(ChainError::Window { .. }) => {
                "give a window that contains at least one number of segments"
            }
            Self::Chain(_) => {
                "check the spacing of the films: their curves should be about equally long"
            }
            Self::Stiffness(_) => {
                "give every joint from L4/L3 to T3/T2 one row with three positive values in N·mm/rad"
            }
        }
    }
}
