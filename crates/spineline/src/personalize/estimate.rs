//! Loads estimated from the measured rotations by alternating least squares: starts of fits, and the estimated line on films that were not fitted.

use nalgebra::{Matrix3, Vector3};

use super::MULTIPLIER_BOUNDS;
use super::evidence::FilmEvidence;
use crate::action::{Application, LineOfAction};
use crate::multibody::{JointGroups, Load};
use crate::spatial::Frontal;

/// A film's joints under its load.
#[derive(Debug, Clone)]
pub struct JointResponses<'a> {
    /// What was measured.
    pub evidence: &'a FilmEvidence,
    /// Nominal rotation of every joint per unit of each component of the load, in rad; zero for components that the load lacks.
    pub by_component: Vec<[f64; 3]>,
}

/// The loads of several films and the multipliers that they share.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimatedLoads {
    /// Components of every film's load, up to the level of stiffness.
    pub loads: Vec<Vector3<f64>>,
    /// `ln α` of the lateral springs per group.
    pub log_multipliers: Vec<f64>,
}

/// A line with the force along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedLine {
    /// The line; its point is the one nearest to the middle of the joints, its direction is cranial.
    pub line: LineOfAction,
    /// Signed force along it.
    pub force_n: f64,
}

/// Estimates one load per film and the multipliers that all films share, by alternating linear least squares.
///
/// The rotation of joint `j` is `(a_j · w) / α`: linear in the load `w` for given multipliers, and linear in `1/α` for given loads.
/// The mean of `ln α` is held at zero.
#[must_use]
pub fn estimate_loads<'f, 'e: 'f>(
    films: impl Iterator<Item = &'f JointResponses<'e>> + Clone,
    groups: &JointGroups,
) -> EstimatedLoads {
    const ROUNDS: u32 = 200;
    let mut log_multipliers = vec![0.0; groups.len()];
    let mut loads = Vec::new();
    for _ in 0..ROUNDS {
        loads = films.clone().map(|film| film.load(groups, &log_multipliers)).collect();
        let mut sums = vec![(0.0, 0.0); groups.len()];
        for (film, load) in films.clone().zip(&loads) {
            for (sum, of_film) in sums.iter_mut().zip(film.turns(load, groups)) {
                sum.0 += of_film.0;
                sum.1 += of_film.1;
            }
        }
        let mut next: Vec<f64> = sums
            .iter()
            .map(|(product, square)| {
                let softness = (product / square)
                    .clamp(1.0 / MULTIPLIER_BOUNDS[1], 1.0 / MULTIPLIER_BOUNDS[0]);
                if softness.is_finite() { -softness.ln() } else { 0.0 }
            })
            .collect();
        let mean = next.iter().sum::<f64>() / next.len() as f64;
        let mut change = 0.0_f64;
        for (new, old) in next.iter_mut().zip(&log_multipliers) {
            *new -= mean;
            change = change.max((*new - old).abs());
        }
        log_multipliers = next;
        if change < 1e-9 {
            break;
        }
    }
    EstimatedLoads { loads, log_multipliers }
}

impl<'a> JointResponses<'a> {
    /// To a load on T2.
    #[must_use]
    pub fn to(load: &Load, evidence: &'a FilmEvidence) -> Self {
        Self { evidence, by_component: evidence.responses(load) }
    }

    /// The components that fit the measured rotations best for given multipliers: weighted linear least squares over the joints.
    #[must_use]
    pub fn load(&self, groups: &JointGroups, log_multipliers: &[f64]) -> Vector3<f64> {
        let mut normal = Matrix3::zeros();
        let mut right = Vector3::zeros();
        let joints = self.evidence.joints.iter().zip(&self.by_component).zip(groups.of_joint());
        for (j, ((joint, response), &group)) in joints.enumerate() {
            let row = Vector3::from(*response) * (-log_multipliers[group]).exp();
            let weighed = row * self.evidence.joint_weight(j);
            normal += weighed * row.transpose();
            right += weighed * joint.rotation_by_load().rad();
        }
        for component in 0..3 {
            if normal[(component, component)] == 0.0 {
                normal[(component, component)] = 1.0;
            }
        }
        // Newtons and newton millimetres differ by hundreds; scaled columns keep the solve well conditioned.
        let scale = Vector3::from_fn(|i, _| 1.0 / f64::sqrt(normal[(i, i)]).max(f64::MIN_POSITIVE));
        let scaled = Matrix3::from_fn(|i, j| normal[(i, j)] * scale[i] * scale[j]);
        let inverse = inverse_of_scaled(scaled);
        let inverse = Matrix3::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]);
        inverse * right
    }

    /// Per group of joints: `Σ a Δθ` and `Σ a²` over the variance of a rotation, for nominal rotations `a` under a load.
    #[must_use]
    pub fn turns(&self, load: &Vector3<f64>, groups: &JointGroups) -> Vec<(f64, f64)> {
        let mut sums = vec![(0.0, 0.0); groups.len()];
        let weight = self.evidence.rotation_sd().rad().powi(-2);
        let joints = self.evidence.joints.iter().zip(&self.by_component).zip(groups.of_joint());
        for (j, ((joint, response), &group)) in joints.enumerate() {
            let weight = weight * self.evidence.joint_weight(j);
            let nominal = Vector3::from(*response).dot(load);
            sums[group].0 += weight * nominal * joint.rotation_by_load().rad();
            sums[group].1 += weight * nominal * nominal;
        }
        sums
    }
}

/// Inverse of a symmetric matrix with a diagonal of ones; a pseudo-inverse if it is nearly singular.
fn inverse_of_scaled(scaled: Matrix3<f64>) -> Matrix3<f64> {
    /// Below this pivot, digits are lost; a pseudo-inverse keeps the rest.
    const SAFE_PIVOT: f64 = 1e-3;
    match scaled.cholesky() {
        Some(factor) if factor.l_dirty().diagonal().iter().all(|pivot| *pivot > SAFE_PIVOT) => {
            factor.inverse()
        }
        _ => scaled.pseudo_inverse(1e-12).unwrap_or_else(|_| Matrix3::zeros()),
    }
}

/// The line of a planar load `(fy, fz, mx)`; its point is the foot of the perpendicular from `near`.
#[must_use]
pub fn line_of(components: &[f64; 3], near: Frontal) -> Option<EstimatedLine> {
    let [fy, fz, mx] = *components;
    let force = Frontal::new(fy, fz);
    let size = force.norm_mm();
    // A moment about the middle that would need an arm of ten metres is a couple.
    let moment_near = mx - near.cross(force);
    if size.is_nan() || size <= 0.0 || moment_near.abs() > 1e4 * size {
        return None;
    }
    let sign = if fz < 0.0 { -1.0 } else { 1.0 };
    let direction = force * (sign / size);
    let across = Frontal::new(direction.z_mm, -direction.y_mm);
    let point = near + across * (moment_near / (sign * size));
    let line = LineOfAction { point, direction, application: Application::Fixed };
    Some(EstimatedLine { line, force_n: sign * size })
}

/// The components of a force along a line.
#[must_use]
pub fn components_of(line: &LineOfAction, force_n: f64) -> [f64; 3] {
    let force = line.direction * force_n;
    [force.y_mm, force.z_mm, line.point.cross(force)]
}
