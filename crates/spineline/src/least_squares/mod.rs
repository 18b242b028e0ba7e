//! Bounded Levenberg-Marquardt, and the scale constraint of multipliers as a row of it: the one minimiser of all fits.

use crate::anatomy::named;
use nalgebra::{DMatrix, DVector};

named! {
    /// How a minimisation ended.
    pub enum FitStatus {
        /// No step lowers the sum of squares any more.
        Converged = "converged",
        /// The limit of iterations was reached.
        IterationLimit = "iteration_limit",
        /// The derivatives promise a decrease, but no step that can be evaluated lowers the sum of squares.
        Stalled = "stalled",
        /// The start itself could not be evaluated.
        NotEvaluable = "not_evaluable",
    }
}

/// Residuals and their derivatives, in memory that is reused.
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

    /// Fills the last row with the gauge: the mean of the `ln α`, which are the first unknowns, is held at zero. `shift` is the multiplier
    /// of this constraint over the square of its weight. Without `ln α` the row is zero.
    pub fn hold_mean(&mut self, log_multipliers: &[f64], shift: f64) {
        /// The gauge is linear, and is held a thousand times tighter than any data.
        const GAUGE_WEIGHT: f64 = 1e3;
        let last = self.residuals.len() - 1;
        self.residuals[last] = 0.0;
        if log_multipliers.is_empty() {
            return;
        }
        let weight = GAUGE_WEIGHT / log_multipliers.len() as f64;
        self.residuals[last] = weight * log_multipliers.iter().sum::<f64>() + GAUGE_WEIGHT * shift;
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
/// Levenberg-Marquardt with Marquardt's scaling, whose steps stay within the bounds. `evaluate` fills the system and answers
/// whether it could.
///
/// # Equations
/// A step solves `(J'J + d diag(J'J)) step = -J'r`. Unknowns at a bound that the gradient pushes outwards take no part in it.
/// One that reaches a bound stays there, and the equations of the others are solved again from that point. With `ratio` the
/// actual over the predicted decrease of `|r|^2`, the damping `d` becomes `d max(1/10, 1 - (2 ratio - 1)^3)` after a decrease;
/// else it is multiplied by 2, 4, 8 and so on.
///
/// # End
/// A step is the last one where the undamped step promises a decrease of at most `1e-6 max(1, |r|^2 / rows)`. With residuals in standard
/// deviations, its root is the length of the step in standard deviations of the unknowns, which residuals beyond the noise widen: 0.001,
/// however flat the minimum is.
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
    const MAX_ITERATIONS: u32 = 1000;
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
        let normal = system.jacobian.tr_mul(&system.jacobian);
        let gradient = system.jacobian.tr_mul(&system.residuals);
        let cost = system.cost();
        let step_at = |damping: f64| bounded_step(&normal, damping, &gradient, &x, [lower, upper]);
        let promise = |next: &DVector<f64>| {
            let step = next - &x;
            -2.0 * step.dot(&gradient) - normal_form(&normal, &step)
        };
        let least = LAST_DECREASE * f64::max(1.0, cost / rows as f64);
        if step_at(UNDAMPED).is_some_and(|next| promise(&next) <= least) {
            // Damped, so that an unknown that the residuals hardly depend on stays where it is.
            let last = step_at(damping.value).unwrap_or_else(|| x.clone());
            // A neighbourhood in which nothing can be evaluated does not prove a minimum.
            if evaluate(&last, &mut trial) {
                status = FitStatus::Converged;
                if trial.cost() <= cost + least {
                    (x, system) = (last, trial);
                }
            }
            break;
        }
        loop {
            let step = step_at(damping.value);
            let Some(next) = step else {
                if !damping.regularize() {
                    status = FitStatus::Stalled;
                    break 'outer;
                }
                continue;
            };
            let evaluable = evaluate(&next, &mut trial);
            if evaluable && trial.cost() < cost {
                let promised = promise(&next).max(f64::MIN_POSITIVE);
                damping.accept((cost - trial.cost()) / promised);
                std::mem::swap(&mut system, &mut trial);
                x = next;
                break;
            }
            if !damping.reject() {
                status = FitStatus::Stalled;
                break 'outer;
            }
        }
    }
    Minimum { status, iterations, x, system }
}

/// A step of 0.001 standard deviations.
const LAST_DECREASE: f64 = 1e-6;
/// Keeps the equations of the undamped step regular where the residuals do not depend on an unknown.
const UNDAMPED: f64 = 1e-12;

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

    /// After no decrease; whether another try makes sense.
    fn reject(&mut self) -> bool {
        self.value *= self.growth;
        self.growth *= 2.0;
        self.value.is_finite()
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

/// Where the damped equations lead from `x` within the bounds; `None` where they are singular.
///
/// The way is a chain of straight parts. Each leads towards the minimum of the quadratic model in the unknowns that are
/// still free, and ends at the first bound, which holds its unknown from then on.
fn bounded_step(
    normal: &DMatrix<f64>,
    damping: f64,
    gradient: &DVector<f64>,
    x: &DVector<f64>,
    [lower, upper]: [&DVector<f64>; 2],
) -> Option<DVector<f64>> {
    let mut held = held_from_start(gradient, x, [lower, upper]);
    let (mut next, mut slope) = (x.clone(), gradient.clone());
    loop {
        let mut equations = damped(normal, damping);
        for i in (0..x.len()).filter(|&i| held[i]) {
            equations.row_mut(i).fill(0.0);
            equations.column_mut(i).fill(0.0);
            equations[(i, i)] = 1.0;
            slope[i] = 0.0;
        }
        let way = -equations.cholesky()?.solve(&slope);
        let mut first: Option<(usize, f64)> = None;
        let mut part = 1.0;
        for i in (0..x.len()).filter(|&i| !held[i] && way[i] != 0.0) {
            let bound = if way[i] > 0.0 { upper[i] } else { lower[i] };
            let reach = (bound - next[i]) / way[i];
            if reach < part {
                (part, first) = (reach, Some((i, bound)));
            }
        }
        next.axpy(part, &way, 1.0);
        clamp(&mut next, lower, upper);
        let Some((i, bound)) = first else { return Some(next) };
        (next[i], held[i]) = (bound, true);
        slope = gradient + damped(normal, damping) * (&next - x);
    }
}

/// Unknowns that take no part in a step: those with equal bounds, and those at a bound that the gradient pushes outwards.
#[expect(clippy::float_cmp, reason = "equal bounds hold an unknown exactly")]
fn held_from_start(
    gradient: &DVector<f64>,
    x: &DVector<f64>,
    [lower, upper]: [&DVector<f64>; 2],
) -> Vec<bool> {
    let held = |i: usize| {
        let outwards =
            (x[i] <= lower[i] && gradient[i] > 0.0) || (x[i] >= upper[i] && gradient[i] < 0.0);
        outwards || lower[i] == upper[i]
    };
    (0..x.len()).map(held).collect()
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
        assert!((end.x - DVector::from_vec(vec![1.0, 1.0])).norm() < 1e-4);
    }

    #[test]
    fn a_bound_holds_and_the_rest_is_still_optimal() {
        let lower = DVector::from_vec(vec![-2.0, -2.0]);
        let upper = DVector::from_vec(vec![0.5, 2.0]);
        let end = minimize(DVector::from_vec(vec![-1.2, 1.0]), &lower, &upper, 2, rosenbrock);
        // With x = 0.5 the first residual can still be zero: y = 0.25.
        assert!((end.x[0] - 0.5).abs() < 1e-12 && (end.x[1] - 0.25).abs() < 1e-9);
    }

    #[test]
    fn an_unknown_that_changes_nothing_stays_where_it_is() {
        let wide = DVector::from_element(2, f64::INFINITY);
        let end = minimize(DVector::from_vec(vec![3.0, 0.5]), &-&wide, &wide, 1, |x, system| {
            system.residuals[0] = x[0] - 1.0;
            system.jacobian[(0, 0)] = 1.0;
            true
        });
        assert_eq!(end.status, FitStatus::Converged);
        assert!((end.x - DVector::from_vec(vec![1.0, 0.5])).norm() < 1e-6);
    }

    /// Three unknowns whose mean is held, as multipliers are: `x - target`, and the gauge.
    #[test]
    fn a_step_ends_at_a_bound_and_keeps_a_mean_that_is_held() {
        let target = [4.0, -1.0, 0.0];
        let mut evaluations = 0;
        let evaluate = |x: &DVector<f64>, system: &mut System| {
            evaluations += 1;
            for i in 0..3 {
                system.residuals[i] = x[i] - target[i];
                system.jacobian[(i, i)] = 1.0;
            }
            system.hold_mean(x.as_slice(), 0.0);
            true
        };
        let wide = DVector::from_element(3, 2.0);
        let end = minimize(DVector::zeros(3), &-&wide, &wide, 4, evaluate);
        // The others share what the bound leaves: they are 1 apart, and their sum is -2.
        let expected = DVector::from_vec(vec![2.0, -1.5, -0.5]);
        assert!((&end.x - expected).norm() < 1e-4, "{}", end.x);
        assert_eq!(end.status, FitStatus::Converged);
        // None is lost to a step that leaves the mean.
        assert_eq!(evaluations, end.iterations + 1);
    }
}
