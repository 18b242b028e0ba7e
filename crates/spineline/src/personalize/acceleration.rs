//! Anderson's acceleration of a slow fixed-point iteration.

use nalgebra::{DMatrix, DVector};

/// The iteration has converged when no unknown moves by more than this.
pub(super) const CONVERGED_STEP: f64 = 1e-4;

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
}
