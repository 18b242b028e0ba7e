//! Whether the bends of a patient are compatible with a single force along a line.

use super::{Analysis, LineModel};
use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::evaluate::paired::holm;
use crate::personalize::estimate::LineComparison;

/// More of the joints' work than this against the force speaks against a line.
const WEIGHT_AGAINST: f64 = 0.10;
/// Findings of a patient are beyond chance below this probability, corrected for how many were looked for.
const LEVEL: f64 = 0.05;
/// How often noise alone carries a joint two standard deviations against the force, when it does not turn at all.
const BEYOND_BY_CHANCE: f64 = 0.022_750_131_948_179_21;

/// What one bend says of a single force along a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BendEvidence {
    /// The bend.
    pub posture: Posture,
    /// Joints that can turn.
    pub joints: usize,
    /// Joints that turn against the force.
    pub against: usize,
    /// Those of them that do so beyond two standard deviations.
    pub beyond_noise: usize,
    /// Part of the joints' work `Σ |rotation × lever arm|` that is against the force.
    pub weight: f64,
    /// Probability of so many beyond noise if no joint truly turned against the force: at most a binomial tail. Joints that
    /// share a vertebra err in opposite directions, which makes it smaller still. Corrected over the patient's tests.
    pub joints_p: f64,
    /// The test of "the load runs through the inflections"; for the inflection line only.
    pub line_test: Option<LineComparison>,
    /// Its probability, corrected over the patient's tests.
    pub line_p: Option<f64>,
}

impl BendEvidence {
    /// Whether the joints speak against the line: more of them than chance gives, with more than a tenth of the work.
    #[must_use]
    pub fn joints_reject(&self) -> bool {
        self.joints_p < LEVEL && self.weight > WEIGHT_AGAINST
    }

    /// Whether the load that the rotations prefer runs elsewhere: beyond chance, and by a distance or angle that matters.
    #[must_use]
    pub fn line_rejects(&self) -> bool {
        self.line_test.is_some_and(|test| test.rejects()) && self.line_p.is_some_and(|p| p < LEVEL)
    }

    /// Whether either speaks against the line.
    #[must_use]
    pub fn rejects(&self) -> bool {
        self.joints_reject() || self.line_rejects()
    }
}

/// What all bends of a patient say of a single force along a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Compatibility {
    /// Bends on which the force was found.
    pub bends: Vec<BendEvidence>,
    /// Bends on which no force was found, so that nothing is said of them.
    pub without_force: Vec<Posture>,
    /// Tests over which Holm's correction was taken.
    pub tests: usize,
}

impl Compatibility {
    /// Whether some bend speaks against the line.
    #[must_use]
    pub fn rejects(&self) -> bool {
        self.bends.iter().any(BendEvidence::rejects)
    }
}

impl Analysis {
    /// Whether the bends are compatible with a single force along a model's line.
    ///
    /// # Definition
    /// Per bend two questions: do more joints turn against the force than noise would make, and does the load that the
    /// rotations prefer run elsewhere (inflection line only). Holm's correction is over all of them, so that a patient whose
    /// bends are compatible is called otherwise with a probability of at most 0.05. The place of the line and
    /// the lever arms are taken as known, and so is the noise of the tilts.
    #[must_use]
    pub fn compatibility(&self, model: &LineModel) -> Compatibility {
        let films = || model.postures.iter().filter(|s| s.fitted && s.posture.bend().is_some());
        let mut bends: Vec<BendEvidence> = films()
            .filter(|s| s.is_usable())
            .map(|s| {
                let beyond_noise = s.contradicted.iter().filter(|j| j.beyond_noise).count();
                let joints = s.location_errors_mm.len();
                let line_test = self
                    .posture(s.posture)
                    .filter(|_| model.kind == LineKind::Inflection)
                    .and_then(|posture| posture.line_comparison);
                BendEvidence {
                    posture: s.posture,
                    joints,
                    against: s.contradicted.len(),
                    beyond_noise,
                    weight: s.contradicted_weight(),
                    joints_p: binomial_tail(joints, beyond_noise, BEYOND_BY_CHANCE),
                    line_test,
                    line_p: line_test.map(|test| test.p_value),
                }
            })
            .collect();
        let mut all: Vec<&mut f64> = bends
            .iter_mut()
            .flat_map(|bend| [Some(&mut bend.joints_p), bend.line_p.as_mut()])
            .flatten()
            .collect();
        let adjusted = holm(&all.iter().map(|p| **p).collect::<Vec<f64>>());
        for (p, adjusted) in all.iter_mut().zip(&adjusted) {
            **p = *adjusted;
        }
        let without_force = films().filter(|s| !s.is_usable()).map(|s| s.posture).collect();
        Compatibility { bends, without_force, tests: adjusted.len() }
    }
}

/// Probability of `count` or more of `n` independent events of probability `p` each.
fn binomial_tail(n: usize, count: usize, p: f64) -> f64 {
    let mut term = (1.0 - p).powi(n as i32);
    let mut below = 0.0;
    for k in 0..count {
        below += term;
        term *= (n - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
    }
    // What is left of one loses digits, but not where it is compared with a level.
    (1.0 - below).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tail_is_the_textbook_sum() {
        assert_eq!(binomial_tail(14, 0, 0.3), 1.0);
        // 1 - q^14 - 14 p q^13.
        let (p, q) = (BEYOND_BY_CHANCE, 1.0 - BEYOND_BY_CHANCE);
        let two = 1.0 - q.powi(14) - 14.0 * p * q.powi(13);
        assert!((binomial_tail(14, 2, p) - two).abs() < 1e-14);
        assert!((binomial_tail(3, 3, 0.5) - 0.125).abs() < 1e-15);
    }

    #[test]
    fn joints_against_need_weight_and_number() {
        let bend = BendEvidence {
            posture: Posture::LeftBending,
            joints: 14,
            against: 5,
            beyond_noise: 3,
            weight: 0.3,
            joints_p: 0.01,
            line_test: None,
            line_p: None,
        };
        assert!(bend.joints_reject() && bend.rejects());
        assert!(!BendEvidence { weight: 0.05, ..bend }.rejects());
        assert!(!BendEvidence { joints_p: 0.2, ..bend }.rejects());
    }
}
