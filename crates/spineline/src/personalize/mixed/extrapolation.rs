//! Extrapolation of an iteration to its limit.

use nalgebra::{DMatrix, DVector};

/// Beyond this an extrapolation means nothing.
const MAX_EXTRAPOLATION: f64 = 1.0;

/// One step of an iteration, and where it began.
pub(super) struct Step {
    pub from: DVector<f64>,
    pub step: DVector<f64>,
}

/// The limit of an iteration, extrapolated from its last steps, the latest one first: the combination of their ends whose combined
/// step is the shortest [anderson-1965].
pub(super) fn anderson(steps: &[Step]) -> DVector<f64> {
    let last = &steps[0];
    let end = &last.from + &last.step;
    let changes: Vec<DVector<f64>> =
        steps.windows(2).map(|pair| &pair[0].step - &pair[1].step).collect();
    if changes.is_empty() {
        return end;
    }
    let changes = DMatrix::from_columns(&changes);
    // Changes that are alike carry no more information than one of them.
    let least = 1e-6 * changes.amax();
    let Ok(parts) = changes.clone().svd(true, true).solve(&last.step, least) else { return end };
    let moves = steps.windows(2).map(|pair| &pair[0].from - &pair[1].from);
    let beyond: DVector<f64> = moves
        .zip(changes.column_iter())
        .zip(&parts)
        .map(|((from, step), part)| (from + step) * *part)
        .sum();
    if beyond.amax() < MAX_EXTRAPOLATION { end - beyond } else { end }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_slow_directions_are_left_in_three_steps() {
        // Oracle: the fixed point is 0; the map shortens one direction to 0.9 and turns the other about, by -0.8.
        let mut x = DVector::from_vec(vec![0.5, 0.3]);
        let mut steps: Vec<Step> = Vec::new();
        for _ in 0..3 {
            let step = DVector::from_vec(vec![-0.1 * x[0], -1.8 * x[1]]);
            steps.insert(0, Step { from: x, step });
            x = anderson(&steps);
        }
        assert!(x.amax() < 1e-12, "{x}");
    }
}
