/// The few equations beside the hinges' equations: one for the arc, six for every rod. Buffers are made once.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Border {
    order: usize,
    /// Row by row, the right-hand side last.
    rows: Vec<Vec<f64>>,
    /// Which unknown belongs to which column.
    unknowns: Vec<usize>,
    solution: Vec<f64>,
}

/// Pivots that are smaller, beside the largest, determine nothing: the rod asks twice for the same.
const RANK_TOLERANCE: f64 = 1e-12;

impl Border {
    pub(super) fn new(largest_order: usize) -> Self {
        Self {
            order: 0,
            rows: vec![vec![0.0; largest_order + 1]; largest_order],
            unknowns: (0..largest_order).collect(),
            solution: vec![0.0; largest_order],
        }
    }

    /// Starts a system of `order` equations, all zero.
    pub(super) fn reset(&mut self, order: usize) {
        self.order = order;
        for row in &mut self.rows[..order] {
            row[..=order].fill(0.0);
        }
        for (place, unknown) in self.unknowns[..order].iter_mut().enumerate() {
            *unknown = place;
        }
    }

    pub(super) fn set(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row][column] = value;
    }

    pub(super) fn set_right_hand(&mut self, row: usize, value: f64) {
        self.rows[row][self.order] = value;
    }

    /// Gauss with full pivoting; what is not determined is zero.
    pub(super) fn solve(&mut self) {
        let n = self.order;
        let (mut rank, mut largest) = (n, 0.0);
        for step in 0..n {
            let (row, column, size) = self.largest_entry(step);
            if step == 0 {
                largest = size;
            }
            if size.is_nan() || size <= RANK_TOLERANCE * largest {
                rank = step;
                break;
            }
            if row != step {
                self.rows.swap(row, step);
            }
            if column != step {
                for row in &mut self.rows[..n] {
                    row.swap(column, step);
                }
                self.unknowns.swap(column, step);
            }
            let (above, below) = self.rows.split_at_mut(step + 1);
            let pivot = &above[step];
            for row in &mut below[..n - step - 1] {
                let factor = row[step] / pivot[step];
                for k in step..=n {
                    row[k] -= factor * pivot[k];
                }
            }
        }
        self.solution[..n].fill(0.0);
        for step in (0..rank).rev() {
            let row = &self.rows[step];
            let known: f64 =
                (step + 1..rank).map(|k| row[k] * self.solution[self.unknowns[k]]).sum();
            self.solution[self.unknowns[step]] = (row[n] - known) / row[step];
        }
    }

    pub(super) fn solution(&self) -> &[f64] {
        &self.solution[..self.order]
    }

    fn largest_entry(&self, from: usize) -> (usize, usize, f64) {
        let mut found = (from, from, 0.0);
        for row in from..self.order {
            for column in from..self.order {
                let size = self.rows[row][column].abs();
                if size > found.2 || size.is_nan() {
                    found = (row, column, size);
                }
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_system_is_solved() {
        // By hand: x = 1, y = -2, z = 3.
        let mut border = Border::new(4);
        border.reset(3);
        let rows = [[2.0, 0.0, 1.0, 5.0], [0.0, -1.0, 0.0, 2.0], [0.0, 3.0, 1.0, -3.0]];
        for (i, row) in rows.iter().enumerate() {
            (0..3).for_each(|k| border.set(i, k, row[k]));
            border.set_right_hand(i, row[3]);
        }
        border.solve();
        for (found, expected) in border.solution().iter().zip([1.0, -2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn an_equation_given_twice_is_used_once() {
        let mut border = Border::new(2);
        border.reset(2);
        for row in 0..2 {
            border.set(row, 0, 4.0);
            border.set(row, 1, 2.0);
            border.set_right_hand(row, 8.0);
        }
        border.solve();
        let [x, y] = border.solution() else { panic!("two unknowns") };
        assert!((4.0 * x + 2.0 * y - 8.0).abs() < 1e-14);
    }
}
