//! The search of every fit: starts are refined one after another, and the best end counts.

use nalgebra::DVector;

use super::start::Start;
use crate::least_squares::{FitStatus, Minimum, System, minimize};

/// Least squares whose unknowns are `ln α` of every group and the load of every film.
pub(crate) trait FitProblem {
    /// Puts a start's loads in place, and gives its unknowns.
    fn begin(&mut self, start: &Start) -> DVector<f64>;

    /// The start that belongs to given unknowns.
    fn start_at(&mut self, x: &DVector<f64>) -> Start;

    /// Bounds of the unknowns of a fit from a start.
    fn bounds(&self, start: &DVector<f64>) -> [DVector<f64>; 2];

    /// Rows of what was measured, which come first.
    fn data_rows(&self) -> usize;

    /// All rows.
    fn rows(&self) -> usize;

    /// Residuals and derivatives; whether every film has an equilibrium that counts.
    fn evaluate(&mut self, x: &DVector<f64>, system: &mut System) -> bool;

    /// Sum of squares of what was measured.
    fn data_squares(&self, system: &System) -> f64 {
        system.residuals.rows(0, self.data_rows()).norm_squared()
    }

    /// Root mean square of what was measured.
    fn data_rms(&self, system: &System) -> f64 {
        (self.data_squares(system) / self.data_rows() as f64).sqrt()
    }
}

/// The best of the starts that were refined.
#[derive(Default)]
pub(crate) struct Best {
    /// With its end as a start.
    pub minimum: Option<(Minimum, Start)>,
    pub starts: u32,
    /// Where starts ended, with their sums of squares.
    ends: Vec<(Start, f64)>,
}

impl Best {
    /// Refines a start.
    pub fn improve(&mut self, problem: &mut impl FitProblem, start: &Start) {
        self.starts += 1;
        let x = problem.begin(start);
        let [lower, upper] = problem.bounds(&x);
        let rows = problem.rows();
        let end = minimize(x, &lower, &upper, rows, |x, system| problem.evaluate(x, system));
        if end.status == FitStatus::NotEvaluable {
            return;
        }
        let (at, cost) = (problem.start_at(&end.x), end.system.cost());
        self.ends.push((at.clone(), cost));
        if self.minimum.as_ref().is_none_or(|(best, _)| cost < best.system.cost()) {
            self.minimum = Some((end, at));
        }
    }

    /// Refines starts, which have their sums of squares, in their order until the residuals are small enough.
    pub fn improve_from(
        &mut self,
        problem: &mut impl FitProblem,
        starts: &[(Start, f64)],
        enough_rms: f64,
    ) {
        for (start, _) in starts {
            if self.satisfies(problem, enough_rms) {
                return;
            }
            self.improve(problem, start);
        }
    }

    /// Whether the root mean square of what was measured is below a limit.
    pub fn satisfies(&self, problem: &impl FitProblem, enough_rms: f64) -> bool {
        self.minimum.as_ref().is_some_and(|(best, _)| problem.data_rms(&best.system) < enough_rms)
    }

    /// Distinct ends whose sums of squares are within a factor of the best one's, that one first.
    pub fn minima(&self, factor: f64) -> Vec<Start> {
        /// Ends whose sums of squares agree like this are one.
        const SAME: f64 = 1e-4;
        let mut ends: Vec<&(Start, f64)> = self.ends.iter().collect();
        ends.sort_by(|a, b| a.1.total_cmp(&b.1));
        ends.dedup_by(|b, a| b.1 - a.1 <= SAME * a.1);
        let most = factor * ends.first().map_or(0.0, |end| end.1);
        ends.into_iter().filter(|end| end.1 <= most).map(|end| end.0.clone()).collect()
    }
}
