//! Bounded Levenberg-Marquardt, and the scale constraint of multipliers as a row of it: the one minimiser of all fits.

use nalgebra::{DMatrix, DVector};

/// How a minimisation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitStatus {
    /// No step lowers the sum of squares any more.
    Converged,
    /// The limit of iterations was reached.
    IterationLimit,
    /// The start itself could not be evaluated.
    NotEvaluable,
}

impl FitStatus {
    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::IterationLimit => "iteration_limit",
            Self::NotEvaluable => "not_evaluable",
        }
    }
}

/// Residuals and their derivatives, in memory that is used again and again.
#[derive(Debug, Clone)]
pub(crate) struct System {
    pub residuals: DVector<f64>,
    pub jacobian: DMatrix<f64>,
}

impl System {
    pub fn new(rows: usize, unknowns: usize) -> Self {
        Self { residuals: DVector::zeros(rows), jacobian: DMatrix::zeros(rows, unknowns) }
    }

    pub fn cost(&self) -> f64 {
        self.residuals.norm_squared()
    }

    /// Fills the last row with the gauge: the mean of the `ln α`, which are the first unknowns, is held at zero. Without
    /// any the row is zero.
    pub fn hold_mean(&mut self, log_multipliers: &[f64]) {
        /// The gauge is linear, and is held a thousand times tighter than any data.
        const GAUGE_WEIGHT: f64 = 1e3;
        let last = self.residuals.len() - 1;
        self.residuals[last] = 0.0;
        if log_multipliers.is_empty() {
            return;
        }
        let weight = GAUGE_WEIGHT / log_multipliers.len() as f64;
        self.residuals[last] = weight * log_multipliers.iter().sum::<f64>();
        for i in 0..log_multipliers.len() {
            self.jacobian[(last, i)] = weight;
        }
    }
}

/// The end of a minimisation.
#[derive(Debug, Clone)]
pub(crate) struct Minimum {
    pub status: FitStatus,
    pub iterations: u32,
    pub x: DVector<f64>,
    pub system: System,
}

/// Minimises a sum of squares within bounds.
///
/// Levenberg-Marquardt with Marquardt's scaling. Unknowns at a bound that the gradient pushes outwards take no part in
/// a step; the others are clamped to their bounds. `evaluate` fills the system and answers whether it could.
///
/// # Equations
/// A step solves `(J'J + d diag(J'J)) step = -J'r`. With `ratio` the actual over the predicted decrease of `|r|^2`, the damping
/// `d` becomes `d max(1/10, 1 - (2 ratio - 1)^3)` after a decrease; else it is multiplied by 2, 4, 8 and so on.
///
/// # References
/// [more-1978], [nielsen-1999].
pub(crate) fn minimize(
    mut x: DVector<f64>,
    lower: &DVector<f64>,
    upper: &DVector<f64>,
    rows: usize,
    mut evaluate: impl FnMut(&DVector<f64>, &mut System) -> bool,
) -> Minimum {
    const MAX_ITERATIONS: u32 = 100;
    let n = x.len();
    clamp(&mut x, lower, upper);
    let (mut system, mut trial) = (System::new(rows, n), System::new(rows, n));
    if !evaluate(&x, &mut system) {
        return Minimum { status: FitStatus::NotEvaluable, iterations: 0, x, system };
    }
    let mut damping = Damping::START;
    let mut iterations = 0;
    let mut status = FitStatus::IterationLimit;
    'outer: while iterations < MAX_ITERATIONS {
        iterations += 1;
        let (normal, gradient) = normal_equations(&system, &x, lower, upper);
        let cost = system.cost();
        loop {
            let Some(cholesky) = damped(&normal, damping.value).cholesky() else {
                if !damping.regularize() {
                    break 'outer;
                }
                continue;
            };
            let mut next = &x - cholesky.solve(&gradient);
            clamp(&mut next, lower, upper);
            let step = &next - &x;
            let small = (0..n).all(|i| step[i].abs() <= 1e-12 * (x[i].abs() + 1e-3));
            // What the linear model promises to take away.
            let promised = -2.0 * step.dot(&gradient) - normal_form(&normal, &step);
            let evaluable = evaluate(&next, &mut trial);
            if evaluable && trial.cost() < cost {
                damping.accept((cost - trial.cost()) / promised.max(f64::MIN_POSITIVE));
                let done = cost - trial.cost() <= 1e-7 * cost || small;
                std::mem::swap(&mut system, &mut trial);
                x = next;
                if done || system.cost() < 1e-24 {
                    status = FitStatus::Converged;
                    break 'outer;
                }
                break;
            }
            if small || promised.abs() <= 1e-12 * cost {
                // A neighbourhood in which nothing can be evaluated proves no minimum.
                if evaluable {
                    status = FitStatus::Converged;
                }
                break 'outer;
            }
            damping.reject();
        }
    }
    Minimum { status, iterations, x, system }
}

/// The damping of steps, by Nielsen's rule [nielsen-1999].
struct Damping {
    value: f64,
    /// The factor of the next rejected step.
    growth: f64,
}

impl Damping {
    const START: Self = Self { value: 1e-4, growth: 2.0 };

    /// After a decrease, with the ratio of the actual to the predicted one.
    fn accept(&mut self, ratio: f64) {
        self.value = (self.value * f64::max(0.1, 1.0 - (2.0 * ratio - 1.0).powi(3))).max(1e-15);
        self.growth = 2.0;
    }

    fn reject(&mut self) {
        self.value *= self.growth;
        self.growth *= 2.0;
    }

    /// Where the damped equations are singular; whether another try makes sense.
    fn regularize(&mut self) -> bool {
        self.value = self.value.max(1e-12) * 10.0;
        self.value <= 1e12
    }
}

fn damped(normal: &DMatrix<f64>, damping: f64) -> DMatrix<f64> {
    let mut damped = normal.clone();
    for i in 0..normal.nrows() {
        damped[(i, i)] += damping * normal[(i, i)] + f64::MIN_POSITIVE;
    }
    damped
}

fn clamp(x: &mut DVector<f64>, lower: &DVector<f64>, upper: &DVector<f64>) {
    for i in 0..x.len() {
        x[i] = x[i].clamp(lower[i], upper[i]);
    }
}

/// `JᵀJ` and `Jᵀr`, without the unknowns that take no part in a step: those held by equal bounds, and those at a bound that
/// the gradient pushes outwards.
#[expect(clippy::float_cmp, reason = "equal bounds hold an unknown exactly")]
fn normal_equations(
    system: &System,
    x: &DVector<f64>,
    lower: &DVector<f64>,
    upper: &DVector<f64>,
) -> (DMatrix<f64>, DVector<f64>) {
    let mut normal = system.jacobian.tr_mul(&system.jacobian);
    let mut gradient = system.jacobian.tr_mul(&system.residuals);
    for i in 0..x.len() {
        let outwards =
            (x[i] <= lower[i] && gradient[i] > 0.0) || (x[i] >= upper[i] && gradient[i] < 0.0);
        if outwards || lower[i] == upper[i] {
            normal.row_mut(i).fill(0.0);
            normal.column_mut(i).fill(0.0);
            normal[(i, i)] = 1.0;
            gradient[i] = 0.0;
        }
    }
    (normal, gradient)
}

/// `stepᵀ normal step`.
fn normal_form(normal: &DMatrix<f64>, step: &DVector<f64>) -> f64 {
    (0..step.len()).map(|i| step[i] * normal.column(i).dot(step)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as residuals `10 (y - x²)` and `1 - x`.
    fn rosenbrock(x: &DVector<f64>, system: &mut System) -> bool {
        system.residuals[0] = 10.0 * (x[1] - x[0] * x[0]);
        system.residuals[1] = 1.0 - x[0];
        system.jacobian.copy_from_slice(&[-20.0 * x[0], -1.0, 10.0, 0.0]);
        true
    }

    #[test]
    fn rosenbrock_is_solved_from_the_usual_start() {
        let wide = DVector::from_element(2, 1e3);
        let end = minimize(DVector::from_vec(vec![-1.2, 1.0]), &-&wide, &wide, 2, rosenbrock);
        assert_eq!(end.status, FitStatus::Converged);
        assert!((end.x - DVector::from_vec(vec![1.0, 1.0])).norm() < 1e-9);
    }

    #[test]
    fn a_bound_holds_and_the_rest_is_still_optimal() {
        let lower = DVector::from_vec(vec![-2.0, -2.0]);
        let upper = DVector::from_vec(vec![0.5, 2.0]);
        let end = minimize(DVector::from_vec(vec![-1.2, 1.0]), &lower, &upper, 2, rosenbrock);
        // With x = 0.5 the first residual can still be zero: y = 0.25.
        assert!((end.x[0] - 0.5).abs() < 1e-12 && (end.x[1] - 0.25).abs() < 1e-9);
    }
}
