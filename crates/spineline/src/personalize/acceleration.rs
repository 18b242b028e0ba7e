//! Anderson's acceleration of a slow fixed-point iteration.

use nalgebra::{DMatrix, DVector};

/// Beyond this an extrapolation means nothing.
const MAX_EXTRAPOLATION: f64 = 1.0;

/// One step of an iteration.
pub(super) struct IterationStep {
    pub from: DVector<f64>,
    pub to: DVector<f64>,
}

impl IterationStep {
    pub fn step(&self) -> DVector<f64> {
        &self.to - &self.from
    }
}

/// The limit of an iteration, extrapolated from its last steps, the latest one first: the combination of their ends whose
/// combined step is the shortest.
///
/// # References
/// [anderson-1965].
pub(super) fn anderson_step(steps: &[IterationStep]) -> DVector<f64> {
    let last = &steps[0];
    let changes: Vec<DVector<f64>> =
        steps.windows(2).map(|pair| pair[0].step() - pair[1].step()).collect();
    if changes.is_empty() {
        return last.to.clone();
    }
    let changes = DMatrix::from_columns(&changes);
    // Changes that are alike carry no more information than one of them.
    let least = 1e-6 * changes.amax();
    let Ok(parts) = changes.svd(true, true).solve(&last.step(), least) else {
        return last.to.clone();
    };
    let ends = steps.windows(2).map(|pair| &pair[0].to - &pair[1].to);
    let beyond: DVector<f64> = ends.zip(parts.iter()).map(|(end, part)| end * *part).sum();
    if beyond.amax() < MAX_EXTRAPOLATION { &last.to - beyond } else { last.to.clone() }
}

/// How the steps of an iteration change with their place, learned near its end.
///
/// # References
/// [broyden-1965], the first method.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Secant {
    /// Inverse of the derivative of a step by its place.
    inverse: DMatrix<f64>,
}

impl Secant {
    /// From the derivative; in directions in which steps do not change it goes nowhere.
    pub fn of(rates: DMatrix<f64>) -> Option<Self> {
        /// Of the largest singular value.
        const SINGULAR: f64 = 1e-6;
        let least = SINGULAR * rates.amax();
        let inverse = rates.pseudo_inverse(least).ok()?;
        inverse.iter().all(|part| part.is_finite()).then_some(Self { inverse })
    }

    /// Where a step vanishes, as far as it is known.
    pub fn place(&self, last: &IterationStep) -> DVector<f64> {
        let beyond = &self.inverse * last.step();
        if beyond.amax() < MAX_EXTRAPOLATION { &last.from - beyond } else { last.to.clone() }
    }

    /// What is known after the last of some steps, the latest one first; `None` where it led away from the end.
    pub fn after(mut self, steps: &[IterationStep]) -> Option<Self> {
        let [last, before, ..] = steps else { return Some(self) };
        let (step, step_before) = (last.step(), before.step());
        if step.amax() > step_before.amax() {
            return None;
        }
        let moved = &last.from - &before.from;
        let foreseen = &self.inverse * (step - step_before);
        let along = moved.dot(&foreseen);
        if along != 0.0 {
            let weights = self.inverse.tr_mul(&moved) / along;
            self.inverse += (moved - foreseen) * weights.transpose();
        }
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_slow_directions_are_left_in_three_steps() {
        // Oracle: the fixed point is 0; the map shortens one direction to 0.9 and turns the other about, by -0.8.
        let map = |x: &DVector<f64>| DVector::from_vec(vec![0.9 * x[0], -0.8 * x[1]]);
        let mut x = DVector::from_vec(vec![0.5, 0.3]);
        let mut steps: Vec<IterationStep> = Vec::new();
        for _ in 0..3 {
            steps.insert(0, IterationStep { to: map(&x), from: x });
            x = anderson_step(&steps);
        }
        assert!(x.amax() < 1e-12, "{x}");
    }

    #[test]
    fn a_secant_from_nearby_learns_the_rest() {
        // Oracle: the fixed point is 0; the first rates are a fifth off. The third direction never moves.
        let map = |x: &DVector<f64>| DVector::from_vec(vec![0.9 * x[0], -0.8 * x[1], x[2]]);
        let rates = DMatrix::from_diagonal(&DVector::from_vec(vec![-0.12, -1.5, 0.0]));
        let mut secant = Secant::of(rates).expect("finite");
        let mut x = DVector::from_vec(vec![0.5, 0.3, 0.2]);
        let mut steps: Vec<IterationStep> = Vec::new();
        for _ in 0..7 {
            steps.insert(0, IterationStep { to: map(&x), from: x });
            secant = secant.after(&steps).expect("nearer and nearer");
            x = secant.place(&steps[0]);
        }
        assert!(x.rows(0, 2).amax() < 1e-9 && (x[2] - 0.2).abs() < 1e-15, "{x}");
    }
}
