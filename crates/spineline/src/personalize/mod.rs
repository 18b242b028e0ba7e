//! Step 7: bending films and a line of action → stiffness multipliers and forces.
//!
//! # Model
//! Unknown are `ln α` per group of joints (lateral springs, shared by all bends) and the components of the load of every bend: one force
//! along a line that geometry gives, three components for the estimated line and for other loads. The data are the whole shape, or as in
//! [petit-2004] the Ferguson angles of three regions per bend with its amplitude held. Minimised is the sum of the squares of residuals,
//! of the prior and of the gauge. Residuals of shapes are in their standard deviations. Ferguson angles count in units of 1°, an
//! assumption and not the noise of the films.
//!
//! # Only ratios are identified
//! Scaling every spring and every force by one number changes no shape, so a [`Gauge`] fixes the level. Where the springs carry a weight,
//! this scaling changes shapes, because the weight is in newtons: the level that the gauge holds is then an assumption, on which the ratios
//! depend.
//!
//! # Steps
//! 1. [`evidence`]: rotation and lever arm of every joint are both measured on the film, which gives a start in closed
//!    form, the joints that no positive stiffness can explain, and the estimated line ([`estimate`]). The line of best fit
//!    comes from the mixed model of the rotations (`mixed`).
//! 2. Bounded Levenberg-Marquardt on analytic derivatives of the march, from that start and, where the fit does not
//!    satisfy the data, from others in a fixed order.
//!
//! # References
//! [petit-2004]; [jalalian-loa], section 3.2; [more-1978] for the minimisation.

pub mod estimate;
pub mod evidence;
mod film;
mod fit;
mod identify;
mod mixed;
mod outcome;
mod personalization;
mod problem;
mod search;
mod shape_weights;
mod start;
mod starts;

pub use crate::least_squares::FitStatus;
pub(crate) use film::FilmData;
pub use fit::personalize;
pub use identify::{
    Identifiability, IntervalVerdict, MULTIPLIER_COVERAGE, MultiplierInformation, Profile,
    ProfileEnd, ProfilePoint, STIFFNESS_COVERAGE, StiffnessDirection, identify,
};
pub(crate) use mixed::predict_stiffness;
pub use mixed::{
    BestFitLoads, Crossing, GroupStiffness, LineTest, NoLoads, ProposedLine, SIGNIFICANCE,
};
pub use outcome::TestOutcome;
pub use personalization::{Personalization, StiffnessBound};
pub(crate) use problem::Problem;
pub(crate) use search::fit;
pub(crate) use shape_weights::ShapeWeights;
pub use start::Start;

use crate::anatomy::{Posture, named};
use crate::clinical::Regions;
use crate::measure::Outline;
use crate::multibody::{Load, Support};
use evidence::FilmEvidence;

/// The scale constraint, which fixes the overall level of stiffness and force.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Gauge {
    /// Mean `ln α` is zero: multipliers are ratios, forces have no absolute meaning.
    #[default]
    GeometricMean,
    /// The force of one posture is known in newtons: springs about all axes and forces are scaled to it.
    KnownForce {
        /// The posture.
        posture: Posture,
        /// Its force along the line.
        force_n: f64,
    },
    /// Forces stay what the nominal springs needed for the amplitudes.
    FrozenForce,
}

impl Gauge {
    /// Forces that a film can be taken under, in N: from one that moves no spine to more than twice a body's weight (assumption).
    pub const FORCES_N: [f64; 2] = [1.0, 2000.0];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::GeometricMean => "geometric_mean",
            Self::KnownForce { .. } => "known_force",
            Self::FrozenForce => "frozen_force",
        }
    }
}

named! {
    /// What is fitted.
    #[default(Shape)]
    pub enum FitTarget {
        /// Locations and tilts of all vertebrae.
        ///
        /// Each is weighted by its noise; the force is fitted with the stiffness.
        Shape = "shape",
        /// Three Ferguson angles per bend, with the amplitude fixed (the paper).
        Ferguson = "ferguson",
    }
}

named! {
    /// Rule for the angle by which the whole spine may turn about L4 on a film.
    #[default(Fixed)]
    pub enum Base {
        /// It is zero (the paper).
        Fixed = "fixed_base",
        /// It is normal about zero, with the deviation that reading L4's axis on both films gives: the covariance that a shared
        /// frame makes between all locations and tilts of a film.
        Noisy = "noisy_base",
        /// It is free on every fitted film.
        Free = "free_base",
    }
}

impl Base {
    /// Free angles per fitted film.
    #[must_use]
    pub const fn angles(self) -> usize {
        match self {
            Self::Fixed => 0,
            Self::Noisy | Self::Free => 1,
        }
    }
}

/// Prior of the stiffness: every multiplier's distance from their mean, `ln α - mean ln α`, is normal
/// about zero. Like the films, it concerns only ratios.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogNormalPrior {
    /// Standard deviation of `ln α`.
    pub log_sd: f64,
}

impl LogNormalPrior {
    /// How much segments of living scoliotic spines differ: flexibilities of 0.13 ± 0.07 °/N·m under suspension and of
    /// 0.18 ± 0.08 °/N·m in surgery are log-normal deviations of 0.51 and 0.42.
    ///
    /// # References
    /// [buechler-2014], [reutlinger-2012].
    pub const IN_VIVO: Self = Self { log_sd: 0.5 };
}

/// Bounds of a multiplier.
pub const MULTIPLIER_BOUNDS: [f64; 2] = [0.1, 10.0];

/// One bend to be fitted.
#[derive(Debug, Clone, Copy)]
pub struct FitFilm<'a> {
    /// What was measured.
    pub outline: &'a Outline,
    /// Rotations and lever arms of its joints.
    pub evidence: &'a FilmEvidence,
    /// Where the force acts. A frontal load ([`Load::Frontal`]) is fitted with its direction and place.
    pub load: Load,
}

/// The settings of a fit.
#[derive(Debug, Clone, Copy)]
pub struct FitSettings<'a> {
    /// Regions of the Ferguson angles.
    pub regions: &'a Regions,
    /// What is fitted.
    pub target: FitTarget,
    /// What fixes the level.
    pub gauge: Gauge,
    /// What holds the patient.
    pub support: Support,
    /// The prior of the multipliers; `None` for the films alone.
    pub prior: Option<LogNormalPrior>,
    /// Starts beside those in closed form, such as the results of a fit with another line.
    pub hints: &'a [Start],
}

impl<'a> FitSettings<'a> {
    /// Whole shapes by ratios of stiffness alone, without a prior and without hints.
    #[must_use]
    pub const fn of_shapes(regions: &'a Regions, support: Support) -> Self {
        let (target, gauge) = (FitTarget::Shape, Gauge::GeometricMean);
        Self { regions, target, gauge, support, prior: None, hints: &[] }
    }

    /// The same for films whose variance about the model is a factor of the noise's: residuals stay in standard deviations of the
    /// noise, and the variance of the prior is divided by the factor.
    pub(crate) fn weighed(&self, variance_factor: f64) -> Self {
        let weighed = |prior: LogNormalPrior| LogNormalPrior {
            log_sd: prior.log_sd / variance_factor.sqrt(),
        };
        Self { prior: self.prior.map(weighed), ..*self }
    }
}
