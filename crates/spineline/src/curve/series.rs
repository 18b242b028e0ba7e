/// `S u² Σ c_k T_k(2u - 1)` with `u = t / S`: zero with zero slope at `t = 0`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    scale_mm: f64,
    coefficients: Vec<f64>,
}

impl Series {
    pub(super) fn new(scale_mm: f64, coefficients: Vec<f64>) -> Self {
        Self { scale_mm, coefficients }
    }

    /// The series that is zero everywhere.
    pub(super) fn zero(scale_mm: f64) -> Self {
        Self::new(scale_mm, Vec::new())
    }

    pub(super) fn coefficients(&self) -> impl Iterator<Item = f64> {
        self.coefficients.iter().copied()
    }

    pub(super) fn value(&self, t_mm: f64) -> f64 {
        let ([value], _) = self.values_and_slopes([t_mm]);
        value
    }

    /// Values and first derivatives at several places, computed side by side: the sum over the polynomials and its
    /// derivative by Clenshaw's recurrence [clenshaw-1955].
    #[inline]
    pub(super) fn values_and_slopes<const N: usize>(&self, t_mm: [f64; N]) -> ([f64; N], [f64; N]) {
        let u = t_mm.map(|t| t / self.scale_mm);
        let x = u.map(|u| 2.0 * u - 1.0);
        let Some((first, others)) = self.coefficients.split_first() else {
            return ([0.0; N], [0.0; N]);
        };
        // At the orders k + 1 and k + 2.
        let ([mut sum, mut before], [mut rate, mut rate_before]) = ([[0.0; N]; 2], [[0.0; N]; 2]);
        for coefficient in others.iter().rev() {
            for i in 0..N {
                let next_rate = 2.0 * (sum[i] + x[i] * rate[i]) - rate_before[i];
                let next = coefficient + (2.0 * x[i] * sum[i] - before[i]);
                (before[i], sum[i]) = (sum[i], next);
                (rate_before[i], rate[i]) = (rate[i], next_rate);
            }
        }
        let (mut values, mut slopes) = ([0.0; N], [0.0; N]);
        for i in 0..N {
            let q = first + (x[i] * sum[i] - before[i]);
            let dq_by_u = 2.0 * (sum[i] + x[i] * rate[i] - rate_before[i]);
            values[i] = self.scale_mm * u[i] * u[i] * q;
            slopes[i] = u[i] * (2.0 * q + u[i] * dq_by_u);
        }
        (values, slopes)
    }

    /// Value, first and second derivative.
    pub(super) fn jet(&self, t_mm: f64) -> [f64; 3] {
        let mut jet = [0.0; 3];
        for_each_basis(self.scale_mm, t_mm, self.coefficients.len(), |k, basis| {
            for (sum, value) in jet.iter_mut().zip(basis) {
                *sum += self.coefficients[k] * value;
            }
        });
        jet
    }
}

/// Calls `f` with the value and the first two derivatives of every basis function at `t`.
#[inline(always)]
pub(super) fn for_each_basis(
    scale_mm: f64,
    t_mm: f64,
    count: usize,
    mut f: impl FnMut(usize, [f64; 3]),
) {
    let u = t_mm / scale_mm;
    let x = 2.0 * u - 1.0;
    // Chebyshev polynomials and their first two derivatives by x, at orders k and k - 1.
    let (mut now, mut before) = ([1.0, 0.0, 0.0], [x, 1.0, 0.0]);
    for k in 0..count {
        let [q, dq, ddq] = [now[0], 2.0 * now[1], 4.0 * now[2]];
        f(
            k,
            [
                scale_mm * u * u * q,
                2.0 * u * q + u * u * dq,
                (2.0 * q + 4.0 * u * dq + u * u * ddq) / scale_mm,
            ],
        );
        let next = [
            2.0 * x * now[0] - before[0],
            2.0 * now[0] + 2.0 * x * now[1] - before[1],
            4.0 * now[1] + 2.0 * x * now[2] - before[2],
        ];
        (before, now) = (now, next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_basis_is_the_chebyshev_polynomials_times_u_squared() {
        // T3(x) = 4x³ - 3x at u = 0.7, x = 0.4; derivatives by central differences.
        let at = |t: f64| {
            let mut jet = [0.0; 3];
            for_each_basis(10.0, t, 4, |k, basis| {
                if k == 3 {
                    jet = basis
                }
            });
            jet
        };
        let x: f64 = 0.4;
        assert!((at(7.0)[0] - 10.0 * 0.49 * (4.0 * x.powi(3) - 3.0 * x)).abs() < 1e-13);
        let h = 1e-4;
        let slope = (at(7.0 + h)[0] - at(7.0 - h)[0]) / (2.0 * h);
        let bend = (at(7.0 + h)[1] - at(7.0 - h)[1]) / (2.0 * h);
        assert!((at(7.0)[1] - slope).abs() < 1e-7 && (at(7.0)[2] - bend).abs() < 1e-7);
        assert_eq!(at(0.0)[0], 0.0);
    }

    #[test]
    fn clenshaws_sums_equal_the_basis() {
        // Oracle: the basis functions added one by one.
        let series = Series::new(300.0, vec![0.3, -0.2, 0.11, 0.07, -0.05, 0.02]);
        for count in 0..=6 {
            let series = Series::new(300.0, series.coefficients[..count].to_vec());
            for t_mm in [0.0, 1.0, 170.0, 299.0, 305.0] {
                let ([value], [slope]) = series.values_and_slopes([t_mm]);
                let jet = series.jet(t_mm);
                assert!((value - jet[0]).abs() < 1e-12 * 300.0, "{count} at {t_mm}");
                assert!((slope - jet[1]).abs() < 1e-12, "{count} at {t_mm}");
            }
        }
    }
}
