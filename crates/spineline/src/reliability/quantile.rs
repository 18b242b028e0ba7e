//! Quantiles of F, chi-squared and Student's t, by bisection on their tails.
//!
//! The tails are statrs's. Its own quantile of F is a Newton iteration without a limit, and its upper tail of F a
//! difference from one, which is useless where few degrees of freedom make the quantile large.

use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use statrs::function::beta::checked_beta_reg;

/// 97.5 % quantile of F; `None` where it cannot be written as a number.
pub(super) fn f_975(freedom_1: f64, freedom_2: f64) -> Option<f64> {
    if !(freedom_1 > 0.0 && freedom_2 > 0.0) {
        return None;
    }
    root(|x| {
        let part = freedom_2 / (freedom_2 + freedom_1 * x);
        checked_beta_reg(0.5 * freedom_2, 0.5 * freedom_1, part).is_ok_and(|tail| tail > 0.025)
    })
}

/// 2.5 % and 97.5 % quantile of chi-squared.
pub(super) fn chi_squared_interval(freedom: f64) -> Option<[f64; 2]> {
    let distribution = ChiSquared::new(freedom).ok()?;
    Some([positive(&distribution, 0.975)?, positive(&distribution, 0.025)?])
}

/// 97.5 % quantile of Student's t.
pub(super) fn t_975(freedom: f64) -> Option<f64> {
    positive(&StudentsT::new(0.0, 1.0, freedom).ok()?, 0.025)
}

/// Where the upper tail of a distribution comes down to `tail`, on the positive axis.
fn positive(distribution: &impl ContinuousCDF<f64, f64>, tail: f64) -> Option<f64> {
    // Either tail is exact where it is small.
    root(|x| if tail < 0.5 { distribution.sf(x) > tail } else { distribution.cdf(x) < 1.0 - tail })
}

/// Where something ceases to be true on the positive axis; `None` where it does not between e^-690 and e^690.
fn root(below: impl Fn(f64) -> bool) -> Option<f64> {
    let (mut low, mut high) = (-690.0_f64, 690.0_f64);
    if !below(low.exp()) || below(high.exp()) {
        return None;
    }
    // Until the two are neighbours in double precision.
    for _ in 0..70 {
        let middle = 0.5 * (low + high);
        if below(middle.exp()) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some((0.5 * (low + high)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_have_their_closed_forms() {
        let near = |found: Option<f64>, right: f64| {
            let found = found.expect("a quantile");
            assert!((found - right).abs() < 1e-12 * right, "{found} {right}");
        };
        // F with 2 and 2 degrees: p / (1 - p). Chi-squared with 2: -2 ln(1 - p). Student's t with 1: tan(π(p - 1/2)).
        near(f_975(2.0, 2.0), 39.0);
        let [low, high] = chi_squared_interval(2.0).expect("a quantile");
        near(Some(low), -2.0 * 0.975_f64.ln());
        near(Some(high), -2.0 * 0.025_f64.ln());
        near(t_975(1.0), (std::f64::consts::PI * 0.475).tan());
        near(t_975(2.0), 0.95 / (2.0_f64 * 0.975 * 0.025).sqrt());
    }

    #[test]
    fn a_quantile_that_is_not_a_number_is_none() {
        assert_eq!(f_975(3.0, 1e-4), None);
        assert_eq!(f_975(0.0, 3.0), None);
        assert_eq!(f_975(3.0, f64::NAN), None);
    }
}
