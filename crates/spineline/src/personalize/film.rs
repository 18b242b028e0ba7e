//! One film of a fit: its data, its residuals and their derivatives.

use super::Base;
use super::estimate::JointResponses;
use super::shape_weights::{ROWS_PER_VERTEBRA, ShapeRows, ShapeWeights};
use crate::clinical::{RegionBounds, Regions};
use crate::least_squares::System;
use crate::measure::Outline;
use crate::multibody::{FilmUnderLoad, FittedSprings, Wanted};
use crate::spatial::{Angle, Frontal};

pub(crate) struct FilmData<'a, F> {
    /// The film under its load.
    pub loaded: F,
    pub measured: JointResponses<'a>,
    pub base: Base,
    /// Place of its load's components among the unknowns, if they are unknown; the base's angle follows them.
    pub first: usize,
    /// The load's components at the last evaluation, and the base's angle.
    pub load: Vec<f64>,
    outline: &'a Outline,
    ferguson: [Angle; 3],
    pub lateral_tilt: Angle,
    pub weights: ShapeWeights,
    /// The vertebrae that have rows.
    pub rows: ShapeRows,
}

impl<'a, F: FilmUnderLoad> FilmData<'a, F> {
    pub fn new(
        springs: FittedSprings<'_>,
        outline: &'a Outline,
        measured: JointResponses<'a>,
        regions: &Regions,
        loaded: F,
        base: Base,
    ) -> Self {
        let ferguson =
            |bounds: &RegionBounds| bounds.ferguson_angle(|i| outline.vertebrae[i].location);
        Self {
            first: 0,
            load: vec![0.0; loaded.components() + base.angles()],
            ferguson: regions.bounds.each_ref().map(ferguson),
            lateral_tilt: outline.top().lateral_tilt(),
            weights: ShapeWeights::of_difference(&outline.noise, &springs.erect.noise),
            rows: ShapeRows::new(outline, springs.erect, springs.model),
            loaded,
            measured,
            base,
            outline,
        }
    }

    /// Equilibrium with derivatives at the film's amplitude: Newton on the force from its last value.
    pub fn solve_at_amplitude(&mut self, springs: &F::Springs<'_>, wanted: Wanted) -> bool {
        const MAX_STEP_RAD: f64 = 0.15;
        for _ in 0..15 {
            let converged = self.loaded.solve(springs, &self.load, Angle::ZERO, Wanted::LoadRates);
            let solution = self.loaded.solution();
            let miss = (solution.deformed.lateral_tilt() - self.lateral_tilt).wrapped().rad();
            let step = miss / solution.lateral_tilt_rate(0);
            if !(converged && step.is_finite()) {
                return false;
            }
            let longest = MAX_STEP_RAD / solution.fastest_turn(0);
            self.load[0] -= step.clamp(-longest, longest);
            // The error after such a step of Newton is its square.
            if miss.abs() < 1e-7 {
                return self.solve_at_load(springs, wanted);
            }
        }
        false
    }

    /// Equilibrium under the load's last value.
    pub fn solve_at_load(&mut self, springs: &F::Springs<'_>, wanted: Wanted) -> bool {
        let (components, base) = self.loaded.split(&self.load);
        self.loaded.solve(springs, components, base, wanted)
    }

    /// Rows of its shape, and of the base's angle where that has a deviation.
    pub fn shape_rows(&self) -> usize {
        self.rows.count() + usize::from(self.base == Base::Noisy)
    }

    /// Three Ferguson angles in degrees, and the amplitude where it does not determine the force.
    pub(super) fn fill_ferguson(
        &self,
        regions: &[RegionBounds; 3],
        at: Place,
        system: &mut System,
        wanted: Wanted,
    ) {
        let unit = FERGUSON_UNIT.rad();
        let solution = self.loaded.solution();
        let place = |i: usize| solution.deformed.location(i);
        for (k, bounds) in regions.iter().enumerate() {
            let angle = bounds.ferguson_angle(place);
            system.residuals[at.row + k] = (angle - self.ferguson[k]).wrapped().rad() / unit;
            if wanted == Wanted::AllRates {
                self.fill_ferguson_rates(bounds, Place { row: at.row + k, ..at }, system);
            }
        }
        if at.holds_amplitude {
            return;
        }
        let row = at.row + regions.len();
        system.residuals[row] =
            (solution.deformed.lateral_tilt() - self.lateral_tilt).wrapped().rad() / unit;
        if wanted == Wanted::AllRates {
            for p in 0..=at.groups {
                let column = if p == at.groups { self.first } else { p };
                system.jacobian[(row, column)] = solution.lateral_tilt_rate(p) / unit;
            }
        }
    }

    /// Derivatives of one Ferguson angle.
    fn fill_ferguson_rates(&self, bounds: &RegionBounds, at: Place, system: &mut System) {
        let Place { row, groups: force, holds_amplitude } = at;
        let unit = FERGUSON_UNIT.rad();
        let solution = self.loaded.solution();
        let place = |i: usize| solution.deformed.location(i);
        let [lower, upper] = bounds.ferguson_lines(place);
        let rate = |p: usize| {
            let [lower_rate, upper_rate] = bounds.ferguson_lines(|i| solution.location_rate(p, i));
            let turn = |v: Frontal, dv: Frontal| v.cross(dv) / v.dot(v);
            turn(upper, upper_rate) - turn(lower, lower_rate)
        };
        let by_force = rate(force);
        for p in 0..force {
            // The force follows the amplitude where that holds it.
            let follow = if holds_amplitude {
                -solution.lateral_tilt_rate(p) / solution.lateral_tilt_rate(force)
            } else {
                0.0
            };
            system.jacobian[(row, p)] = (rate(p) + by_force * follow) / unit;
        }
        if !holds_amplitude {
            system.jacobian[(row, self.first)] = by_force / unit;
        }
    }

    /// Locations and tilts of every mobile vertebra that the film shows, in standard deviations, and independent where vertebrae share
    /// errors; then the base's angle over its deviation where that is known.
    pub(super) fn fill_shape(&self, at: Place, system: &mut System, wanted: Wanted) {
        let rows = at.row..at.row + self.rows.count();
        let residuals = &mut system.residuals.as_mut_slice()[rows.clone()];
        for (&(i, weights), residuals) in
            self.rows.vertebrae.iter().zip(residuals.chunks_exact_mut(ROWS_PER_VERTEBRA))
        {
            let measured = &self.outline.vertebrae[i];
            let off = self.loaded.location(i) - measured.location;
            let turn = self.loaded.tilt(i) - measured.tilt;
            residuals.copy_from_slice(&weights.residuals(off, turn));
        }
        self.rows.whiten(residuals);
        if self.base == Base::Noisy {
            let angle = self.first + self.load.len() - 1;
            let per_rad = 1.0 / self.weights.tilt_sd_rad;
            system.residuals[rows.end] = self.load[self.load.len() - 1] * per_rad;
            system.jacobian[(rows.end, angle)] = per_rad;
        }
        if wanted != Wanted::AllRates {
            return;
        }
        for p in 0..at.groups + self.load.len() {
            let column = if p < at.groups { p } else { self.first + p - at.groups };
            let start = column * system.jacobian.nrows();
            let column = &mut system.jacobian.as_mut_slice()[start + rows.start..start + rows.end];
            for (&(i, weights), rates) in
                self.rows.vertebrae.iter().zip(column.chunks_exact_mut(ROWS_PER_VERTEBRA))
            {
                let location = self.loaded.location_rate(p, i);
                let tilt = self.loaded.tilt_rate(p, i);
                rates.copy_from_slice(&weights.derivatives(location, tilt));
            }
            self.rows.whiten(column);
        }
    }
}

/// A Ferguson angle counts in units of 1°: an assumption, and not the noise of the films, which readings show by vertebra and not by angle.
///
/// The unit is common to all rows. It changes no fit without a prior, and intervals only where the fit leaves less than it.
const FERGUSON_UNIT: Angle = Angle::from_deg(1.0);

/// Where a film's rows stand in a system.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// The first row.
    pub row: usize,
    /// Groups of joints, whose `ln α` are the first unknowns.
    pub groups: usize,
    /// Whether the amplitude determines the force.
    pub holds_amplitude: bool,
}
