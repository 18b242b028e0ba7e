//! Starts of a fit in closed form: rotation and moment of every joint are both measured on the film.

use nalgebra::{DMatrix, DVector};

use super::loads::UnitLoad;
use super::{HypothesisFilm, Spine};
use crate::personalize::MULTIPLIER_BOUNDS;
use crate::personalize::evidence::FilmEvidence;

/// Data of one film on every joint under a load.
pub(super) struct JointResponses {
    /// Measured rotation, in rad.
    pub rotations: Vec<f64>,
    /// Nominal rotation per unit of each component, in rad.
    pub by_component: Vec<Vec<f64>>,
    /// Nominal rotation per moment.
    pub compliances: Vec<f64>,
    /// Deviation of every measured rotation.
    pub rotation_sds: Vec<f64>,
    /// Of one between marked vertebrae.
    rotation_sd: f64,
}

impl JointResponses {
    pub fn measure(film: &HypothesisFilm<'_>, units: &[Vec<UnitLoad>], spine: &Spine<'_>) -> Self {
        let evidence = FilmEvidence::measure(spine.model, spine.library, spine.erect, film.outline);
        let (midpoints, _) = spine.model.posed_on_film(film.outline, spine.erect);
        let joints = || evidence.joints.iter();
        Self {
            rotations: joints().map(|joint| joint.rotation.rad()).collect(),
            by_component: joints()
                .enumerate()
                .map(|(j, joint)| {
                    let of = |unit: &UnitLoad| {
                        unit.moment_about(j, &joint.centre_mm, &midpoints).dot(&joint.hinge)
                    };
                    let turn = |units: &Vec<UnitLoad>| units.iter().map(of).sum::<f64>();
                    units.iter().map(|u| joint.compliance_rad_per_nmm * turn(u)).collect()
                })
                .collect(),
            compliances: joints().map(|joint| joint.compliance_rad_per_nmm).collect(),
            rotation_sds: (0..evidence.joints.len())
                .map(|joint| evidence.joint_rotation_sd(joint).rad())
                .collect(),
            rotation_sd: evidence.rotation_sd().rad(),
        }
    }

    /// Nominal rotation of a joint under given components.
    pub fn turn(&self, joint: usize, components: &[f64]) -> f64 {
        self.by_component[joint].iter().zip(components).map(|(a, c)| a * c).sum()
    }

    /// Square root of a joint's weight: 1, or less next to an interpolated vertebra.
    fn relative(&self, joint: usize) -> f64 {
        self.rotation_sd / self.rotation_sds[joint]
    }

    /// Components by least squares on the rotations, for given multipliers.
    pub fn components(&self, groups: &[usize], log_multipliers: &[f64]) -> Vec<f64> {
        let k = self.by_component[0].len();
        let rows = DMatrix::from_fn(self.rotations.len(), k, |j, a| {
            self.by_component[j][a] * (-log_multipliers[groups[j]]).exp() * self.relative(j)
        });
        // Newtons and newton millimetres differ by hundreds.
        let scale: Vec<f64> =
            rows.column_iter().map(|c| 1.0 / c.norm().max(f64::MIN_POSITIVE)).collect();
        let scaled = DMatrix::from_fn(rows.nrows(), k, |j, a| rows[(j, a)] * scale[a]);
        let right =
            DVector::from_fn(self.rotations.len(), |j, _| self.rotations[j] * self.relative(j));
        let found = scaled.svd(true, true).solve(&right, 1e-9);
        let found = found.unwrap_or_else(|_| DVector::zeros(k));
        found.iter().zip(&scale).map(|(value, scale)| value * scale).collect()
    }
}

/// Multipliers and components by alternating least squares, as [`crate::personalize::estimate::estimate_loads`] does.
pub(super) fn alternate(films: &[JointResponses], spine: &Spine<'_>) -> (Vec<f64>, Vec<Vec<f64>>) {
    const ROUNDS: u32 = 50;
    let (groups, g) = (spine.groups.of_joint(), spine.groups.len());
    let mut logs = vec![0.0; g];
    for _ in 0..ROUNDS {
        let mut sums = vec![(0.0, 0.0); g];
        for film in films {
            let components = film.components(groups, &logs);
            for (j, rotation) in film.rotations.iter().enumerate() {
                let weight = film.rotation_sds[j].powi(-2);
                let turn = film.turn(j, &components);
                sums[groups[j]].0 += weight * turn * rotation;
                sums[groups[j]].1 += weight * turn * turn;
            }
        }
        for (log, (product, square)) in logs.iter_mut().zip(sums) {
            let softness = product / square;
            let [low, high] = MULTIPLIER_BOUNDS;
            let known = softness.is_finite();
            *log = if known { -softness.clamp(1.0 / high, 1.0 / low).ln() } else { 0.0 };
        }
        let mean = logs.iter().sum::<f64>() / g as f64;
        logs.iter_mut().for_each(|log| *log -= mean);
    }
    let components = films.iter().map(|film| film.components(groups, &logs)).collect();
    (logs, components)
}
