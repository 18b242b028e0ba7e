//! Starts of a fit in closed form: rotation and moment of every joint are both measured on the film.

use nalgebra::{DMatrix, DVector, Vector3};

use super::estimate::{EstimatedLoads, JointResponses, estimate_loads};
use super::film::FilmData;
use super::problem::Problem;
use super::start::Start;
use super::{Gauge, MULTIPLIER_BOUNDS};
use crate::multibody::{FilmUnderLoad, ForceSign, JointGroups};

impl<F: FilmUnderLoad> Problem<'_, F> {
    /// Whether a start has the unknowns of this problem.
    pub(super) fn takes(&self, start: &Start) -> bool {
        start.log_multipliers.len() == self.springs.groups.len()
            && start.loads.iter().map(Vec::len).eq(self.films.iter().map(|film| film.load.len()))
    }

    /// Starts, the likeliest first: for loads of one component on a base at rest in closed form, for the majority's signs of the loads
    /// and then for every other combination; for others from estimated loads; and the hints, which are first where a base may turn.
    pub(super) fn starts(&self, hints: &[Start]) -> Vec<Start> {
        if self.films.is_empty() {
            return Vec::new();
        }
        let one = self.films.iter().all(|film| film.load.len() == 1);
        let mut starts = match &self.held {
            Some(held) => self.flipped(held),
            None if one => self.signed_starts(),
            None => self.estimated_starts(),
        };
        let first = if self.has_turning_base() { 0 } else { starts.len() };
        starts.splice(first..first, hints.iter().cloned());
        starts
    }

    /// Starts that are tried where the first of [`Self::starts`] does not satisfy the films: for loads of one component, those from
    /// estimated loads. A frozen force is the force at the amplitude instead.
    pub(super) fn further_starts(&self) -> Vec<Start> {
        let one = self.films.iter().all(|film| film.load.len() == 1);
        let is_frozen = self.settings.gauge == Gauge::FrozenForce;
        if one && !is_frozen && self.held.is_none() { self.estimated_starts() } else { Vec::new() }
    }

    /// The starts of a force along a line with the first forces that reach the amplitudes.
    pub(super) fn starts_at_amplitude(&self) -> Vec<Start> {
        let signed = if self.held.is_none() { self.signed_starts() } else { Vec::new() };
        signed.iter().filter_map(|start| self.at_amplitude(start)).collect()
    }

    /// The same multipliers with the first forces of the same signs that reach the amplitudes; `None` for other loads.
    pub(super) fn at_amplitude(&self, start: &Start) -> Option<Start> {
        let springs = self.springs(&start.log_multipliers);
        let force = |(film, load): (&FilmData<'_, F>, &Vec<f64>)| {
            let sign = ForceSign::of(*load.first()?);
            Some(vec![film.loaded.force_at_amplitude(&springs, sign, film.lateral_tilt)?])
        };
        let loads = self.films.iter().zip(&start.loads).map(force).collect::<Option<_>>()?;
        Some(Start { log_multipliers: start.log_multipliers.clone(), loads })
    }

    /// From the loads and multipliers that fit the rotations best, and from nominal multipliers.
    fn estimated_starts(&self) -> Vec<Start> {
        let groups = self.springs.groups;
        let measured = self.films.iter().map(|film| &film.measured);
        let EstimatedLoads { loads, log_multipliers } = estimate_loads(measured, groups);
        let mut starts = vec![self.start(&log_multipliers, &loads)];
        starts.extend(self.flipped(&vec![0.0; groups.len()]));
        starts
    }

    /// The loads that fit the rotations best with these multipliers; and the load of every film the other way round.
    fn flipped(&self, log_multipliers: &[f64]) -> Vec<Start> {
        let load = |film: &JointResponses<'_>| film.load(self.springs.groups, log_multipliers);
        let loads: Vec<Vector3<f64>> = self.films.iter().map(|film| load(&film.measured)).collect();
        let flipped = |signs: Vec<f64>| {
            let loads: Vec<_> = loads.iter().zip(signs).map(|(load, sign)| load * sign).collect();
            self.start(log_multipliers, &loads)
        };
        all_signs(&vec![1.0; loads.len()]).map(flipped).collect()
    }

    fn start(&self, log_multipliers: &[f64], loads: &[Vector3<f64>]) -> Start {
        let films = self.films.iter().zip(loads);
        let components = |load: &Vector3<f64>, count: usize| load.as_slice()[..count].to_vec();
        Start {
            log_multipliers: log_multipliers.to_vec(),
            loads: films.map(|(film, load)| components(load, film.loaded.components())).collect(),
        }
    }

    fn signed_starts(&self) -> Vec<Start> {
        if self.films.is_empty() {
            return Vec::new();
        }
        let groups = self.springs.groups;
        let films: Vec<&JointResponses<'_>> =
            self.films.iter().map(|film| &film.measured).collect();
        let majority: Vec<f64> = films.iter().map(|film| majority_sign(film, groups)).collect();
        let start = |signs: Vec<f64>| {
            let mut start = closed_form(&films, groups, &signs);
            let nominal = Start { log_multipliers: vec![0.0; groups.len()], ..start.clone() };
            if self.settings.gauge == Gauge::FrozenForce
                && let Some(frozen) = self.at_amplitude(&nominal)
            {
                start.loads = frozen.loads;
            }
            start
        };
        all_signs(&majority).map(start).collect()
    }
}

/// Given signs, and then every other combination.
fn all_signs(first: &[f64]) -> impl Iterator<Item = Vec<f64>> {
    (0..1_u32 << first.len()).map(|flips| {
        let sign = |film: usize| if flips >> film & 1 == 1 { -1.0 } else { 1.0 };
        first.iter().enumerate().map(|(film, first)| sign(film) * first).collect()
    })
}

/// Multipliers and forces from measured rotations and lever arms.
///
/// In film P and group g the least-squares slope of rotation over nominal response is `x = F_P / α_g`, so
/// `ln |F_P| - ln α_g = ln |x|` is linear: one small weighted least-squares solve. Where the sign of `x` disagrees with
/// the force, the group's rotations contradict the line there and say nothing about its stiffness.
///
/// `signs` are the signs of the forces; see [`majority_sign`].
fn closed_form(films: &[&JointResponses<'_>], groups: &JointGroups, signs: &[f64]) -> Start {
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
    for (film, (measured, &sign)) in films.iter().zip(signs).enumerate() {
        let sums = measured.turns(&Vector3::x(), groups);
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
            let weight = product * product / square;
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
    let limit = MULTIPLIER_BOUNDS[1].ln();
    Start {
        log_multipliers: (0..g).map(|i| solution[i].clamp(-limit, limit)).collect(),
        loads: (0..p).map(|i| vec![signs[i] * solution[g + i].exp()]).collect(),
    }
}

/// The sign of a film's load that agrees with most of the measured work.
fn majority_sign(film: &JointResponses<'_>, groups: &JointGroups) -> f64 {
    let product: f64 = film.turns(&Vector3::x(), groups).iter().map(|s| s.0).sum();
    if product < 0.0 { -1.0 } else { 1.0 }
}
