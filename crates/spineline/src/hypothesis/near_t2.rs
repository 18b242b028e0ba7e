//! The load on a film that was not fitted: the smallest one that brings T2 to within a millimetre of its smallest distance.

use nalgebra::{DMatrix, DVector};

use super::problem::{LoadedFilm, statics};
use super::{Base, Hypothesis, Spine};
use crate::least_squares::{FitStatus, System, minimize};
use crate::multibody::{GeneralStatics, T2_TOLERANCE_MM, smallest_near_t2};
use crate::spatial::{Angle, Frontal};

/// Weights of a load's size against T2's distance: where T2 hardly moves, and where only its distance counts.
const MAX_WEIGHT: f64 = 1e8;
const MIN_WEIGHT: f64 = 1e-2;
const WEIGHT_STEP: f64 = 10.0;
const BISECTIONS: u32 = 12;
/// T2's distance may have several minima: sizes of load, in rad, from which they are sought.
const START_SIZES: [f64; 4] = [0.1, 0.2, 0.4, 0.8];

/// A load that was found.
pub(super) struct NearT2 {
    pub components: Vec<f64>,
    pub base: Angle,
}

/// Finds it: minima of `|T2 - measured|² + w · size²` for a weight that is next to nothing, sought from no load and from every
/// component by itself, both ways and in several sizes. Of those within a millimetre of the nearest the smallest counts, and from
/// there the weight grows for as long as T2 stays within that millimetre.
///
/// The size of a load is how far it turns the unloaded spine to first order, joint by joint in the root of the sum of squares, so that
/// forces and moments are compared alike. For one component it is proportional to the force. A free base counts
/// as one more joint; a noisy one stays at zero, which is expected of it. `None` where no equilibrium was found.
pub(super) fn nearest_t2(
    hypothesis: Hypothesis,
    loaded: &mut LoadedFilm,
    log_multipliers: &[f64],
    measured: Frontal,
    spine: &Spine<'_>,
) -> Option<NearT2> {
    let mut search = Search::new(hypothesis, loaded, log_multipliers, measured, spine)?;
    let minima: Vec<(f64, f64, DVector<f64>)> = search
        .starts()
        .into_iter()
        .filter_map(|start| {
            let x = search.at(MIN_WEIGHT, &start)?;
            Some((search.gap_mm(&x)?, (&search.size * &x).norm(), x))
        })
        .collect();
    let nearest_mm = minima.iter().map(|(gap, ..)| *gap).fold(f64::INFINITY, f64::min);
    let (.., x) = smallest_near_t2(minima, nearest_mm, |(gap, ..)| *gap, |(_, size, _)| *size)?;
    let x = search.lighten(x, nearest_mm + T2_TOLERANCE_MM);
    let (components, base) = search.split(&x);
    Some(NearT2 { components: components.to_vec(), base })
}

struct Search<'s, 'a> {
    loaded: &'s mut LoadedFilm,
    statics: GeneralStatics<'a>,
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

    /// No load, and every component by itself.
    fn starts(&self) -> Vec<DVector<f64>> {
        let none = DVector::zeros(self.unknowns());
        let mut starts = vec![none.clone()];
        for i in 0..self.components {
            let unit = self.size.column(i).norm();
            for size in START_SIZES.into_iter().flat_map(|size| [size, -size]) {
                let mut start = none.clone();
                start[i] = size / unit;
                starts.push(start);
            }
        }
        starts
    }

    /// The least load on the way from a minimum to no load that leaves T2 near enough.
    fn lighten(&mut self, minimum: DVector<f64>, enough_mm: f64) -> DVector<f64> {
        let (mut x, mut light, mut heavy) = (minimum, MIN_WEIGHT, MIN_WEIGHT);
        let mut step = |weight: f64, x: &DVector<f64>| {
            let next = self.at(weight, x)?;
            (self.gap_mm(&next)? <= enough_mm).then_some(next)
        };
        while heavy < MAX_WEIGHT {
            heavy = light * WEIGHT_STEP;
            let Some(next) = step(heavy, &x) else { break };
            (x, light) = (next, heavy);
        }
        for _ in 0..BISECTIONS {
            let middle = (light * heavy).sqrt();
            match step(middle, &x) {
                Some(next) => (x, light) = (next, middle),
                None => heavy = middle,
            }
        }
        x
    }

    fn at(&mut self, weight: f64, from: &DVector<f64>) -> Option<DVector<f64>> {
        let unknowns = self.unknowns();
        let free = DVector::from_element(unknowns, f64::INFINITY);
        let root = weight.sqrt();
        self.loaded.reset();
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
