//! Criteria that count the parameters of a fit.

use serde::{Deserialize, Serialize};

use crate::number::or_infinite;

/// The quality of a fit, given the numbers that it took.
///
/// # Definition
/// `χ²` is the sum of squared residuals over their measurement's deviations. Errors of a model are far larger than that noise, so
/// the size of the residuals is estimated too: with `n` measured and `K` fitted numbers (multipliers less
/// the gauge's one, load components, base angles, and that size),
/// `AICc = n ln(χ²/n) + 2K + 2K(K + 1)/(n - K - 1)` and `BIC = n ln(χ²/n) + K ln n`. Only differences on the same films mean
/// anything.
///
/// # Assumption
/// Residuals count as independent. Neighbouring ones are not, so differences are too large: films that were not fitted decide first.
///
/// # References
/// [burnham-2002], sections 2.2 and 2.4; [schwarz-1978].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Criteria {
    /// Measured numbers: n. The angle of a noisy base counts in `χ²` alone, as its distance from the mean.
    pub measured: usize,
    /// Fitted numbers with the size of the residuals: K.
    pub fitted: usize,
    /// `χ²`.
    #[serde(deserialize_with = "or_infinite")]
    pub chi_squared: f64,
    /// Akaike's criterion, corrected for few data; infinite where `n ≤ K + 1`.
    #[serde(deserialize_with = "or_infinite")]
    pub aicc: f64,
    /// Schwarz's criterion.
    #[serde(deserialize_with = "or_infinite")]
    pub bic: f64,
}

impl Criteria {
    /// From a sum of squares over `measured` numbers, with `free` parameters beside the residuals' size.
    ///
    /// ```
    /// use spineline::hypothesis::Criteria;
    /// let worth = Criteria::new(100.0 * std::f64::consts::E, 100, 4);
    /// assert!((worth.bic - (100.0 + 5.0 * 100_f64.ln())).abs() < 1e-12);
    /// assert!((worth.aicc - (100.0 + 10.0 + 60.0 / 94.0)).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn new(chi_squared: f64, measured: usize, free: usize) -> Self {
        let fitted = free + 1;
        let (n, k) = (measured as f64, fitted as f64);
        let misfit = n * (chi_squared / n).ln();
        let rest = n - k - 1.0;
        let correction = if rest > 0.0 { 2.0 * k * (k + 1.0) / rest } else { f64::INFINITY };
        Self {
            measured,
            fitted,
            chi_squared,
            aicc: misfit + 2.0 * k + correction,
            bic: misfit + k * n.ln(),
        }
    }

    /// Root mean square of the residuals, in deviations of their measurement.
    #[must_use]
    pub fn residual_rms(&self) -> f64 {
        (self.chi_squared / self.measured as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn infinite_criteria_are_read_as_they_were_written() {
        // Three numbers for three parameters: AICc is infinite. Without a fit, all criteria are.
        for criteria in [Criteria::new(2.0, 3, 2), Criteria::new(f64::INFINITY, 20, 4)] {
            let text = serde_json::to_string(&criteria).expect("numbers");
            assert_eq!(serde_json::from_str::<Criteria>(&text).expect("our own text"), criteria);
        }
    }
}
