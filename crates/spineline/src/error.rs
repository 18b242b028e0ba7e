//! Errors that stop an analysis, by step, with their remedies.

use crate::anatomy::{FilmView, Posture};
use crate::chain::ChainError;
use crate::curve::CurveError;
use crate::fault::{Remedy, faults};
use crate::measure::MeasureError;
use crate::multibody::StiffnessError;
use crate::spatial::Angle;
use crate::warning::Step;

pub use crate::fault::ErrorPlace;

faults! {
    /// A case whose films do not fit together, or not the options.
    pub enum CaseError {
        /// No erect film.
        #[error("the erect film, the reference of every posture, is missing")]
        #[code("no_erect_film")]
        #[help("add the erect film")]
        NoErectFilm,
        /// Two films of one posture.
        #[error("there are two {posture} films")]
        #[code("posture_twice")]
        #[help("give every posture one film; several readings belong to one film")]
        #[at(film = FilmView::from(*posture))]
        PostureTwice {
            posture: Posture,
        },
        /// A known force scales the springs, which carry a stated weight.
        #[error("a known force scales the springs after the fit, and then they do not balance the weight of a loaded reference")]
        #[code("weight_and_known_force")]
        #[help("leave out one of the two options")]
        WeightAndKnownForce,
        /// Stiffness of single joints is to be fitted to Ferguson angles.
        #[error("multipliers per joint cannot be fitted to Ferguson angles: a film has three of them, for all joints")]
        #[code("ferguson_per_joint")]
        #[help("fit to the shape, or give each region one multiplier")]
        FergusonPerJoint,
        /// An age that no patient can have.
        #[error("the age of the patient is {age_years} years, and must be from 0 to {limit_years}")]
        #[code("age")]
        #[help("correct `age_years` of the subject, or leave it out")]
        #[at(value = *age_years, limit = ErrorPlace::limit(*age_years, 0.0, *limit_years))]
        Age {
            age_years: f64,
            /// The largest that is taken.
            limit_years: f64,
        },
        /// Two films carry the same landmarks.
        #[error("the {first} film and the {second} film have the same landmarks: one film stands for two")]
        #[code("film_repeated")]
        #[help("give each posture and view its own film, or leave the repeated one out of the case")]
        #[at(film = *second)]
        FilmRepeated {
            /// One of them.
            first: FilmView,
            /// The other.
            second: FilmView,
        },
        /// Both bends are tilted to the wrong side of the erect film, beyond noise.
        #[error("from the erect film, the lateral tilt changes by {} on the left bending film and by {} on the right bending film: the two films are exchanged", left.leaning(), right.leaning())]
        #[code("bends_exchanged")]
        #[help("exchange the postures of the two films, or correct `patient_left` of both images")]
        BendsExchanged {
            /// Change of the lateral tilt from the erect film on the film named left; positive to the right.
            left: Angle,
            /// The same on the film named right.
            right: Angle,
        },
    }
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

/// Calls a method of the error of a step.
macro_rules! of_step {
    ($error:expr, $says:ident) => {
        match $error {
            Error::Case(error) => error.$says(),
            Error::Measure(error) => error.$says(),
            Error::Curve(error) => error.$says(),
            Error::Chain(error) => error.$says(),
            Error::Stiffness(error) => error.$says(),
        }
    };
}

impl Error {
    /// What it is about, for programs; the message says the same in words.
    #[must_use]
    pub fn place(&self) -> ErrorPlace {
        of_step!(self, place)
    }

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
    pub fn code(&self) -> &'static str {
        of_step!(self, code)
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> &'static str {
        of_step!(self, help)
    }
}

impl Remedy for Error {
    fn help(&self) -> &'static str {
        Error::help(self)
    }

    fn place(&self) -> ErrorPlace {
        Error::place(self)
    }
}
