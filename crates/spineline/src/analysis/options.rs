//! Every choice of an analysis.

use crate::action::{LineKind, LineOfAction};
use crate::anatomy::{Posture, named};
use crate::clinical::EndChoice;
use crate::curve::{InflectionChoice, MIN_TURN, OrderRule};
use crate::evaluate::RotationPrior;
use crate::hypothesis::Hypothesis;
use crate::measure::{AmplitudeEnds, FilmLengthRule, Outline, TiltRule};
use crate::multibody::{StiffnessLibrary, StiffnessTable, Support};
use crate::personalize::{FitTarget, Gauge, LogNormalPrior};
use crate::spatial::Angle;

named! {
    /// Which joints share a multiplier.
    #[default(Regional)]
    pub enum Grouping {
        /// One multiplier per region (the paper).
        ///
        /// After Petit et al., whose method the paper uses.
        Regional = "regional",
        /// One multiplier per region, which end at T12 and T6: the inflections do not enter the stiffness.
        ///
        /// A check of results by region. Ferguson angles keep the regions of the erect curve.
        FixedRegions = "fixed_regions",
        /// One per joint, fitted to the whole shape.
        ///
        /// Three Ferguson angles per film do not give a stiffness of every joint: a fit to them is refused.
        PerJoint = "per_joint",
    }
}

named! {
    /// The method that the other options start from.
    #[default(Default)]
    pub enum Method {
        /// The program's choices.
        Default = "default",
        /// The paper's choices, as far as it states them.
        Paper = "paper",
    }
}

impl Method {
    /// Its choices.
    #[must_use]
    pub fn options(self) -> AnalysisOptions {
        match self {
            Self::Default => AnalysisOptions::default(),
            Self::Paper => AnalysisOptions::paper(),
        }
    }
}

/// What the springs carry in the shape of the erect film, from which all rotations are measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Reference {
    /// Nothing.
    #[default]
    Unloaded,
    /// The weight of trunk, head and arms, which acts on no other film: the patient lies on them.
    Loaded {
        /// Mass of the whole body.
        body_mass_kg: f64,
    },
}

impl Reference {
    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Unloaded => "unloaded",
            Self::Loaded { .. } => "loaded",
        }
    }
}

/// Every choice of an analysis, each with its default.
#[derive(Debug, Clone, PartialEq)]
pub struct AnalysisOptions {
    /// From which landmarks tilts are measured.
    pub tilt: TiltRule,
    /// Between which vertebrae amplitudes are measured.
    pub amplitude: AmplitudeEnds,
    /// How lengths of the films are compared.
    pub film_lengths: FilmLengthRule,
    /// How the order of the curves is chosen.
    pub order_rule: OrderRule,
    /// Where the inflections come from.
    pub inflections: InflectionChoice,
    /// Minimum angle of a curve between inflections of the erect curve.
    pub min_curve: Angle,
    /// How the end vertebrae of Cobb angles are chosen.
    pub ends: EndChoice,
    /// Springs before personalisation.
    pub library: StiffnessLibrary,
    /// What holds the patient.
    pub support: Support,
    /// What the springs carry in the shape of the erect film.
    pub reference: Reference,
    /// The scale constraint, which fixes the overall level of stiffness and force.
    pub gauge: Gauge,
    /// What is fitted.
    pub target: FitTarget,
    /// Which joints share a multiplier.
    pub grouping: Grouping,
    /// Prior of the multipliers; without one, many multipliers per joint are not identified.
    pub prior: Option<LogNormalPrior>,
    /// Distribution of joint rotations from other patients, for predictions without mechanics; `None` for the published one.
    pub rotation_prior: Option<RotationPrior>,
    /// Lines given by the user.
    pub given_lines: Vec<(Posture, LineOfAction)>,
    /// Other loads and bases that are fitted beside the lines; none by default.
    pub hypotheses: Vec<Hypothesis>,
}

impl AnalysisOptions {
    /// The paper's method. Where the paper does not say what it did, the choice is the default.
    ///
    /// # References
    /// [jalalian-loa], by its sections.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            // 2.1: "the line passing through the centre of the upper and lower endplates".
            tilt: TiltRule::Axis,
            // 1, footnote: the line through the midpoints of T1 and L5.
            amplitude: AmplitudeEnds::T1L5,
            // 2.1: one size of a pixel for all X-rays.
            film_lengths: FilmLengthRule::AsMarked,
            // 2.3: the order with the least root mean square error.
            order_rule: OrderRule::Paper,
            // 2.3: "the inflection points of the spine curvature in the erect position".
            inflections: InflectionChoice::Automatic,
            // Not stated.
            min_curve: MIN_TURN,
            // Table 1 has Cobb angles of the erect films only.
            ends: EndChoice::default(),
            // 3.2: Petit's method, on the models that the paper refers to; it prints no stiffness.
            library: StiffnessTable::MotionSegments.library(),
            // 3.2: all degrees of freedom of L4 are fixed; all other vertebrae move.
            support: Support::Free,
            // 3.2: the springs are unstressed in the erect posture; the weight of the trunk is not mentioned.
            reference: Reference::Unloaded,
            // 3.2: not stated; films without a known force show ratios of stiffness only.
            gauge: Gauge::GeometricMean,
            // Introduction and 3.2: Ferguson angles in three regions, with the amplitude of the bend reproduced.
            target: FitTarget::Ferguson,
            // 3.2: Petit's method adjusts the stiffness of regions.
            grouping: Grouping::Regional,
            // 3.2: stiffness follows from the films alone.
            prior: None,
            // The paper has no prediction without mechanics.
            rotation_prior: None,
            // 3.2: Model-1 and Model-2 are always fitted; the paper has no third line.
            given_lines: Vec::new(),
            // The paper compares lines only.
            hypotheses: Vec::new(),
        }
    }

    /// The lines of action that models are fitted with, where there is a bending film.
    pub(crate) fn line_kinds(&self) -> Vec<LineKind> {
        let mut kinds = vec![LineKind::Inflection, LineKind::Iliac, LineKind::Estimated];
        if !self.given_lines.is_empty() {
            kinds.push(LineKind::Given);
        }
        kinds
    }

    /// The distribution of rotations that was given, for a film that it describes: a bend.
    pub(super) fn rotation_prior_of(&self, film: &Outline) -> Option<RotationPrior> {
        let given = self.rotation_prior.as_ref().filter(|_| film.posture.bend().is_some())?;
        given.of(film.levels())
    }

    /// The line that was given for a film, at the film's scale against the erect one.
    pub(super) fn given_line(&self, film: &Outline) -> Option<LineOfAction> {
        let (_, line) = self.given_lines.iter().find(|(p, _)| *p == film.posture)?;
        // It was given on the film as it is.
        let point = line.point * (1.0 / film.length.scale.factor);
        Some(LineOfAction { point, ..*line })
    }
}

impl Default for AnalysisOptions {
    fn default() -> Self {
        Self {
            tilt: TiltRule::default(),
            amplitude: AmplitudeEnds::default(),
            film_lengths: FilmLengthRule::default(),
            order_rule: OrderRule::default(),
            inflections: InflectionChoice::default(),
            min_curve: MIN_TURN,
            ends: EndChoice::default(),
            library: StiffnessLibrary::default(),
            support: Support::default(),
            reference: Reference::default(),
            gauge: Gauge::default(),
            target: FitTarget::default(),
            grouping: Grouping::default(),
            prior: None,
            rotation_prior: None,
            given_lines: Vec::new(),
            hypotheses: Vec::new(),
        }
    }
}
