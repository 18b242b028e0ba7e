//! The load on a film that was not fitted: the one that brings T2 nearest to where it was measured (decision 0008).

use nalgebra::DVector;

use super::prediction::{FoundLoad, Predicted, Predictor};
use super::{Base, HypothesisFilm, Spine};
use crate::evaluate::{ScaledPrediction, at_scale_of_top};
use crate::multibody::{
    FilmUnderLoad, ForceSign, GeneralStatics, LoadedFilm, MAX_FORCE_PER_STIFFNESS, OneComponent,
    PathEnding, SeveralComponents, Solution, Wanted, nearest_from_starts, nearest_on_path,
    size_factor,
};
use crate::spatial::{Angle, Frontal};

impl Predictor<'_, '_> {
    /// The film under the load that brings T2 nearest, at the scale that T2 and its prior give.
    pub fn near_t2(self, film: &HypothesisFilm<'_>) -> Predicted {
        let mut reason = PathEnding::NotConverged;
        let found = at_scale_of_top(film.outline, |outline| {
            match self.nearest(&film.at_scale_of(outline, self.spine)) {
                Ok(found) => Some((*found.shape.locations.last()?, found)),
                Err(lost) => {
                    reason = lost;
                    None
                }
            }
        });
        let ScaledPrediction { scale, prediction, converged } = found.ok_or(reason)?;
        if !converged {
            return Err(PathEnding::NotConverged);
        }
        Ok(prediction.in_lengths_of(film, scale))
    }

    /// The film under the load that brings T2 nearest, at the scale of its outline.
    fn nearest(self, film: &HypothesisFilm<'_>) -> Predicted {
        let found = film.under(self.hypothesis.load, self.spine).and_then(|mut loaded| {
            let top = film.outline.vertebrae.last()?.location;
            let near = nearest_t2(self, &mut loaded, top)?;
            let springs = self.spine.with_multipliers(self.log_multipliers);
            // From where the search has left it, so that no other equilibrium is shown.
            let solved = loaded.solve(&springs, &near.components, near.base, Wanted::Shape);
            solved.then_some((loaded, near))
        });
        let (loaded, near) = found.ok_or(PathEnding::NotConverged)?;
        near.shape(&loaded, film, self.role, self.spine)
    }
}

/// Finds the load that brings T2 nearest, by the search for forces along lines. For one component `loaded` gets the shape under it; for several
/// the hinges are set to zero, from where the search starts.
///
/// The size of a load is how far it turns the unloaded spine to first order, joint by joint in the root of the sum of squares, so that
/// forces and moments are compared alike. For one component it is proportional to the force. A free base counts
/// as one more joint; a noisy one stays at zero, its mean. `None` where no load brings T2 nearest before
/// hinges or forces reach their limits, or no equilibrium was found.
fn nearest_t2(
    by: Predictor<'_, '_>,
    loaded: &mut LoadedFilm,
    measured: Frontal,
) -> Option<FoundLoad> {
    let Predictor { hypothesis, spine, log_multipliers, .. } = by;
    let statics = spine.with_multipliers(log_multipliers);
    let count = hypothesis.load.components();
    if count == 1 && hypothesis.base != Base::Free {
        let largest = largest(loaded, log_multipliers, spine);
        let solve = |amount: f64, solution: &mut Solution| {
            loaded.solve_one(&statics, amount, solution);
        };
        let load = OneComponent { solve, largest };
        let found = nearest_on_path(load, &ForceSign::ALL, measured);
        if !found.is_usable() {
            return None;
        }
        loaded.start_from(&found.solution);
        return Some(FoundLoad { components: vec![found.force_n], base: Angle::ZERO });
    }
    loaded.reset();
    if !loaded.solve(&statics, &vec![0.0; count], Angle::ZERO, Wanted::AllRates) {
        return None;
    }
    let base = usize::from(hypothesis.base == Base::Free);
    let (groups, top) = (log_multipliers.len(), spine.springs.model.midpoints_mm.len() - 1);
    let size = size_factor(loaded, base)?;
    let mut load = SeveralOnFilm { loaded, statics, unknowns: count + base, groups, top };
    let x: DVector<f64> = nearest_from_starts(&mut load, &size, count, measured)?;
    load.restart();
    let (components, base) = loaded.split(x.as_slice());
    Some(FoundLoad { components: components.to_vec(), base })
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

/// One film under a load of several components, which the base's angle may follow.
struct SeveralOnFilm<'s, 'a> {
    loaded: &'s mut LoadedFilm,
    statics: GeneralStatics<'a>,
    unknowns: usize,
    groups: usize,
    top: usize,
}

impl SeveralComponents for SeveralOnFilm<'_, '_> {
    fn restart(&mut self) {
        self.loaded.reset();
    }

    fn t2(&mut self, components: &[f64]) -> Option<(Frontal, Vec<Frontal>)> {
        let (components, base) = self.loaded.split(components);
        if !self.loaded.solve(&self.statics, components, base, Wanted::AllRates) {
            return None;
        }
        let rate = |i| self.loaded.location_rate(self.groups + i, self.top);
        let rates = (0..self.unknowns).map(rate).collect();
        Some((self.loaded.location(self.top), rates))
    }
}
