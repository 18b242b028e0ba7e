use super::quantile::{chi_squared_interval, t_975};
use super::ratings::Ratings;
use super::{StatisticEstimate, Undefined};
use crate::number::NORMAL_975;

#[derive(Debug, Clone, Copy)]
pub(super) struct ErrorVariance {
    pub value: f64,
    /// Degrees of freedom.
    pub freedom: f64,
}

/// Standard error of measurement: the deviation of one rating from its subject's true value.
pub(super) fn sem(error: ErrorVariance) -> StatisticEstimate {
    let ErrorVariance { value: variance, freedom } = error;
    let interval = if variance > 0.0 {
        chi_squared_interval(freedom)
            .map(|[low, high]| [high, low].map(|chi| (variance * freedom / chi).sqrt()))
            .filter(|bounds| bounds.iter().all(|bound| bound.is_finite()))
            .ok_or(Undefined::NoInterval)
    } else {
        // All readings agree: the size of the error is unknown.
        Err(Undefined::ZeroVariance)
    };
    StatisticEstimate { value: variance.max(0.0).sqrt(), sd: None, interval }
}

/// Two readings that differ by more than this differ for another reason than error, with 95 % confidence.
pub(super) fn mdc95(sem: StatisticEstimate) -> StatisticEstimate {
    let factor = NORMAL_975 * std::f64::consts::SQRT_2;
    let interval = sem.interval.map(|bounds| bounds.map(|bound| factor * bound));
    StatisticEstimate { value: factor * sem.value, sd: None, interval }
}

/// Pearson's correlation over all pairs of raters: mean, and standard deviation where there are several.
pub(super) fn pearson(ratings: &Ratings) -> Result<StatisticEstimate, Undefined> {
    let columns: Vec<Vec<f64>> = (0..ratings.raters()).map(|j| ratings.column(j)).collect();
    let all = pairs(columns.len())
        .map(|(i, j)| correlation(&columns[i], &columns[j]))
        .collect::<Result<Vec<f64>, _>>()?;
    let count = all.len() as f64;
    let mean = all.iter().sum::<f64>() / count;
    if all.len() > 1 {
        let squares: f64 = all.iter().map(|r| (r - mean).powi(2)).sum();
        let sd = Some((squares / (count - 1.0)).sqrt());
        return Ok(StatisticEstimate { value: mean, sd, interval: Err(Undefined::DependentPairs) });
    }
    Ok(StatisticEstimate {
        value: mean,
        sd: None,
        interval: fisher_interval(mean, ratings.subjects()),
    })
}

/// Fisher's transformation.
fn fisher_interval(r: f64, n: usize) -> Result<[f64; 2], Undefined> {
    if n < 4 {
        return Err(Undefined::TooFewSubjects { n, least: 4 });
    }
    let half = NORMAL_975 / (n as f64 - 3.0).sqrt();
    let bounds = [-half, half].map(|off| (r.atanh() + off).tanh());
    if bounds.iter().all(|bound| bound.is_finite()) {
        Ok(bounds)
    } else {
        Err(Undefined::NoInterval)
    }
}

/// Two points always lie on a line, so that three are the least.
fn correlation(a: &[f64], b: &[f64]) -> Result<f64, Undefined> {
    if a.len() < 3 {
        return Err(Undefined::TooFewSubjects { n: a.len(), least: 3 });
    }
    let centred = |values: &[f64]| -> Vec<f64> {
        let off: Vec<f64> = values.iter().map(|x| x - values[0]).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        off.iter().map(|x| x - mean).collect()
    };
    let (a, b) = (centred(a), centred(b));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let scale = (dot(&a, &a) * dot(&b, &b)).sqrt();
    if scale <= 0.0 {
        return Err(Undefined::ZeroVariance);
    }
    let r = dot(&a, &b) / scale;
    if r.is_finite() { Ok(r.clamp(-1.0, 1.0)) } else { Err(Undefined::NotFinite) }
}

/// All pairs of the first `n` numbers, the smaller first.
pub(super) fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |i| (i + 1..n).map(move |j| (i, j)))
}

/// Bland and Altman's limits of agreement of two raters.
#[derive(Debug, Clone, PartialEq)]
pub struct BlandAltman {
    /// Names of the two; differences are the second minus the first.
    pub raters: [String; 2],
    /// Mean of both and difference, one per subject.
    pub points: Vec<[f64; 2]>,
    /// Mean difference.
    pub bias: f64,
    /// Standard deviation of the differences.
    pub sd: f64,
    /// Bias ∓ 1.96 standard deviations.
    pub limits: [f64; 2],
    /// 95 % interval of the bias, or why it is missing.
    pub bias_interval: Result<[f64; 2], Undefined>,
    /// 95 % intervals of the lower and the upper limit.
    pub limit_intervals: Result<[[f64; 2]; 2], Undefined>,
}

impl BlandAltman {
    /// Bias and limits of agreement by name, each with its 95 % interval where there is one.
    #[must_use]
    pub fn named_limits(&self) -> [(&'static str, f64, Option<[f64; 2]>); 3] {
        let bounds = self.limit_intervals.ok();
        [
            ("bias", self.bias, self.bias_interval.ok()),
            ("lower limit", self.limits[0], bounds.map(|bounds| bounds[0])),
            ("upper limit", self.limits[1], bounds.map(|bounds| bounds[1])),
        ]
    }
}

/// Of two columns of ratings.
///
/// The standard error of a limit is √(3 s²/n), of the bias √(s²/n), each times Student's t on n - 1 degrees
/// [bland-altman-1986]; both take the differences to be independent and normal.
pub(super) fn bland_altman(
    ratings: &Ratings,
    names: &[String],
    i: usize,
    j: usize,
) -> Result<BlandAltman, Undefined> {
    let (a, b) = (ratings.column(i), ratings.column(j));
    let n = a.len() as f64;
    let points: Vec<[f64; 2]> = a.iter().zip(&b).map(|(a, b)| [0.5 * (a + b), b - a]).collect();
    // Against the first, so that equal differences have no spread.
    let first = points[0][1];
    let mean = points.iter().map(|point| point[1] - first).sum::<f64>() / n;
    let bias = first + mean;
    let squares: f64 = points.iter().map(|point| (point[1] - first - mean).powi(2)).sum();
    let sd = (squares / (n - 1.0)).sqrt();
    let limits = [-1.0, 1.0].map(|side| bias + side * NORMAL_975 * sd);
    if !(limits.iter().all(|limit| limit.is_finite()) && points[0][0].is_finite()) {
        return Err(Undefined::NotFinite);
    }
    let half = match t_975(n - 1.0) {
        _ if sd <= 0.0 => Err(Undefined::ZeroVariance),
        Some(t) => Ok(t * sd / n.sqrt()),
        None => Err(Undefined::NoInterval),
    };
    let about = |centre: f64, half: f64| [centre - half, centre + half];
    Ok(BlandAltman {
        raters: [names[i].clone(), names[j].clone()],
        bias,
        sd,
        limits,
        bias_interval: half.map(|half| about(bias, half)),
        limit_intervals: half.map(|half| limits.map(|limit| about(limit, 3.0_f64.sqrt() * half))),
        points,
    })
}
