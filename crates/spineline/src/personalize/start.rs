//! A start in closed form.

use nalgebra::{DMatrix, DVector};

use super::FitFilm;
use crate::multibody::JointGroups;

/// Where a fit may start from.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// `ln α` per group.
    pub log_multipliers: Vec<f64>,
    /// Components of every film's load.
    pub loads: Vec<Vec<f64>>,
}

/// Multipliers and forces from measured rotations and lever arms.
///
/// In film P and group g the least-squares slope of rotation over nominal response is `x = F_P / α_g`, so
/// `ln |F_P| - ln α_g = ln |x|` is linear: one small weighted least-squares solve. Where the sign of `x` disagrees with
/// the force, the group's rotations contradict the line there and say nothing about its stiffness.
///
/// `signs` are the signs of the forces; see [`majority_signs`].
pub(super) fn closed_form(films: &[FitFilm<'_>], groups: &JointGroups, signs: &[f64]) -> Start {
    let (g, p) = (groups.len(), films.len());
    let mut normal = DMatrix::<f64>::zeros(g + p, g + p);
    let mut right = DVector::<f64>::zeros(g + p);
    // A weak pull to the nominal stiffness keeps groups without evidence where they were; the mean is zero.
    const PULL: f64 = 1e-3;
    for a in 0..g {
        normal[(a, a)] += PULL;
        for b in 0..g {
            normal[(a, b)] += 1.0 / (g * g) as f64;
        }
    }
    for (film, (fitted, &sign)) in films.iter().zip(signs).enumerate() {
        let sums = fitted.evidence.moments_by_group(&fitted.load, groups);
        let total: f64 = sums.iter().map(|s| s.1).sum();
        let overall = (sums.iter().map(|s| s.0).sum::<f64>() / total).abs();
        normal[(g + film, g + film)] += PULL;
        right[g + film] += PULL * overall.max(f64::MIN_POSITIVE).ln();
        for (group, (product, square)) in sums.into_iter().enumerate() {
            let slope = sign * product / square;
            if !(slope > 0.0 && slope.is_finite()) {
                continue;
            }
            // The variance of ln x is the variance of x over x², which falls with Σ a².
            let weight = product * product / square / fitted.evidence.rotation_sd().rad().powi(2);
            let value = slope.ln();
            normal[(g + film, g + film)] += weight;
            normal[(group, group)] += weight;
            normal[(g + film, group)] -= weight;
            normal[(group, g + film)] -= weight;
            right[g + film] += weight * value;
            right[group] -= weight * value;
        }
    }
    let solution = normal.lu().solve(&right).unwrap_or_else(|| DVector::zeros(g + p));
    let limit = super::MULTIPLIER_BOUNDS[1].ln();
    Start {
        log_multipliers: (0..g).map(|i| solution[i].clamp(-limit, limit)).collect(),
        loads: (0..p).map(|i| vec![signs[i] * solution[g + i].exp()]).collect(),
    }
}

/// The sign of every film's force that agrees with most of the measured work.
pub(super) fn majority_signs(films: &[FitFilm<'_>], groups: &JointGroups) -> Vec<f64> {
    films
        .iter()
        .map(|film| {
            let product: f64 =
                film.evidence.moments_by_group(&film.load, groups).iter().map(|s| s.0).sum();
            if product < 0.0 { -1.0 } else { 1.0 }
        })
        .collect()
}
