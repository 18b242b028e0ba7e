//! Errors that stop an analysis, by step, with their remedies.

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
    /// An age that no patient can have.
    #[error("the age of the patient is {age_years} years, and must be from 0 to {limit_years}")]
    Age {
        /// The age.
        age_years: f64,
        /// The largest that is taken.
        limit_years: f64,
    },
    /// Two postures carry the same landmarks.
    #[error(
        "the {first} film and the {second} film have the same landmarks: one film stands for two postures"
    )]
    FilmRepeated {
        /// One posture.
        first: Posture,
        /// The other.
        second: Posture,
    },
    /// The lateral tilts of the two bends are exchanged.
    #[error("the lateral tilt is {} on the left bending film and {} on the right bending film: the two films are exchanged", left.leaning(), right.leaning())]
    BendsExchanged {
        /// Lateral tilt of the film named left.
        left: Angle,
        /// Lateral tilt of the film named right.
        right: Angle,
    },
}

/// An error that stops an analysis. It is always bad input: a fit that does not converge is data, and a bug panics.
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
    /// The step of the error.
    #[must_use]
    pub const fn step(&self) -> Step {
        match self {
            Self::Case(_) | Self::Measure(_) => Step::Measure,
            Self::Curve(_) => Step::Curve,
            Self::Chain(_) => Step::Chain,
            Self::Stiffness(_) => Step::Multibody,
        }
    }

    /// A stable name, for counts.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Case(CaseError::NoErectFilm) => "no_erect_film",
            Self::Case(CaseError::PostureTwice { .. }) => "posture_twice",
            Self::Case(CaseError::Age { .. }) => "age",
            Self::Case(CaseError::FilmRepeated { .. }) => "film_repeated",
            Self::Case(CaseError::BendsExchanged { .. }) => "bends_exchanged",
            Self::Measure(error) => error.code(),
            Self::Curve(CurveError::Order { .. }) => "curve_order",
            Self::Curve(CurveError::Singular { .. }) => "curve_singular",
            Self::Chain(ChainError::Window { .. }) => "segment_window",
            Self::Chain(ChainError::TooShort { .. }) => "curve_too_short",
            Self::Chain(ChainError::NoLength { .. }) => "curve_without_length",
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
            Self::Case(CaseError::Age { .. }) => {
                "correct `age_years` of the subject, or leave it out"
            }
            Self::Case(CaseError::FilmRepeated { .. }) => {
                "give each posture its own film, or leave the repeated one out of the case"
            }
            Self::Case(CaseError::BendsExchanged { .. }) => {
                "exchange the postures of the two films, or correct `patient_left` of both images"
            }
            Self::Measure(error) => error.help(),
            Self::Curve(_) => "use an order from 4 to 12, or `leave-one-out`",
            Self::Chain(ChainError::Window { .. }) => {
                "give a window from at least 1 to at most 100,000 segments, such as 993 to 1003"
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
