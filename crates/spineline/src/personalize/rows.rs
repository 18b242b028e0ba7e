//! One film of a fit: its data, its residuals and their derivatives.

use super::shape_weights::{ROWS_PER_VERTEBRA, ShapeRows, ShapeWeights};
use crate::clinical::RegionBounds;
use crate::least_squares::System;
use crate::multibody::{Load, Parameter, Solution, Statics};
use crate::spatial::{Angle, Frontal};

/// What an evaluation fills.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    Residuals,
    /// Residuals and their derivatives.
    Derivatives,
}

/// One film's data.
pub(super) struct FilmData {
    pub load: Load,
    /// Place of its load's components among the unknowns; `None` where the amplitude determines the force.
    pub first: Option<usize>,
    /// The load's components at the last evaluation.
    pub magnitude: Vec<f64>,
    pub locations: Vec<Frontal>,
    pub tilts: Vec<Angle>,
    pub ferguson: [Angle; 3],
    pub lateral_tilt: Angle,
    /// Of the film's noise.
    pub weights: ShapeWeights,
    /// The vertebrae that have rows.
    pub rows: ShapeRows,
    pub parameters: Vec<Parameter>,
    pub solution: Solution,
}

impl FilmData {
    /// Equilibrium with derivatives at the film's amplitude: Newton on the force from its last value.
    pub fn solve_at_amplitude(&mut self, statics: &Statics<'_>, wanted: Wanted) -> bool {
        const MAX_STEP_RAD: f64 = 0.15;
        for _ in 0..15 {
            statics.solve(&self.load, &self.magnitude, &[Parameter::Load(0)], &mut self.solution);
            let miss = (self.solution.deformed.lateral_tilt() - self.lateral_tilt).wrapped().rad();
            let step = miss / self.solution.lateral_tilt_rate(0);
            if !(self.solution.converged && step.is_finite()) {
                return false;
            }
            let longest = MAX_STEP_RAD / self.solution.fastest_turn(0);
            self.magnitude[0] -= step.clamp(-longest, longest);
            // The error after such a step of Newton is its square.
            if miss.abs() < 1e-7 {
                return self.solve_at_magnitude(statics, wanted);
            }
        }
        false
    }

    /// Equilibrium under the load's last value.
    pub fn solve_at_magnitude(&mut self, statics: &Statics<'_>, wanted: Wanted) -> bool {
        let parameters = match wanted {
            Wanted::Residuals => &[],
            Wanted::Derivatives => self.parameters.as_slice(),
        };
        statics.solve(&self.load, &self.magnitude, parameters, &mut self.solution);
        self.solution.converged
    }
}

/// A Ferguson angle counts in degrees.
const FERGUSON_UNIT: Angle = Angle::from_deg(1.0);

/// Three Ferguson angles in degrees, and the amplitude where it does not determine the force.
pub(super) fn ferguson_rows(
    film: &FilmData,
    regions: &[RegionBounds; 3],
    groups: usize,
    row: usize,
    system: &mut System,
    wanted: Wanted,
) {
    let unit = FERGUSON_UNIT.rad();
    let solution = &film.solution;
    let place = |i: usize| solution.deformed.location(i);
    for (k, bounds) in regions.iter().enumerate() {
        let angle = bounds.ferguson_angle(place);
        system.residuals[row + k] = (angle - film.ferguson[k]).wrapped().rad() / unit;
        if wanted == Wanted::Derivatives {
            ferguson_rates(film, bounds, groups, row + k, system);
        }
    }
    if let Some(first) = film.first {
        let row = row + regions.len();
        system.residuals[row] =
            (solution.deformed.lateral_tilt() - film.lateral_tilt).wrapped().rad() / unit;
        if wanted == Wanted::Derivatives {
            for p in 0..=groups {
                let column = if p == groups { first } else { p };
                system.jacobian[(row, column)] = solution.lateral_tilt_rate(p) / unit;
            }
        }
    }
}

/// Derivatives of one Ferguson angle.
fn ferguson_rates(
    film: &FilmData,
    bounds: &RegionBounds,
    groups: usize,
    row: usize,
    system: &mut System,
) {
    let unit = FERGUSON_UNIT.rad();
    let solution = &film.solution;
    let force = groups;
    let place = |i: usize| solution.deformed.location(i);
    let [lower, upper] = bounds.ferguson_lines(place);
    let rate = |p: usize| {
        let [lower_rate, upper_rate] = bounds.ferguson_lines(|i| solution.location_rate(p, i));
        let turn = |v: Frontal, dv: Frontal| v.cross(dv) / v.dot(v);
        turn(upper, upper_rate) - turn(lower, lower_rate)
    };
    let by_force = rate(force);
    for p in 0..groups {
        // The force follows the amplitude where that holds it.
        let follow = match film.first {
            None => -solution.lateral_tilt_rate(p) / solution.lateral_tilt_rate(force),
            Some(_) => 0.0,
        };
        system.jacobian[(row, p)] = (rate(p) + by_force * follow) / unit;
    }
    if let Some(first) = film.first {
        system.jacobian[(row, first)] = by_force / unit;
    }
}

/// Locations and tilts of every mobile vertebra that the film shows, in standard deviations, and independent where vertebrae share
/// errors.
pub(super) fn shape_rows(
    film: &FilmData,
    groups: usize,
    row: usize,
    system: &mut System,
    wanted: Wanted,
) {
    let solution = &film.solution;
    let first = film.first.expect("the loads of a whole shape are unknown");
    let rows = film.rows.count();
    let residuals = &mut system.residuals.as_mut_slice()[row..row + rows];
    for (&(i, weights), residuals) in
        film.rows.vertebrae.iter().zip(residuals.chunks_exact_mut(ROWS_PER_VERTEBRA))
    {
        let off = solution.deformed.location(i) - film.locations[i];
        let turn = solution.deformed.tilt(i) - film.tilts[i];
        residuals.copy_from_slice(&weights.residuals(off, turn));
    }
    film.rows.whiten(&mut system.residuals.as_mut_slice()[row..row + rows]);
    if wanted == Wanted::Residuals {
        return;
    }
    for p in 0..film.parameters.len() {
        let column = if p < groups { p } else { first + p - groups };
        let start = column * system.jacobian.nrows() + row;
        let column = &mut system.jacobian.as_mut_slice()[start..start + rows];
        for (&(i, weights), rates) in
            film.rows.vertebrae.iter().zip(column.chunks_exact_mut(ROWS_PER_VERTEBRA))
        {
            let location = solution.location_rate(p, i);
            let tilt = solution.tilt_rate(p, i);
            rates.copy_from_slice(&weights.derivatives(location, tilt));
        }
        film.rows.whiten(column);
    }
}
