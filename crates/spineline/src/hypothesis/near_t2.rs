//! The load on a film that was not fitted: the least one that brings T2 to within a millimetre of the nearest it gets.

use nalgebra::{DMatrix, DVector};

use super::problem::{LoadedFilm, statics};
use super::{Base, Hypothesis, Spine};
use crate::personalize::{FitStatus, System, minimize};
use crate::spatial::{Angle, Frontal};

/// T2's places that differ by less are equally good (decision 0008).
const TOLERANCE_MM: f64 = 1.0;
/// The search begins where T2 hardly moves, and ends where only its distance counts.
const FIRST_WEIGHT: f64 = 1e8;
const LAST_WEIGHT: f64 = 1e-2;
const WEIGHT_STEP: f64 = 0.1;
const BISECTIONS: u32 = 12;

/// A load that was found.
pub(super) struct NearT2 {
    pub components: Vec<f64>,
    pub base: Angle,
}

/// Finds it by following, from no load on, the shapes that minimise `|T2 - measured|² + w · size²` as `w` falls.
///
/// The size of a load is how far it turns the unloaded spine to first order, joint by joint in the root of the sum of squares, so that
/// forces and moments are compared alike. For one component it is proportional to the force. A free base counts
/// as one more joint; a noisy one stays at zero, which is expected of it. `None` where the path was lost.
pub(super) fn nearest_t2(
    hypothesis: Hypothesis,
    loaded: &mut LoadedFilm,
    log_multipliers: &[f64],
    measured: Frontal,
    spine: &Spine<'_>,
) -> Option<NearT2> {
    let mut search = Search::new(hypothesis, loaded, log_multipliers, measured, spine)?;
    let mut found: Vec<(f64, DVector<f64>, f64)> = Vec::new();
    let mut x = DVector::zeros(search.unknowns());
    let mut weight = FIRST_WEIGHT;
    while weight >= LAST_WEIGHT {
        // A path that is lost ends at its last shape.
        let Some(next) = search.at(weight, &x) else { break };
        x = next;
        found.push((weight, x.clone(), search.gap_mm(&x)?));
        weight *= WEIGHT_STEP;
    }
    let least_mm = found.iter().map(|(.., gap)| *gap).fold(f64::INFINITY, f64::min);
    let enough_mm = least_mm + TOLERANCE_MM;
    let first = found.iter().position(|(.., gap)| *gap <= enough_mm)?;
    let (mut near, mut x, _) = found.swap_remove(first);
    if first > 0 {
        let mut far = near / WEIGHT_STEP;
        for _ in 0..BISECTIONS {
            let middle = (near * far).sqrt();
            let Some(next) = search.at(middle, &x) else { break };
            let gap = search.gap_mm(&next)?;
            if gap <= enough_mm {
                (near, x) = (middle, next);
            } else {
                far = middle;
            }
        }
    }
    let (components, base) = search.split(&x);
    Some(NearT2 { components: components.to_vec(), base })
}

struct Search<'s, 'a> {
    loaded: &'s mut LoadedFilm,
    statics: crate::multibody::GeneralStatics<'a>,
    measured: Frontal,
    /// `size² = |factor · x|²`.
    size: DMatrix<f64>,
    components: usize,
    groups: usize,
    top: usize,
}

impl<'s, 'a> Search<'s, 'a> {
    fn new(
        hypothesis: Hypothesis,
        loaded: &'s mut LoadedFilm,
        log_multipliers: &[f64],
        measured: Frontal,
        spine: &Spine<'a>,
    ) -> Option<Self> {
        let statics = statics(spine, log_multipliers);
        let components = hypothesis.load.components();
        loaded.reset();
        if !loaded.solve(&statics, &vec![0.0; components], Angle::ZERO) {
            return None;
        }
        let unknowns = components + usize::from(hypothesis.base == Base::Free);
        let joints = spine.model.joints.len();
        let mut squares = DMatrix::<f64>::zeros(unknowns, unknowns);
        for a in 0..components {
            for b in 0..components {
                squares[(a, b)] = (0..joints)
                    .map(|j| loaded.joint_rate(a, j).dot(&loaded.joint_rate(b, j)))
                    .sum();
            }
        }
        if unknowns > components {
            squares[(components, components)] = 1.0;
        }
        let size = squares.cholesky()?.l().transpose();
        let top = spine.model.midpoints_mm.len() - 1;
        let groups = log_multipliers.len();
        Some(Self { loaded, statics, measured, size, components, groups, top })
    }

    fn unknowns(&self) -> usize {
        self.size.ncols()
    }

    fn split<'x>(&self, x: &'x DVector<f64>) -> (&'x [f64], Angle) {
        let base = x.as_slice().get(self.components).copied().unwrap_or(0.0);
        (&x.as_slice()[..self.components], Angle::from_rad(base))
    }

    fn gap_mm(&mut self, x: &DVector<f64>) -> Option<f64> {
        let (components, base) = self.split(x);
        let solved = self.loaded.solve(&self.statics, components, base);
        solved.then(|| self.loaded.location(self.top).distance_mm(self.measured))
    }

    fn at(&mut self, weight: f64, from: &DVector<f64>) -> Option<DVector<f64>> {
        let unknowns = self.unknowns();
        let free = DVector::from_element(unknowns, f64::INFINITY);
        let root = weight.sqrt();
        let end = minimize(from.clone(), &-&free, &free, 2 + unknowns, |x, system: &mut System| {
            let (components, base) = self.split(x);
            if !self.loaded.solve(&self.statics, components, base) {
                return false;
            }
            let off = self.loaded.location(self.top) - self.measured;
            system.residuals[0] = off.y_mm;
            system.residuals[1] = off.z_mm;
            for i in 0..unknowns {
                let rate = self.loaded.location_rate(self.groups + i, self.top);
                system.jacobian[(0, i)] = rate.y_mm;
                system.jacobian[(1, i)] = rate.z_mm;
            }
            let size = &self.size * x * root;
            system.residuals.rows_mut(2, unknowns).copy_from(&size);
            system.jacobian.rows_mut(2, unknowns).copy_from(&(&self.size * root));
            true
        });
        (end.status != FitStatus::NotEvaluable).then_some(end.x)
    }
}
