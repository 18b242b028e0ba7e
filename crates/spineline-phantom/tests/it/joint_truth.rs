//! Multipliers that were put into the model itself are recovered from its shapes.
//!
//! The model is exact here, unlike on films of a phantom, so everything must be found to the minimiser's precision.

use spineline::anatomy::Levels;
use spineline::multibody::{JointGroups, Support};
use spineline::personalize::{FitSettings, FitStatus, FitTarget, StiffnessBound};

use crate::exact_model::{FORCES_N, Patient, patient};

/// Relative: at a residual of zero the minimiser converges quadratically, far below this.
const MULTIPLIER: f64 = 1e-6;

impl Patient {
    fn check(&self, groups: &JointGroups, logs: &[f64], support: Support, target: FitTarget) {
        let mean: f64 = logs.iter().sum::<f64>() / logs.len() as f64;
        let logs: Vec<f64> = logs.iter().map(|log| log - mean).collect();
        let films = self.films(groups, &logs, support);
        let settings = FitSettings { target, support, ..self.settings() };
        let fit = self.fitted(&films, &self.erect, groups, &settings, |_, _, fit| fit);
        let what = format!("{support:?}, {target:?}, {} groups", groups.len());
        assert_eq!(fit.status, FitStatus::Converged, "{what}");
        assert!(fit.bounds.iter().all(|&bound| bound == StiffnessBound::Inside), "{what}");
        for (g, (found, truth)) in fit.log_multipliers.iter().zip(&logs).enumerate() {
            let off = (found - truth).exp_m1().abs();
            assert!(
                off <= MULTIPLIER,
                "{what}: multiplier {g} is off by {off:e}, residual {:e}, singular values {:?}",
                fit.residual_rms,
                fit.singular_values
            );
        }
        for (found, truth) in fit.loads.iter().zip(FORCES_N) {
            let off = (found[0] / truth - 1.0).abs();
            assert!(off <= MULTIPLIER, "{what}: force {} instead of {truth}", found[0]);
        }
    }
}

const REGIONAL: [[f64; 3]; 2] = [[-0.1, 0.9, -0.4], [0.5, -0.7, 0.3]];

fn per_joint_logs() -> Vec<f64> {
    (0..14).map(|joint| 0.7 * f64::sin(1.3 * f64::from(joint))).collect()
}

fn check_regional(support: Support, target: FitTarget) {
    for subject in [0, 6, 10] {
        let patient = patient(subject);
        for logs in REGIONAL {
            patient.check(&JointGroups::regional(&patient.regions), &logs, support, target);
        }
    }
}

#[test]
fn regional_multipliers_are_recovered_from_whole_shapes_with_frontal_support() {
    // Oracle: the multipliers that made the shapes.
    check_regional(Support::Frontal, FitTarget::Shape);
}

#[test]
fn regional_multipliers_are_recovered_from_whole_shapes_of_a_free_spine() {
    // Oracle: the multipliers that made the shapes.
    check_regional(Support::Free, FitTarget::Shape);
}

#[test]
fn regional_multipliers_are_recovered_from_ferguson_angles_with_frontal_support() {
    // Oracle: the multipliers that made the shapes.
    check_regional(Support::Frontal, FitTarget::Ferguson);
}

#[test]
fn regional_multipliers_are_recovered_from_ferguson_angles_of_a_free_spine() {
    // Oracle: the multipliers that made the shapes.
    check_regional(Support::Free, FitTarget::Ferguson);
}

#[test]
fn multipliers_of_every_joint_are_recovered_from_whole_shapes() {
    // Oracle: the multipliers that made the shapes.
    for support in [Support::Frontal, Support::Free] {
        for subject in [0, 6, 10] {
            let groups = JointGroups::per_joint(Levels::COMPLETE);
            patient(subject).check(&groups, &per_joint_logs(), support, FitTarget::Shape);
        }
    }
}
