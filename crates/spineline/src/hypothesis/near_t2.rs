//! The load on a film that was not fitted: the one that brings T2 nearest to where it was measured (decision 0008).

use nalgebra::{DMatrix, DVector};

use super::{Base, Hypothesis, Spine};
use crate::multibody::{
    FilmUnderLoad, ForceSign, GeneralStatics, LoadedFilm, MAX_FORCE_PER_STIFFNESS, OneComponent,
    SeveralComponents, Solution, Wanted, nearest_from_starts, nearest_on_path,
};
use crate::spatial::{Angle, Frontal};

/// A load that was found.
pub(super) struct NearT2 {
    pub components: Vec<f64>,
    pub base: Angle,
}

/// Finds it, by the search that forces along lines are found by too. `loaded` is left at its shape.
///
/// The size of a load is how far it turns the unloaded spine to first order, joint by joint in the root of the sum of squares, so that
/// forces and moments are compared alike. For one component it is proportional to the force. A free base counts
/// as one more joint; a noisy one stays at zero, its mean. `None` where no load brings T2 nearest before
/// hinges or forces reach their limits, or no equilibrium was found.
pub(super) fn nearest_t2(
    hypothesis: Hypothesis,
    loaded: &mut LoadedFilm,
    log_multipliers: &[f64],
    measured: Frontal,
    spine: &Spine<'_>,
) -> Option<NearT2> {
    let statics = spine.with_multipliers(log_multipliers);
    let count = hypothesis.load.components();
    if count == 1 && hypothesis.base != Base::Free {
        let largest = largest(loaded, log_multipliers, spine);
        let load = OneOnFilm { loaded, statics, largest };
        let found = nearest_on_path(load, &ForceSign::BOTH, measured);
        if !found.is_usable() {
            return None;
        }
        loaded.start_from(&found.solution);
        return Some(NearT2 { components: vec![found.force_n], base: Angle::ZERO });
    }
    loaded.reset();
    if !loaded.solve(&statics, &vec![0.0; count], Angle::ZERO, Wanted::AllRates) {
        return None;
    }
    let base = usize::from(hypothesis.base == Base::Free);
    let size = size_factor(loaded, spine.springs.model.joints.len(), count, base)?;
    let (groups, top) = (log_multipliers.len(), spine.springs.model.midpoints_mm.len() - 1);
    let mut load = SeveralOnFilm { loaded, statics, count, base, groups, top };
    let x: DVector<f64> = nearest_from_starts(&mut load, &size, count, measured)?;
    let (components, base) = load.split(x.as_slice());
    load.restart();
    Some(NearT2 { components: components.to_vec(), base })
}

/// The largest amount of one component: the limit of a force along a line, for the sum of all forces; moments as pairs of forces at
/// both ends of the spine.
pub(super) fn largest(loaded: &LoadedFilm, log_multipliers: &[f64], spine: &Spine<'_>) -> f64 {
    let midpoints = &spine.springs.model.midpoints_mm;
    let length_mm = (midpoints[midpoints.len() - 1] - midpoints[0]).norm();
    let unit_n: f64 = loaded.units.iter().flatten().map(|unit| unit.force_n(length_mm)).sum();
    let joints = spine.springs.groups.of_joint();
    let stiffness = spine.springs.library.rows().iter().zip(joints);
    let sum: f64 =
        stiffness.map(|(row, &group)| row.nmm_per_rad[0] * log_multipliers[group].exp()).sum();
    MAX_FORCE_PER_STIFFNESS * sum / joints.len() as f64 / unit_n
}

/// `size² = |factor · x|²`; `None` where the components do not differ.
pub(super) fn size_factor(
    loaded: &LoadedFilm,
    joints: usize,
    count: usize,
    base: usize,
) -> Option<DMatrix<f64>> {
    let mut squares = DMatrix::<f64>::identity(count + base, count + base);
    for a in 0..count {
        for b in 0..count {
            squares[(a, b)] =
                (0..joints).map(|j| loaded.joint_rate(a, j).dot(&loaded.joint_rate(b, j))).sum();
        }
    }
    Some(squares.cholesky()?.l().transpose())
}

/// One film under a load of one component.
struct OneOnFilm<'s, 'a> {
    loaded: &'s mut LoadedFilm,
    statics: GeneralStatics<'a>,
    largest: f64,
}

impl OneComponent for OneOnFilm<'_, '_> {
    fn solve(&mut self, amount: f64, solution: &mut Solution) {
        self.loaded.solve_one(&self.statics, amount, solution);
    }

    fn largest(&self) -> f64 {
        self.largest
    }
}

/// One film under a load of several components, of which the base's angle may be the last.
struct SeveralOnFilm<'s, 'a> {
    loaded: &'s mut LoadedFilm,
    statics: GeneralStatics<'a>,
    count: usize,
    base: usize,
    groups: usize,
    top: usize,
}

impl SeveralOnFilm<'_, '_> {
    fn split<'x>(&self, x: &'x [f64]) -> (&'x [f64], Angle) {
        let base = x.get(self.count).copied().unwrap_or(0.0);
        (&x[..self.count], Angle::from_rad(base))
    }
}

impl SeveralComponents for SeveralOnFilm<'_, '_> {
    fn restart(&mut self) {
        self.loaded.reset();
    }

    fn t2(&mut self, components: &[f64]) -> Option<(Frontal, Vec<Frontal>)> {
        let (components, base) = self.split(components);
        if !self.loaded.solve(&self.statics, components, base, Wanted::AllRates) {
            return None;
        }
        let rate = |i| self.loaded.location_rate(self.groups + i, self.top);
        let rates = (0..self.count + self.base).map(rate).collect();
        Some((self.loaded.location(self.top), rates))
    }
}
