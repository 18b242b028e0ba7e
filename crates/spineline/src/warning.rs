//! Soft problems: they stop nothing, but everyone who reads a result sees them, and each says what was done about it.

use crate::anatomy::{Level, Posture};

/// A step of the pipeline, in its order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum Step {
    Measure,
    Curve,
    Clinical,
    Chain,
    Motion,
    Action,
    Multibody,
    Personalize,
    Evaluate,
}

impl Step {
    /// The name of the step, which is the name of its module.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Measure => "measure",
            Self::Curve => "curve",
            Self::Clinical => "clinical",
            Self::Chain => "chain",
            Self::Motion => "motion",
            Self::Action => "action",
            Self::Multibody => "multibody",
            Self::Personalize => "personalize",
            Self::Evaluate => "evaluate",
        }
    }
}

/// How much a soft problem weighs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing: a choice that was made.
    Note,
    /// Something may be wrong.
    Warning,
    /// The data speak against the model, or a number that is shown is no result.
    Contradiction,
}

/// Codes of choices.
const NOTES: [&str; 6] = [
    "iliac_crests_missing",
    "inflections_by_hand",
    "no_bending_film",
    "parametric_curve",
    "reliability_one_reading",
    "usual_regions",
];
/// Codes of what contradicts.
const CONTRADICTIONS: [&str; 4] =
    ["fit_not_converged", "force_not_found", "joints_contradict_line", "multiplier_at_bound"];

/// One soft problem, or the reason why a number is absent.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    /// Stable name, such as `inflections_not_two`.
    pub code: &'static str,
    /// Where it arose.
    pub step: Step,
    /// The film it is about.
    pub posture: Option<Posture>,
    /// The vertebra it is about.
    pub level: Option<Level>,
    /// What happened and what to do, in words.
    pub message: String,
}

impl Warning {
    /// How much it weighs.
    #[must_use]
    pub fn severity(&self) -> Severity {
        if CONTRADICTIONS.contains(&self.code) {
            Severity::Contradiction
        } else if NOTES.contains(&self.code) {
            Severity::Note
        } else {
            Severity::Warning
        }
    }
}

/// The collector that every step with soft problems takes, so that no caller can overlook them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Warnings(Vec<Warning>);

impl Warnings {
    /// Adds a problem of a whole case.
    pub fn push(&mut self, step: Step, code: &'static str, message: impl Into<String>) {
        self.add(step, code, None, None, message.into());
    }

    /// Adds a problem of one film.
    pub fn film(
        &mut self,
        step: Step,
        code: &'static str,
        posture: Posture,
        message: impl Into<String>,
    ) {
        self.add(step, code, Some(posture), None, message.into());
    }

    /// Adds a problem of one vertebra on one film.
    pub fn vertebra(
        &mut self,
        step: Step,
        code: &'static str,
        posture: Posture,
        level: Level,
        message: impl Into<String>,
    ) {
        self.add(step, code, Some(posture), Some(level), message.into());
    }

    fn add(
        &mut self,
        step: Step,
        code: &'static str,
        posture: Option<Posture>,
        level: Option<Level>,
        message: String,
    ) {
        let warning = Warning { code, step, posture, level, message };
        if !self.0.contains(&warning) {
            self.0.push(warning);
        }
    }

    /// All problems in the order in which they arose.
    #[must_use]
    pub fn all(&self) -> &[Warning] {
        &self.0
    }

    /// Whether a problem of this code was met.
    #[must_use]
    pub fn has(&self, code: &str) -> bool {
        self.0.iter().any(|warning| warning.code == code)
    }
}
