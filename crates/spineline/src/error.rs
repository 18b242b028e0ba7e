//! Errors that stop an analysis, by step, with their remedies.

use crate::anatomy::{Level, Posture};
use crate::chain::ChainError;
use crate::curve::CurveError;
use crate::measure::{LateralFault, MeasureError};
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
    /// Both bends are tilted to the wrong side of the erect film, beyond noise.
    #[error("from the erect film, the lateral tilt changes by {} on the left bending film and by {} on the right bending film: the two films are exchanged", left.leaning(), right.leaning())]
    BendsExchanged {
        /// Change of the lateral tilt from the erect film on the film named left; positive to the right.
        left: Angle,
        /// The same on the film named right.
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

/// What an error is about, as far as it is about one film, vertebra or value.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorPlace {
    /// The frontal film.
    pub posture: Option<Posture>,
    /// Whether it is the lateral film.
    pub on_lateral_film: bool,
    /// The vertebra; of two, the upper one.
    pub level: Option<Level>,
    /// The value that cannot be used, in the unit of the message.
    pub value: Option<f64>,
    /// Its limit.
    pub limit: Option<f64>,
}

impl Error {
    /// What it is about, for programs; the message says the same in words.
    #[must_use]
    pub fn place(&self) -> ErrorPlace {
        let none = ErrorPlace::default();
        match self {
            Self::Case(CaseError::PostureTwice { posture }) => on_film(*posture),
            Self::Case(CaseError::FilmRepeated { second, .. }) => on_film(*second),
            Self::Case(CaseError::Age { age_years, limit_years }) => {
                ErrorPlace { value: Some(*age_years), limit: Some(*limit_years), ..none }
            }
            Self::Case(CaseError::NoErectFilm | CaseError::BendsExchanged { .. }) => none,
            Self::Measure(MeasureError::LateralFilm(fault)) => place_of_lateral(fault),
            Self::Measure(error) => place_of_film(error),
            Self::Curve(CurveError::Order { order, limit }) => {
                ErrorPlace { value: Some(*order as f64), limit: Some(*limit as f64), ..none }
            }
            Self::Curve(CurveError::Singular { posture, order }) => {
                ErrorPlace { value: Some(*order as f64), ..on_film(*posture) }
            }
            Self::Chain(ChainError::TooShort { length_mm: value, .. })
            | Self::Chain(ChainError::NoLength { erect_mm: value }) => {
                ErrorPlace { value: Some(*value), ..none }
            }
            Self::Chain(ChainError::Window { .. }) => none,
            Self::Stiffness(
                StiffnessError::Missing { superior, .. } | StiffnessError::Twice { superior, .. },
            ) => ErrorPlace { level: Some(*superior), ..none },
            Self::Stiffness(StiffnessError::Value { superior, value, .. }) => {
                ErrorPlace { level: Some(*superior), value: Some(*value), limit: Some(0.0), ..none }
            }
            Self::Stiffness(StiffnessError::Coupling { superior, value, .. }) => {
                ErrorPlace { level: Some(*superior), value: Some(*value), ..none }
            }
        }
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
                "give every joint from L4/L3 to T3/T2 one row with three positive values in N·mm/rad, and a coupling between -2 and 2"
            }
        }
    }
}

fn on_film(posture: Posture) -> ErrorPlace {
    ErrorPlace { posture: Some(posture), ..ErrorPlace::default() }
}

fn place_of_film(error: &MeasureError) -> ErrorPlace {
    use MeasureError as E;
    match error {
        E::NoReading { posture }
        | E::DuplicateReading { posture, .. }
        | E::Observer { posture, .. }
        | E::AxesExchanged { posture, .. }
        | E::NoCommonEnd { posture, .. }
        | E::CornerOrder { posture, .. }
        | E::FilmMirrored { posture, .. } => on_film(*posture),
        E::Spacing { posture, value, .. } => {
            ErrorPlace { value: Some(*value), ..on_film(*posture) }
        }
        E::FilmTooLarge { posture, fault } => ErrorPlace {
            value: Some(fault.size_mm),
            limit: Some(fault.limit_mm),
            ..on_film(*posture)
        },
        E::BodySize { posture, level, size_mm, least_mm, most_mm, .. } => ErrorPlace {
            level: Some(*level),
            value: Some(*size_mm),
            limit: Some(if size_mm < least_mm { *least_mm } else { *most_mm }),
            ..on_film(*posture)
        },
        E::Length { posture, size } => {
            ErrorPlace { value: Some(size.value()), limit: Some(size.limit()), ..on_film(*posture) }
        }
        E::TiltsInRadians { posture, .. } | E::TiltsReversed { posture, .. } => on_film(*posture),
        E::ScaleSd { posture, value, most } => {
            ErrorPlace { value: Some(*value), limit: Some(*most), ..on_film(*posture) }
        }
        E::TopMissing { posture, highest } => ErrorPlace { level: *highest, ..on_film(*posture) },
        E::BaseMissing { posture, lowest } => {
            ErrorPlace { level: Some(*lowest), ..on_film(*posture) }
        }
        E::Gap { posture, superior, missing, limit, .. } => ErrorPlace {
            level: Some(*superior),
            value: Some(*missing as f64),
            limit: Some(*limit as f64),
            ..on_film(*posture)
        },
        E::NotFinite { posture, level, .. }
        | E::Corners { posture, level, .. }
        | E::Pedicles { posture, level, .. }
        | E::OffImage { posture, level, .. } => {
            ErrorPlace { level: Some(*level), ..on_film(*posture) }
        }
        E::CrestOffImage { posture, .. } => on_film(*posture),
        E::CornerSd { posture, level, value, most, .. } => ErrorPlace {
            level: Some(*level),
            value: Some(*value),
            limit: Some(*most),
            ..on_film(*posture)
        },
        E::Confidence { posture, level, value, .. } => {
            ErrorPlace { level: Some(*level), value: Some(*value), ..on_film(*posture) }
        }
        E::Lateral { level, .. } => {
            ErrorPlace { on_lateral_film: true, level: Some(*level), ..ErrorPlace::default() }
        }
        E::LateralFilm(fault) => place_of_lateral(fault),
        E::Crests { posture, apart_mm, limit_mm, .. } => {
            ErrorPlace { value: Some(*apart_mm), limit: Some(*limit_mm), ..on_film(*posture) }
        }
        E::OutOfOrder { posture, superior, share, limit, .. } => ErrorPlace {
            level: Some(*superior),
            value: Some(*share),
            limit: Some(*limit),
            ..on_film(*posture)
        },
        E::TiltTooLarge { posture, level, tilt_deg, limit_deg, .. } => ErrorPlace {
            level: Some(*level),
            value: Some(*tilt_deg),
            limit: Some(*limit_deg),
            ..on_film(*posture)
        },
    }
}

fn place_of_lateral(fault: &LateralFault) -> ErrorPlace {
    let lateral = ErrorPlace { on_lateral_film: true, ..ErrorPlace::default() };
    match fault {
        LateralFault::Observer { .. }
        | LateralFault::DuplicateReading { .. }
        | LateralFault::CornerOrder { .. } => lateral,
        LateralFault::Length { size } => {
            ErrorPlace { value: Some(size.value()), limit: Some(size.limit()), ..lateral }
        }
        LateralFault::Spacing { value, .. } => ErrorPlace { value: Some(*value), ..lateral },
        LateralFault::NotFinite { level, .. } | LateralFault::OffImage { level, .. } => {
            ErrorPlace { level: Some(*level), ..lateral }
        }
        LateralFault::OutOfOrder { superior, share, limit, .. } => ErrorPlace {
            level: Some(*superior),
            value: Some(*share),
            limit: Some(*limit),
            ..lateral
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_tells_programs_the_film_the_vertebra_the_value_and_the_limit() {
        let error = MeasureError::TiltTooLarge {
            posture: Posture::Traction,
            base: Level::L4,
            level: Level::T5,
            tilt_deg: 91.0,
            limit_deg: 85.0,
        };
        let expected = ErrorPlace {
            posture: Some(Posture::Traction),
            on_lateral_film: false,
            level: Some(Level::T5),
            value: Some(91.0),
            limit: Some(85.0),
        };
        assert_eq!(Error::from(error).place(), expected);
        let fault = LateralFault::Spacing { direction: "column", value: -1.0 };
        let place = Error::from(MeasureError::from(fault)).place();
        assert!(place.on_lateral_film && place.posture.is_none() && place.value == Some(-1.0));
    }
}
