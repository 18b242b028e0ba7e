//! Test whether the bends of a patient reject a single force along a line.

use super::{Analysis, FilmMovement, LineComparison, LineModel};
use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::evaluate::paired::holm;
use crate::personalize::evidence::ContradictedJoint;
use crate::personalize::{SIGNIFICANCE, TestOutcome};
use statrs::distribution::{ContinuousCDF, Normal};

/// A line is rejected only above this share of the joints' work against the force.
const WEIGHT_AGAINST: f64 = 0.10;
/// A joint nearer to the line than this may lie on its other side: an inflection's place along the curve has this error.
const SURE_ARM_MM: f64 = 5.0;

/// The evidence of one bend on a single force along a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BendEvidence {
    /// The bend.
    pub posture: Posture,
    /// Joints that can turn.
    pub joints: usize,
    /// Joints that turn against the force.
    pub against: usize,
    /// Joints that turn against it beyond two standard deviations.
    pub beyond_noise: usize,
    /// Part of the joints' work `Σ |rotation × lever arm|` that is against the force.
    pub weight: f64,
    /// Probability that noise alone turns any joint so far against the force: the smallest p value of a joint at least 5 mm from the
    /// line, times the number of joints. Corrected over the patient's tests; `None` where the joints
    /// were not tested: their noise is not known, or the place of the line is assumed.
    pub joints_p: Option<f64>,
    /// How far the line of best fit to the rotations lies from the line; `None` for the estimated line, which comes from the
    /// same rotations.
    pub line_test: Option<LineComparison>,
    /// Probability of the test of the line itself, corrected over the patient's tests: "it runs through the inflections" of the
    /// inflection line, "it is parallel to the iliac line" of that line, "it is this line" of a given one.
    pub line_p: Option<f64>,
}

impl BendEvidence {
    /// Whether the joints reject the line: significantly, and with more than a tenth of the work.
    #[must_use]
    pub fn joints_reject(&self) -> bool {
        self.joints_p.is_some_and(|p| p < SIGNIFICANCE) && self.weight > WEIGHT_AGAINST
    }

    /// Whether the line of best fit to the rotations differs significantly from the line.
    #[must_use]
    pub fn line_rejects(&self) -> bool {
        self.line_p.is_some_and(|p| p < SIGNIFICANCE)
    }

    /// Whether either test rejects the line, and else how the test of the line itself ended: joints alone can reject a line, but not
    /// keep it.
    #[must_use]
    pub fn outcome(&self) -> TestOutcome {
        if self.joints_reject() { TestOutcome::Rejected } else { TestOutcome::of(self.line_p) }
    }
}

/// The evidence of all bends of a patient on a single force along a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Compatibility {
    /// Bends on which the force was found.
    pub bends: Vec<BendEvidence>,
    /// Bends without a force, which are not tested.
    pub without_force: Vec<Posture>,
    /// Tests over which Holm's correction was taken.
    pub tests: usize,
}

impl Compatibility {
    /// Rejected by some bend; kept where a bend was tested and no bend rejects the line.
    #[must_use]
    pub fn outcome(&self) -> TestOutcome {
        self.bends.iter().map(BendEvidence::outcome).min().unwrap_or(TestOutcome::NotTested)
    }

    /// Whether some bend rejects the line.
    #[must_use]
    pub fn rejects(&self) -> bool {
        self.outcome() == TestOutcome::Rejected
    }
}

impl Analysis {
    /// Whether the bends reject a single force along a line of a model.
    ///
    /// # Definition
    /// Two questions per bend. Does any joint turn against the force by more than noise explains, given the number of joints? Is the
    /// line of best fit to the rotations another line: not through the inflections, not along the iliac line, or not along the
    /// given line? Holm's correction is over all questions: a true line is rejected with a probability of at most 0.05. The joints'
    /// test takes the place of the line, the lever arms and the noise of the tilts as known; the line's test does not
    /// ([`crate::personalize::BestFitLoads`]). Of a fit, the joints' test takes the sign of the force alone.
    #[must_use]
    pub fn compatibility(&self, model: &LineModel) -> Compatibility {
        let films =
            || model.simulations.iter().filter(|s| s.fitted && s.shape.posture.bend().is_some());
        let mut bends: Vec<BendEvidence> = films()
            .filter(|s| s.has_force())
            .map(|s| {
                let beyond_noise = s.contradicted.iter().filter(|j| j.beyond_noise).count();
                let joints = s.joints();
                let film = self.movement.film(s.shape.posture);
                let line_test = film.and_then(|film| film.line_comparison(model.kind));
                let has_place = |film: &&FilmMovement| {
                    model.kind != LineKind::Iliac || film.outline.iliac_normal.is_some()
                };
                let tested = film.filter(has_place).and_then(|film| film.evidence.as_ref());
                BendEvidence {
                    posture: s.shape.posture,
                    joints,
                    against: s.contradicted.len(),
                    beyond_noise,
                    weight: s.contradicted_weight(),
                    joints_p: tested.map(|_| against_by_chance(&s.contradicted, joints)),
                    line_test,
                    line_p: line_test.map(|found| found.test.p_value),
                }
            })
            .collect();
        let mut all: Vec<&mut f64> = bends
            .iter_mut()
            .flat_map(|bend| [bend.joints_p.as_mut(), bend.line_p.as_mut()])
            .flatten()
            .collect();
        let adjusted = holm(&all.iter().map(|p| **p).collect::<Vec<f64>>());
        for (p, adjusted) in all.iter_mut().zip(&adjusted) {
            **p = *adjusted;
        }
        let without_force = films().filter(|s| !s.has_force()).map(|s| s.shape.posture).collect();
        Compatibility { bends, without_force, tests: adjusted.len() }
    }
}

/// Bonferroni's bound on the probability that noise of a deviation turns any of `joints` so far against the force, if
/// no joint truly turns against it. It holds for any dependence: neighbours share a vertebra.
pub(super) fn against_by_chance(contradicted: &[ContradictedJoint], joints: usize) -> f64 {
    let sure = contradicted.iter().filter(|joint| joint.lever_arm_mm.abs() >= SURE_ARM_MM);
    let furthest =
        sure.map(|joint| joint.rotation.rad().abs() / joint.rotation_sd.rad()).fold(0.0, f64::max);
    (joints as f64 * Normal::standard().sf(furthest)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy::Level;
    use crate::spatial::Angle;

    #[test]
    fn the_joint_that_turns_furthest_counts_once_for_every_joint() {
        let joint = |deg: f64, arm_mm: f64| ContradictedJoint {
            inferior: Level::MODEL[0],
            superior: Level::MODEL[1],
            rotation: Angle::from_deg(deg),
            lever_arm_mm: arm_mm,
            weight: 0.5,
            beyond_noise: true,
            rotation_sd: Angle::from_deg(1.0),
        };
        let p = |joints: &[ContradictedJoint]| against_by_chance(joints, 14);
        // Three standard deviations: 0.00135 on one side.
        assert!((p(&[joint(-3.0, -20.0), joint(2.0, -30.0)]) - 14.0 * 0.001_349_898).abs() < 1e-8);
        // A joint close to the line has a small lever arm: it is not tested.
        assert_eq!(p(&[joint(8.0, -4.9)]), 1.0);
        assert_eq!(p(&[]), 1.0);
    }

    #[test]
    fn joints_against_need_weight_and_more_than_chance() {
        let bend = BendEvidence {
            posture: Posture::LeftBending,
            joints: 14,
            against: 5,
            beyond_noise: 3,
            weight: 0.3,
            joints_p: Some(0.01),
            line_test: None,
            line_p: None,
        };
        assert!(bend.joints_reject());
        assert!(!BendEvidence { weight: 0.05, ..bend }.joints_reject());
        assert!(!BendEvidence { joints_p: Some(0.2), ..bend }.joints_reject());
        assert!(!BendEvidence { joints_p: None, ..bend }.joints_reject());
    }

    #[test]
    fn a_line_is_rejected_kept_or_not_tested() {
        let bend = |joints_p, line_p| BendEvidence {
            posture: Posture::LeftBending,
            joints: 14,
            against: 5,
            beyond_noise: 3,
            weight: 0.3,
            joints_p,
            line_test: None,
            line_p,
        };
        let (rejected, kept) = (bend(Some(0.5), Some(0.01)), bend(Some(0.5), Some(0.5)));
        let untested = bend(Some(0.5), None);
        let outcome = |bends: &[BendEvidence]| {
            Compatibility { bends: bends.to_vec(), without_force: Vec::new(), tests: 4 }.outcome()
        };
        assert_eq!(outcome(&[kept, rejected, untested]), TestOutcome::Rejected);
        assert_eq!(outcome(&[untested, kept]), TestOutcome::Kept);
        // Joints that agree with the force do not keep a line: its place was not tested.
        assert_eq!(outcome(&[untested]), TestOutcome::NotTested);
        assert_eq!(outcome(&[]), TestOutcome::NotTested);
        assert_eq!(outcome(&[bend(Some(0.01), None)]), TestOutcome::Rejected);
    }
}
