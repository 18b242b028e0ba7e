//! Hypotheses side by side over some patients.

use super::{Criteria, Hypothesis, HypothesisFit, Role};
use crate::least_squares::FitStatus;
use crate::number::mean;
use crate::spatial::Angle;

/// The numbers of a patient's fit for a comparison, without the shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HypothesisScores {
    /// Which.
    pub hypothesis: Hypothesis,
    criteria: Criteria,
    /// Mean location errors by role, in the order of [`Role::ALL`].
    location_mm: [Option<f64>; Role::ALL.len()],
    /// Means of the root mean squares of the rotations' errors, likewise.
    rotation_deg: [Option<f64>; Role::ALL.len()],
    against: Option<f64>,
    /// Whether it can be the best: the fit converged, within the human range of motion.
    is_sound: bool,
    /// Whether the criteria are at the minimum of the fit.
    has_criteria: bool,
    /// Whether it predicts every bend that is left out.
    predicts_left_out: bool,
    /// Films and roles without a prediction, and one more for a fit that did not converge.
    lost: usize,
}

impl HypothesisScores {
    /// Of a fit.
    #[must_use]
    pub fn of(fit: &HypothesisFit) -> Self {
        Self {
            hypothesis: fit.hypothesis,
            criteria: fit.criteria,
            location_mm: Role::ALL.map(|role| fit.mean_location_error_mm(role)),
            rotation_deg: Role::ALL.map(|role| fit.mean_rotation_rms(role).map(Angle::deg)),
            against: mean(fit.of_role(Role::Fitted).map(|film| film.against.joints as f64)),
            is_sound: fit.is_converged(),
            has_criteria: fit.status == FitStatus::Converged,
            predicts_left_out: fit.lost.iter().all(|lost| lost.role != Role::LeftOut),
            lost: fit.lost.len() + usize::from(!fit.is_converged()),
        }
    }

    /// Of all fits of a patient.
    #[must_use]
    pub fn all(fits: &[HypothesisFit]) -> Vec<Self> {
        fits.iter().map(Self::of).collect()
    }
}

/// One hypothesis over some patients: means of one value per patient, over those that have it.
#[derive(Debug, Clone, PartialEq)]
pub struct HypothesisSummary {
    /// Which.
    pub hypothesis: Hypothesis,
    /// Free numbers of a patient's fit, beside the size of its residuals; the most of any patient.
    pub free: usize,
    /// Location errors by role, in the order of [`Role::ALL`], in mm.
    pub location_mm: [Option<f64>; Role::ALL.len()],
    /// Root mean squares of the rotations' errors by role, in degrees.
    pub rotation_deg: [Option<f64>; Role::ALL.len()],
    /// Joints per fitted film that turn against the load.
    pub against: Option<f64>,
    /// AICc less the first hypothesis's, over the patients for whom both fits converged; not a number without one.
    pub aicc_difference: f64,
    /// BIC less the first hypothesis's, likewise.
    pub bic_difference: f64,
    /// Patients for whom no other hypothesis has a lower left-out error.
    pub best_left_out: usize,
    /// Patients for whom no other has a lower AICc.
    pub best_aicc: usize,
    /// Films and roles without a prediction, and fits that did not converge, over all patients.
    pub lost: usize,
}

/// Patients and hypotheses that may be compared: every one of these patients has every one of these hypotheses.
#[derive(Debug, Clone, PartialEq)]
pub struct HypothesisComparison {
    /// How many patients.
    pub patients: usize,
    /// In the order in which they were asked for.
    pub hypotheses: Vec<HypothesisSummary>,
}

/// Compares on equal terms: all hypotheses on the patients that have all of them, and, if some patients lack one, the hypotheses
/// that all patients have on all of them. One item per patient.
#[must_use]
pub fn compare(patients: &[&[HypothesisScores]]) -> Vec<HypothesisComparison> {
    let mut all: Vec<Hypothesis> = Vec::new();
    for fit in patients.iter().copied().flatten() {
        if !all.contains(&fit.hypothesis) {
            all.push(fit.hypothesis);
        }
    }
    all.sort();
    let has = |fits: &[HypothesisScores], which| fits.iter().any(|fit| fit.hypothesis == which);
    let whole: Vec<&[HypothesisScores]> =
        patients.iter().copied().filter(|fits| all.iter().all(|&h| has(fits, h))).collect();
    let shared: Vec<Hypothesis> =
        all.iter().copied().filter(|&h| patients.iter().all(|fits| has(fits, h))).collect();
    let mut blocks = Vec::new();
    if !whole.is_empty() {
        blocks.push(block(&whole, &all));
    }
    if whole.len() < patients.len() && !shared.is_empty() {
        blocks.push(block(patients, &shared));
    }
    blocks.retain(|block| !block.hypotheses.is_empty());
    blocks
}

fn block(patients: &[&[HypothesisScores]], hypotheses: &[Hypothesis]) -> HypothesisComparison {
    let of = |h: Hypothesis| -> Vec<&HypothesisScores> {
        patients.iter().filter_map(|fits| fits.iter().find(|fit| fit.hypothesis == h)).collect()
    };
    let all: Vec<Vec<&HypothesisScores>> = hypotheses.iter().map(|&h| of(h)).collect();
    let left_out_place = Role::ALL.iter().position(|role| *role == Role::LeftOut);
    let left_out = |fit: &HypothesisScores| {
        fit.location_mm[left_out_place?].filter(|_| fit.is_sound && fit.predicts_left_out)
    };
    let aicc = |fit: &HypothesisScores| fit.is_sound.then_some(fit.criteria.aicc);
    let summaries = hypotheses.iter().zip(&all).map(|(&hypothesis, fits)| {
        let difference = |value: fn(&Criteria) -> f64| {
            let both = fits.iter().zip(&all[0]).filter(|(a, b)| a.has_criteria && b.has_criteria);
            let differences = both.map(|(a, b)| value(&a.criteria) - value(&b.criteria));
            mean(differences).unwrap_or(f64::NAN)
        };
        HypothesisSummary {
            hypothesis,
            free: fits.iter().map(|fit| fit.criteria.fitted - 1).max().unwrap_or(0),
            location_mm: std::array::from_fn(|role| {
                mean(fits.iter().filter_map(|fit| fit.location_mm[role]))
            }),
            rotation_deg: std::array::from_fn(|role| {
                mean(fits.iter().filter_map(|fit| fit.rotation_deg[role]))
            }),
            against: mean(fits.iter().filter_map(|fit| fit.against)),
            aicc_difference: difference(|c| c.aicc),
            bic_difference: difference(|c| c.bic),
            best_left_out: best(fits, &all, left_out),
            best_aicc: best(fits, &all, aicc),
            lost: fits.iter().map(|fit| fit.lost).sum(),
        }
    });
    HypothesisComparison { patients: patients.len(), hypotheses: summaries.collect() }
}

/// In how many patients no other hypothesis has a lower value.
fn best(
    own: &[&HypothesisScores],
    all: &[Vec<&HypothesisScores>],
    value: impl Fn(&HypothesisScores) -> Option<f64>,
) -> usize {
    let least = |patient: usize| {
        all.iter().filter_map(|fits| value(fits[patient])).fold(f64::INFINITY, f64::min)
    };
    (0..own.len()).filter(|&p| value(own[p]).is_some_and(|value| value <= least(p))).count()
}
