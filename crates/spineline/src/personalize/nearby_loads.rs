//! Loads of best fit to other readings of films that were fitted before.
//!
//! # Equations
//! One round of the iteration takes a place `x`, of all unknowns and the loads, to `x + s(x)`, and has converged where `s` vanishes.
//! Films that were read again converge at another place, but `s` changes with the place nearly as it does for the first readings:
//!
//! ```text
//! P = -(ds/dx)^-1  at the end of the first readings' fit,   x <- x + P s(x)
//! ```
//!
//! which is Newton's method with a derivative from nearby. The random effects, about which the equations are linear, keep the values
//! of the first readings. Its steps are extrapolated [anderson-1965]. The mean of `ln alpha` is held,
//! so that `s` has no part along it: there `ds/dx` is taken as -1.

use nalgebra::{DMatrix, DVector, Vector3};

use super::acceleration::{CONVERGED_STEP, IterationStep, anderson_step};
use super::evidence::FilmEvidence;
use super::mixed_equations::{Fit, Linearized};
use super::preferred_loads::PreferredLoads;
use super::random_effects::{OwnParts, VARIANCES, Waves};
use crate::clinical::JointShares;

/// A warm-started fit that needs more rounds converges elsewhere.
const ROUNDS: usize = 25;
/// Steps that are extrapolated.
const MEMORY: usize = 5;

/// The end of the fit to some readings, and the derivative of its steps there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NearbyLoads {
    /// Its unknowns and its loads, these in parts of their sizes.
    place: DVector<f64>,
    sizes: DVector<f64>,
    groups: usize,
    own: Vec<OwnParts>,
    /// Minus the inverse derivative of a step.
    step_matrix: DMatrix<f64>,
}

impl NearbyLoads {
    /// About a fit to these films; `None` where the films do not determine the loads.
    pub fn about(
        found: &PreferredLoads,
        films: &[&FilmEvidence],
        depth_mm: f64,
        shares: &JointShares,
    ) -> Option<Self> {
        let waves = Waves::new(shares.0.nrows());
        let mut fit = Fit::new(films, depth_mm, shares, &waves)?;
        let variances = found.begin(&mut fit);
        let sizes = fit.load_sizes();
        let place = fit.place_with_loads(variances, &sizes);
        let all = place.len();
        // With a multiplier on its bound, the step is discontinuous.
        let step_matrix =
            if fit.is_bounded(&place) { None } else { step_matrix_at(&mut fit, &place, &sizes) };
        let step_matrix = step_matrix.unwrap_or_else(|| DMatrix::identity(all, all));
        let (groups, own) = (found.log_multipliers.len(), found.own.clone());
        Some(Self { place, sizes, groups, own, step_matrix })
    }

    /// Whether it has this number of groups.
    pub fn has_groups(&self, groups: usize) -> bool {
        self.groups == groups
    }

    /// Iterates from there to convergence; the variances at the end, and the equations up to the last step. `None` if the end is not
    /// nearby.
    pub(super) fn settle<'a>(&self, fit: &mut Fit<'a>) -> Option<(Vector3<f64>, Linearized<'a>)> {
        fit.take_own(&self.own, 1.0);
        let mut place = self.place.clone();
        let mut steps: Vec<IterationStep> = Vec::new();
        for _ in 0..ROUNDS {
            let variances = fit.set_place_with_loads(&place, &self.sizes);
            let state = fit.linearize(variances)?;
            let step = fit.step_with_loads(&state, variances, &self.sizes);
            let to = &place + &self.step_matrix * step;
            let step = IterationStep { from: place, to };
            if self.has_converged(&step) {
                return Some((fit.set_place_with_loads(&step.to, &self.sizes), state));
            }
            steps.insert(0, step);
            steps.truncate(MEMORY);
            place = fit.within(anderson_step(&steps));
        }
        None
    }

    /// Whether a step is the last one. Steps predict the end: the remaining distance is a small part of a step.
    fn has_converged(&self, step: &IterationStep) -> bool {
        /// Of loads, in parts of their sizes, and of `ln` of the variances, on which the loads depend little.
        const CONVERGED: f64 = 10.0 * CONVERGED_STEP;
        let step = step.step();
        let others = VARIANCES..step.len() - self.sizes.len();
        step.amax() < CONVERGED && step.rows_range(others).amax() < CONVERGED_STEP
    }
}

/// Minus the inverse of a step's derivative by the place, by differences; `None` without one.
fn step_matrix_at(
    fit: &mut Fit<'_>,
    place: &DVector<f64>,
    sizes: &DVector<f64>,
) -> Option<DMatrix<f64>> {
    const DIFFERENCE: f64 = 1e-4;
    let mut step_beside = |unknown: usize, by: f64| {
        let mut beside = place.clone();
        beside[unknown] += by;
        let variances = fit.set_place_with_loads(&beside, sizes);
        Some(fit.step_with_loads(&fit.linearize(variances)?, variances, sizes))
    };
    let mut rate = |unknown: usize| {
        let change = step_beside(unknown, DIFFERENCE)? - step_beside(unknown, -DIFFERENCE)?;
        Some(change / (2.0 * DIFFERENCE))
    };
    let rates: Vec<DVector<f64>> = (0..place.len()).map(&mut rate).collect::<Option<_>>()?;
    let mut rates = DMatrix::from_columns(&rates);
    let groups = fit.groups();
    let mut logs = rates.view_mut((VARIANCES, VARIANCES), (groups, groups));
    logs.add_scalar_mut(-1.0 / groups as f64);
    let step_matrix = -rates.try_inverse()?;
    step_matrix.iter().all(|part| part.is_finite()).then_some(step_matrix)
}

impl PreferredLoads {
    /// Puts its unknowns in a fit, and returns its variances.
    fn begin(&self, fit: &mut Fit<'_>) -> Vector3<f64> {
        let sds = [self.joint_log_sd, self.centre_sd_discs, self.trend_log_sd];
        fit.loads =
            DVector::from_iterator(fit.loads.len(), self.components.iter().flatten().copied());
        fit.take_own(&self.own, 1.0);
        fit.begin(&self.log_multipliers, self.centres_higher_discs, self.evenness);
        Vector3::from(sds.map(|sd| sd.powi(2)))
    }
}
