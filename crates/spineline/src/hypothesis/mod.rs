//! Loads other than one force along a line, and which of them the films support.
//!
//! # Model
//! A [`Hypothesis`] is the kind of load that acts on every bend ([`LoadShape`], with one to three free components per film)
//! and the rule for the base ([`Base`]). [`crate::personalize`] fits it, with equilibria by [`GeneralStatics`]: loads may act on
//! every vertebra and move with it. A line fixed in space is one of them, so that the same equilibrium compares the paper's line with
//! its alternatives.
//!
//! # The base
//! L4 is the origin of every film's frame and its axis is the axis of the frame, so that L4 is at rest by definition and its turn
//! in the patient is not visible. An error of L4's axis on a film, or a turn of L4 under the soft tissue that the erect film does not
//! show, turns **everything above by one angle** and changes no angle between two vertebrae. This angle about L4's midpoint
//! belongs to the base: held at zero, with a prior by the noise of two axes, or free.
//!
//! # What decides
//! Never the fit. Films that were not fitted ([`Role::HeldOut`], [`Role::LeftOut`]) are predicted from T2's place alone, two
//! numbers for every hypothesis; [`Criteria`] count the parameters of the fit. Two numbers do not determine a load of several
//! components and the film's scale. So bends are predicted in two more ways, with the inputs of predictions without mechanics: a
//! distribution of joint rotations ([`Role::LeftOutWithPrior`]), and T2's tilt beside it ([`Role::LeftOutWithTilt`]).
//!
//! # References
//! [jalalian-loa], [petit-2004]; [burnham-2002] for the criteria.
//!
//! [`GeneralStatics`]: crate::multibody::GeneralStatics

mod comparison;
mod criteria;
mod fit;
mod from_top;
mod loads;
mod near_t2;
mod prediction;

pub use comparison::{HypothesisComparison, HypothesisScores, HypothesisSummary, compare};
pub use criteria::Criteria;
pub use fit::{HypothesisFit, LostPrediction, fit_hypothesis};
pub use prediction::{CounterRotatingJoints, Role, ShapePrediction};

use serde::{Deserialize, Serialize};

use crate::anatomy::named;
use crate::evaluate::RotationPrior;
use crate::measure::Outline;
use crate::multibody::FittedSprings;
use crate::personalize::evidence::FilmEvidence;
use crate::personalize::{Base, FitSettings};
use crate::spatial::Frontal;

named! {
    /// Load on the spine of one film, with the number of free components per film.
    pub enum LoadShape {
        /// A force along the line through the two inflections, carried by T2 (the paper): 1.
        InflectionLine = "inflection_line",
        /// A force at T2 parallel to the iliac line (Petit): 1.
        IliacLine = "iliac_line",
        /// Any force and moment in the frontal plane, carried by T2: 3.
        FreeLine = "free_line",
        /// The force of the inflection line, and one at the apex of the largest erect curve, parallel to the iliac line: 2.
        TwoForces = "two_forces",
        /// Weight of the trunk's slices, head and arms at their vertebrae, along the film's vertical: 1.
        Weight = "weight",
        /// A force parallel to the iliac line, spread evenly over the length of the spine: 1.
        Lateral = "lateral_load",
        /// As [`LoadShape::Lateral`], with a second part that grows with height: 2.
        GradedLateral = "graded_lateral_load",
        /// The same moment about every joint, as a muscle along one side makes: 1.
        Couple = "couple",
        /// A moment that falls or grows evenly with height, as muscles that end at every vertebra make: 2.
        GradedCouple = "graded_couple",
    }
}

impl LoadShape {
    /// Free components per film.
    #[must_use]
    pub const fn components(self) -> usize {
        match self {
            Self::InflectionLine
            | Self::IliacLine
            | Self::Weight
            | Self::Lateral
            | Self::Couple => 1,
            Self::TwoForces | Self::GradedLateral | Self::GradedCouple => 2,
            Self::FreeLine => 3,
        }
    }
}

/// A load and a base that may have bent a spine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Hypothesis {
    /// The load.
    pub load: LoadShape,
    /// The base.
    pub base: Base,
}

impl Hypothesis {
    /// A load on a fixed base.
    #[must_use]
    pub const fn of(load: LoadShape) -> Self {
        Self { load, base: Base::Fixed }
    }

    /// The hypotheses of a comparison: every load on a fixed base, and the other bases for the paper's line, the free line and the
    /// couples.
    #[must_use]
    pub fn compared() -> Vec<Self> {
        let fixed = LoadShape::ALL.map(Self::of);
        let others = [
            LoadShape::InflectionLine,
            LoadShape::FreeLine,
            LoadShape::Couple,
            LoadShape::GradedCouple,
        ]
        .into_iter()
        .flat_map(|load| [Base::Noisy, Base::Free].map(|base| Self { load, base }));
        fixed.into_iter().chain(others).collect()
    }

    /// The name used in files, such as `couple+free_base`.
    #[must_use]
    pub fn key(self) -> String {
        match self.base {
            Base::Fixed => self.load.key().to_owned(),
            base => format!("{}+{}", self.load.key(), base.key()),
        }
    }

    /// Parameters of a fit to this number of films, with `groups` multipliers under one scale constraint.
    #[must_use]
    pub const fn free_numbers(self, films: usize, groups: usize) -> usize {
        groups - 1 + films * (self.load.components() + self.base.angles())
    }
}

impl std::fmt::Display for Hypothesis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(&self.key().replace('_', " ").replace('+', ", "))
    }
}

/// A text that names no hypothesis.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "unknown load `{text}`; give one of {}, followed by +noisy_base or +free_base if the base may rotate",
    LoadShape::ALL.map(LoadShape::key).join(", ")
)]
pub struct HypothesisNameError {
    /// What was given.
    pub text: String,
}

impl std::str::FromStr for Hypothesis {
    type Err = HypothesisNameError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let plain = text.trim().replace('-', "_");
        let (load, base) = plain.split_once('+').unwrap_or((&plain, Base::Fixed.key()));
        let unknown = |_| HypothesisNameError { text: text.to_owned() };
        Ok(Self { load: load.parse().map_err(unknown)?, base: base.parse().map_err(unknown)? })
    }
}

/// A film that takes part.
#[derive(Debug, Clone)]
pub struct HypothesisFilm<'a> {
    /// What was measured.
    pub outline: &'a Outline,
    /// Rotations and centres of its joints.
    pub evidence: FilmEvidence,
    /// Where the two inflections lie on it.
    pub inflections: Option<[Frontal; 2]>,
}

impl<'a> HypothesisFilm<'a> {
    /// A film of a spine.
    #[must_use]
    pub fn new(
        outline: &'a Outline,
        inflections: Option<[Frontal; 2]>,
        springs: FittedSprings<'_>,
    ) -> Self {
        let FittedSprings { model, library, erect, .. } = springs;
        let evidence = FilmEvidence::measure(model, library, erect, outline);
        Self { outline, evidence, inflections }
    }

    /// The same film with its outline at another scale.
    fn at_scale_of<'b>(&self, outline: &'b Outline, spine: &Spine<'_>) -> HypothesisFilm<'b> {
        let factor = self.outline.length.scale.factor / outline.length.scale.factor;
        let inflections = self.inflections.map(|points| points.map(|point| point * factor));
        HypothesisFilm::new(outline, inflections, spine.springs)
    }
}

/// A patient's spine, and what all fits to it share.
#[derive(Debug, Clone, Copy)]
pub struct Spine<'a> {
    /// The unloaded spine with its springs.
    pub springs: FittedSprings<'a>,
    /// The settings of the fits. Whole shapes are fitted, so that the criteria of all hypotheses count the same data.
    pub settings: FitSettings<'a>,
    /// Prior of joint rotations.
    pub rotations: &'a RotationPrior,
    /// Sagittal place of lines fixed in space.
    pub depth_mm: f64,
    /// The vertebra at the apex of the largest erect curve.
    pub apex: usize,
}
