use super::agreement::ErrorVariance;
use super::quantile::f_975;
use super::ratings::Ratings;
use super::{StatisticEstimate, Undefined};

/// Two-way analysis of variance without replication.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MeanSquares {
    /// Subjects.
    n: f64,
    /// Raters.
    k: f64,
    /// Between subjects.
    rows: f64,
    /// Between raters.
    columns: f64,
    /// What is left.
    error: f64,
}

impl MeanSquares {
    pub(super) fn of(ratings: &Ratings) -> Result<Self, Undefined> {
        let (n, k) = (ratings.subjects() as f64, ratings.raters() as f64);
        // Against the subject's first reading and the first subject: equal readings leave exactly nothing.
        let off: Vec<Vec<f64>> =
            ratings.rows().iter().map(|row| row.iter().map(|x| x - row[0]).collect()).collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let row_offs: Vec<f64> = off.iter().map(|row| mean(row)).collect();
        let origin = ratings.rows()[0][0];
        let row_means: Vec<f64> =
            ratings.rows().iter().zip(&row_offs).map(|(row, off)| row[0] - origin + off).collect();
        let column_offs: Vec<f64> =
            (0..ratings.raters()).map(|j| off.iter().map(|row| row[j]).sum::<f64>() / n).collect();
        let (grand_off, grand) = (mean(&column_offs), mean(&row_means));
        let rows = k * row_means.iter().map(|m| (m - grand).powi(2)).sum::<f64>() / (n - 1.0);
        let columns =
            n * column_offs.iter().map(|m| (m - grand_off).powi(2)).sum::<f64>() / (k - 1.0);
        let residual = |(row, row_off): (&Vec<f64>, &f64)| -> f64 {
            row.iter().zip(&column_offs).map(|(x, c)| (x - row_off - c + grand_off).powi(2)).sum()
        };
        let error = off.iter().zip(&row_offs).map(residual).sum::<f64>() / ((n - 1.0) * (k - 1.0));
        let largest = ratings.rows().iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        // Smaller squares are the rounding of the readings.
        let rounding = (1e-14 * largest).powi(2);
        if ![rounding, k * n * (rows + columns + error)].iter().all(|x| x.is_finite()) {
            return Err(Undefined::NotFinite);
        }
        let [rows, columns, error] =
            [rows, columns, error].map(|square| if square <= rounding { 0.0 } else { square });
        Ok(Self { n, k, rows, columns, error })
    }

    /// Whether all raters agree on every subject.
    pub(super) fn is_perfect(&self) -> bool {
        self.columns <= 0.0 && self.error <= 0.0
    }

    /// Whether the variance between raters is estimated below zero: their means differ by less than the rest explains.
    pub(super) fn is_rater_variance_negative(&self) -> bool {
        self.columns < self.error
    }

    /// Variance of one rating about its subject's true value, with its degrees of freedom; with the raters' offsets
    /// [de-vet-2006], whose variance is zero where it is estimated below. Freedom after Satterthwaite.
    pub(super) fn agreement_variance(&self) -> ErrorVariance {
        if self.is_rater_variance_negative() {
            return self.consistency_variance();
        }
        let Self { n, k, columns, error, .. } = *self;
        let parts = [columns / n, (n - 1.0) * error / n];
        let value = parts[0] + parts[1];
        let spread = parts[0].powi(2) / (k - 1.0) + parts[1].powi(2) / ((k - 1.0) * (n - 1.0));
        ErrorVariance { value, freedom: value * value / spread }
    }

    /// The same without the raters' offsets.
    pub(super) fn consistency_variance(&self) -> ErrorVariance {
        ErrorVariance { value: self.error, freedom: (self.n - 1.0) * (self.k - 1.0) }
    }

    /// ICC(2,1): absolute agreement, single rater.
    pub(super) fn icc_agreement(&self) -> Result<StatisticEstimate, Undefined> {
        let Self { n, k, rows, columns, error } = *self;
        let total = rows + (k - 1.0) * error + k * (columns - error) / n;
        self.icc(total, Self::agreement_interval)
    }

    /// ICC(3,1): consistency, single rater.
    pub(super) fn icc_consistency(&self) -> Result<StatisticEstimate, Undefined> {
        self.icc(self.rows + (self.k - 1.0) * self.error, Self::consistency_interval)
    }

    /// ICC(2,k): absolute agreement, mean of the raters.
    pub(super) fn icc_average(&self) -> Result<StatisticEstimate, Undefined> {
        self.icc(self.rows + (self.columns - self.error) / self.n, Self::average_interval)
    }

    /// The coefficient with a sum of variances, and its interval.
    fn icc(
        &self,
        total: f64,
        interval: fn(&Self) -> Option<[f64; 2]>,
    ) -> Result<StatisticEstimate, Undefined> {
        let Self { k, rows, columns, error, .. } = *self;
        if rows <= 0.0 && error <= 0.0 {
            return Err(Undefined::ZeroVariance);
        }
        // Relative to its terms, so that rounding makes no denominator.
        if total <= 1e-12 * (rows + columns + k * error) {
            return Err(Undefined::VarianceNotPositive);
        }
        let interval = interval(self)
            .filter(|[low, high]| low.is_finite() && high.is_finite())
            .ok_or(Undefined::NoInterval);
        Ok(StatisticEstimate { value: (rows - error) / total, sd: None, interval })
    }

    /// [shrout-fleiss-1979]: case 3, multiplied out so that no error at all gives the point 1.
    fn consistency_interval(&self) -> Option<[f64; 2]> {
        let Self { n, k, rows, error, .. } = *self;
        let freedom = [n - 1.0, (n - 1.0) * (k - 1.0)];
        let (less, more) = (f_975(freedom[0], freedom[1])?, f_975(freedom[1], freedom[0])?);
        Some([
            (rows - less * error) / (rows + (k - 1.0) * less * error),
            (more * rows - error) / (more * rows + (k - 1.0) * error),
        ])
    }

    /// [shrout-fleiss-1979]: case 2, with Satterthwaite's degrees of freedom; multiplied by MSE², so that it may be zero.
    fn agreement_interval(&self) -> Option<[f64; 2]> {
        let Self { n, k, rows, columns, error } = *self;
        if self.is_perfect() {
            return Some([1.0, 1.0]);
        }
        let total = rows + (k - 1.0) * error + k * (columns - error) / n;
        let icc = (rows - error) / total;
        let a = k * icc * columns;
        let b = (n * (1.0 + (k - 1.0) * icc) - k * icc) * error;
        let freedom = (k - 1.0) * (n - 1.0) * (a + b).powi(2) / ((n - 1.0) * a * a + b * b);
        let (less, more) = (f_975(n - 1.0, freedom)?, f_975(freedom, n - 1.0)?);
        let within = k * columns + (k * n - k - n) * error;
        Some([
            n * (rows - less * error) / (less * within + n * rows),
            n * (more * rows - error) / (within + n * more * rows),
        ])
    }

    /// The single rater's bounds, stepped up by Spearman and Brown's formula, which turns over below -1/(k - 1).
    fn average_interval(&self) -> Option<[f64; 2]> {
        let bounds = self.agreement_interval()?;
        let steps = bounds.map(|bound| 1.0 + (self.k - 1.0) * bound);
        let rising = steps.iter().all(|step| *step > 1e-12);
        rising.then(|| [0, 1].map(|i| self.k * bounds[i] / steps[i]))
    }
}
