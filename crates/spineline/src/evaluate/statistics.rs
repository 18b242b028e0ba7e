//! Statistics of a cohort: the paper's, which pool vertebrae, and beside them statistics that respect patients.
//!
//! Vertebrae of one patient are not independent. A paired t-test over all vertebrae of all patients is printed because
//! the paper printed it; use the patient-level test and the cluster bootstrap.

use rand::RngExt;
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::number::NORMAL_975;

/// Mean and standard deviation of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Size.
    pub n: usize,
    /// Mean; NaN for an empty sample.
    pub mean: f64,
    /// Standard deviation with n - 1; NaN for fewer than two values.
    pub sd: f64,
}

impl Summary {
    /// Of a sample.
    ///
    /// ```
    /// let summary = spineline::evaluate::statistics::Summary::of(&[1.0, 2.0, 3.0, 4.0]);
    /// assert_eq!((summary.n, summary.mean), (4, 2.5));
    /// assert!((summary.sd - (5.0_f64 / 3.0).sqrt()).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn of(sample: &[f64]) -> Self {
        let n = sample.len();
        let mean = sample.iter().sum::<f64>() / n as f64;
        let squares: f64 = sample.iter().map(|x| (x - mean).powi(2)).sum();
        let sd = if n > 1 { (squares / (n - 1) as f64).sqrt() } else { f64::NAN };
        Self { n, mean, sd }
    }

    /// Of all values of several samples.
    ///
    /// ```
    /// use spineline::evaluate::statistics::Summary;
    ///
    /// let parts = [Summary::of(&[1.0, 2.0]), Summary::of(&[6.0]), Summary::of(&[])];
    /// let all = Summary::of(&[1.0, 2.0, 6.0]);
    /// assert_eq!(Summary::pooled(&parts).n, 3);
    /// assert!((Summary::pooled(&parts).mean - all.mean).abs() < 1e-15);
    /// assert!((Summary::pooled(&parts).sd - all.sd).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn pooled(samples: &[Self]) -> Self {
        let mut pooled = Pooled::default();
        samples.iter().for_each(|&sample| pooled.add(sample));
        pooled.summary()
    }

    /// Whether there are two values that differ by more than rounding.
    pub(crate) fn has_spread(&self) -> bool {
        self.n > 1 && self.sd > 1e-9 * self.mean.abs()
    }

    /// Normal-theory 95 % interval of the mean, as if all values were independent.
    #[must_use]
    pub fn normal_interval(&self) -> [f64; 2] {
        let half = NORMAL_975 * self.sd / (self.n as f64).sqrt();
        [self.mean - half, self.mean + half]
    }
}

/// The summary of all values of samples that come one after the other, without keeping them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pooled {
    n: usize,
    mean: f64,
    /// Sum of squares about the mean.
    squares: f64,
}

impl Pooled {
    pub fn add(&mut self, sample: Summary) {
        if sample.n == 0 {
            return;
        }
        let within = if sample.n > 1 { (sample.n - 1) as f64 * sample.sd.powi(2) } else { 0.0 };
        let [before, added] = [self.n, sample.n].map(|n| n as f64);
        self.n += sample.n;
        let (off, part) = (sample.mean - self.mean, added / self.n as f64);
        self.mean += off * part;
        self.squares += within + off.powi(2) * before * part;
    }

    pub fn summary(&self) -> Summary {
        let n = self.n;
        let sd = if n > 1 { (self.squares / (n - 1) as f64).sqrt() } else { f64::NAN };
        Summary { n, mean: if n > 0 { self.mean } else { f64::NAN }, sd }
    }
}

/// A paired t-test of `a - b`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PairedT {
    /// Pairs.
    pub n: usize,
    /// Mean of the differences.
    #[serde(skip)]
    pub mean_difference: f64,
    /// t statistic on n - 1 degrees of freedom.
    pub t: f64,
    /// Probability of so large a |t| if the means are equal.
    pub p_two_sided: f64,
    /// Probability of so low a t if the means are equal: small where `a` is below `b`.
    #[serde(skip)]
    pub p_less: f64,
}

/// Paired t-test; `None` for samples of unequal length, fewer than two pairs, or differences without any spread.
#[must_use]
pub fn paired_t(a: &[f64], b: &[f64]) -> Option<PairedT> {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    if a.len() == b.len() { PairedT::of_differences(Summary::of(&differences)) } else { None }
}

impl PairedT {
    /// From the summary of the differences; `None` for fewer than two, or without any spread.
    pub(crate) fn of_differences(summary: Summary) -> Option<Self> {
        if !summary.has_spread() {
            return None;
        }
        let freedom = (summary.n - 1) as f64;
        let t = summary.mean / (summary.sd / (summary.n as f64).sqrt());
        let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
        Some(Self {
            n: summary.n,
            mean_difference: summary.mean,
            t,
            p_two_sided: 2.0 * student.sf(t.abs()),
            p_less: student.cdf(t),
        })
    }
}

/// Quartiles and whiskers of a box chart: whiskers end at the last value within 1.5 interquartile ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxSummary {
    /// First quartile, median, third quartile.
    pub quartiles: [f64; 3],
    /// Lower and upper whisker.
    pub whiskers: [f64; 2],
    /// Values beyond the whiskers.
    pub outliers: Vec<f64>,
}

/// Box chart of a sample; `None` for an empty one.
#[must_use]
pub fn box_summary(sample: &[f64]) -> Option<BoxSummary> {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let quartiles = [0.25, 0.5, 0.75].map(|q| quantile(&sorted, q));
    let reach = 1.5 * (quartiles[2] - quartiles[0]);
    let inside = |x: &&f64| (quartiles[0] - reach..=quartiles[2] + reach).contains(*x);
    let low = *sorted.iter().find(inside)?;
    let high = *sorted.iter().rev().find(inside)?;
    let outliers = sorted.iter().copied().filter(|x| !(low..=high).contains(x)).collect();
    // A quartile between two values may lie beyond the last value within reach: the whisker then ends at the box.
    let whiskers = [low.min(quartiles[0]), high.max(quartiles[2])];
    Some(BoxSummary { quartiles, whiskers, outliers })
}

/// Quantile of a sorted sample by linear interpolation between order statistics (Hyndman and Fan's type 7).
#[must_use]
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = q * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// The ends of the middle 95 %.
fn central_95(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    [0.025, 0.975].map(|part| quantile(&values, part))
}

/// Numbers in an order that their values give. The negatives of numbers have the negatives in the same order, and so the mirrored interval.
pub(super) fn ranked(numbers: &[f64]) -> Vec<f64> {
    let mut ranked = numbers.to_vec();
    ranked.sort_by(f64::total_cmp);
    if ranked.iter().sum::<f64>() < 0.0 {
        ranked.reverse();
    }
    ranked
}

/// Percentile intervals by resampling whole clusters (patients) with a stated seed.
///
/// Every resample draws as many clusters as there are, with replacement, and takes the mean of the cluster means, so
/// that a patient counts once however many values there are. It draws ranks of the cluster means, so that the order of the clusters does not
/// change an interval. The ranks are the same for all samples of as many clusters. `None` for fewer than [`Resampling::FEWEST`] clusters.
#[derive(Debug, Clone, Copy)]
pub struct Resampling {
    resamples: u32,
    seed: u64,
}

impl Resampling {
    /// Resamples whose sums grow side by side, so that no addition waits for the one before.
    const AT_ONCE: usize = 8;
    /// Fewest clusters with an interval (assumption). The interval of two clusters holds the true mean in half of all samples; with fewer
    /// than six, a sign-flip test never reaches 5 %.
    pub const FEWEST: usize = 6;

    /// With a number of resamples and a seed.
    #[must_use]
    pub const fn new(resamples: u32, seed: u64) -> Self {
        Self { resamples, seed }
    }

    /// The seed.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// The interval from the means of the clusters.
    #[must_use]
    pub fn interval(&self, means: &[f64]) -> Option<[f64; 2]> {
        self.intervals(&[means]).pop().flatten()
    }

    /// The same of many samples, which are drawn together.
    #[must_use]
    pub fn intervals(&self, samples: &[&[f64]]) -> Vec<Option<[f64; 2]>> {
        let mut found = vec![None; samples.len()];
        let mut sizes: Vec<usize> = samples.iter().map(|means| means.len()).collect();
        sizes.sort_unstable();
        sizes.dedup();
        for n in sizes.into_iter().filter(|&n| n >= Self::FEWEST) {
            let alike: Vec<usize> = (0..samples.len()).filter(|&i| samples[i].len() == n).collect();
            let means: Vec<Vec<f64>> = alike.iter().map(|&i| ranked(samples[i])).collect();
            for (&place, sums) in alike.iter().zip(self.sums(&means, n)) {
                let drawn = sums.into_iter().map(|sum| sum / n as f64);
                found[place] = Some(central_95(drawn.collect()));
            }
        }
        found
    }

    /// The interval of a ratio of two means, from a pair of numbers per cluster. `None` also for samples of unequal length, and where
    /// the mean below is zero in too many resamples.
    #[must_use]
    pub fn ratio_interval(&self, above: &[f64], below: &[f64]) -> Option<[f64; 2]> {
        let n = above.len();
        if n < Self::FEWEST || below.len() != n {
            return None;
        }
        let mut pairs: Vec<(f64, f64)> = above.iter().copied().zip(below.iter().copied()).collect();
        pairs.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1)));
        let (above, below): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let sums = self.sums(&[above, below], n);
        let ends = central_95(sums[0].iter().zip(&sums[1]).map(|(a, b)| a / b).collect());
        ends.iter().all(|end| end.is_finite()).then_some(ends)
    }

    /// By sample of `n` means: the sum of those that each resample draws.
    fn sums(&self, samples: &[Vec<f64>], n: usize) -> Vec<Vec<f64>> {
        let mut rng = ChaCha12Rng::seed_from_u64(self.seed);
        let resamples = self.resamples as usize;
        let mut all = vec![Vec::with_capacity(resamples); samples.len()];
        let mut places = vec![0; Self::AT_ONCE * n];
        for first in (0..resamples).step_by(Self::AT_ONCE) {
            let drawn = &mut places[..n * Self::AT_ONCE.min(resamples - first)];
            drawn.fill_with(|| rng.random_range(0..n) as u32);
            for (means, all) in samples.iter().zip(&mut all) {
                let mut sums = [0.0; Self::AT_ONCE];
                for i in 0..n {
                    for (sum, of_one) in sums.iter_mut().zip(drawn.chunks_exact(n)) {
                        *sum += means[of_one[i] as usize];
                    }
                }
                all.extend_from_slice(&sums[..drawn.len() / n]);
            }
        }
        all
    }
}

/// A share and its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// From 0 to 1; NaN where nothing was counted.
    pub share: f64,
    /// Independent units, such as patients.
    pub n: usize,
    /// Wilson's 95 % interval.
    pub interval: [f64; 2],
}

impl Share {
    /// The mean of one share per unit with Wilson's interval for this number of units.
    ///
    /// For units that are 0 or 1 this is Wilson's own [wilson-1927]. A unit that is a share of several things varies no more
    /// than that (its variance is at most `p (1 - p)`), so that the interval is then too wide rather than too narrow.
    ///
    /// ```
    /// let share = spineline::evaluate::statistics::Share::of_units(&[1.0, 0.0, 1.0, 1.0]);
    /// assert_eq!((share.share, share.n), (0.75, 4));
    /// ```
    #[must_use]
    pub fn of_units(shares: &[f64]) -> Self {
        Self::wilson(Summary::of(shares).mean, shares.len())
    }

    /// The share of pairs in which the value of the first sample is larger, ties counted half: 0.5 for equal distributions, 1 where
    /// every first value is larger.
    ///
    /// It is Mann and Whitney's U over its largest value. The interval uses an upper bound of its variance: the variance of a share of
    /// `n` independent units, where `n` is the size of the smaller sample [van-dantzig-1951].
    ///
    /// ```
    /// use spineline::evaluate::statistics::Share;
    /// assert_eq!(Share::of_exceeding(&[2.0, 3.0], &[1.0, 2.0]).share, 0.875);
    /// ```
    #[must_use]
    pub fn of_exceeding(first: &[f64], second: &[f64]) -> Self {
        let halves: usize = first
            .iter()
            .flat_map(|a| second.iter().map(move |b| usize::from(a > b) + usize::from(a >= b)))
            .sum();
        let share = 0.5 * halves as f64 / (first.len() * second.len()) as f64;
        Self::wilson(share, first.len().min(second.len()))
    }

    fn wilson(share: f64, n: usize) -> Self {
        const Z: f64 = NORMAL_975;
        let units = n as f64;
        let centre = (share + 0.5 * Z * Z / units) / (1.0 + Z * Z / units);
        let half = Z / (1.0 + Z * Z / units)
            * (share * (1.0 - share) / units + 0.25 * Z * Z / (units * units)).sqrt();
        Self { share, n, interval: [(centre - half).max(0.0), (centre + half).min(1.0)] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_in_parts_have_the_summary_of_all() {
        for n in [0, 1, 2, 1000] {
            let values: Vec<f64> = (0..n).map(|i| (f64::from(i) * 0.7).sin() + 3.0).collect();
            let mut pooled = Pooled::default();
            pooled.add(Summary::of(&[]));
            values.chunks(7).for_each(|part| pooled.add(Summary::of(part)));
            let (found, whole) = (pooled.summary(), Summary::of(&values));
            assert_eq!(found.n, whole.n);
            for (found, whole) in [(found.mean, whole.mean), (found.sd, whole.sd)] {
                let is_near = (found - whole).abs() < 1e-14 * whole.abs();
                assert!(is_near || (found.is_nan() && whole.is_nan()), "{found} and {whole}");
            }
        }
    }

    #[test]
    fn paired_t_equals_the_textbook_formula() {
        // Differences 1, 2, 3, 4: mean 2.5, sd 1.2910, t = 2.5 / (1.2910 / 2) = 3.8730 on 3 degrees.
        let t = paired_t(&[2.0, 4.0, 6.0, 8.0], &[1.0, 2.0, 3.0, 4.0]).expect("spread");
        assert!((t.t - 15.0_f64.sqrt()).abs() < 1e-12);
        // For 3 degrees of freedom the distribution has a closed form.
        let x = t.t / 3.0_f64.sqrt();
        let tail = 0.5 - (x / (1.0 + x * x) + x.atan()) / std::f64::consts::PI;
        assert!((t.p_two_sided - 2.0 * tail).abs() < 1e-12);
        assert!((t.p_less - (1.0 - tail)).abs() < 1e-12);
    }

    #[test]
    fn shares_have_wilson_intervals() {
        // Closed form: where nothing or all was counted, the interval ends at z² / (n + z²).
        let z2 = 1.959_963_984_540_054_f64.powi(2);
        let none = Share::of_units(&[0.0; 20]);
        assert!(none.interval[0] < 1e-12 && (none.interval[1] - z2 / (20.0 + z2)).abs() < 1e-12);
        let all = Share::of_units(&[1.0; 20]);
        assert!(all.interval[1] > 1.0 - 1e-12);
        assert!((all.interval[0] - 20.0 / (20.0 + z2)).abs() < 1e-12);
        // Both ends solve (p - s)² = z² p (1 - p) / n.
        let part = Share::of_units(&[1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        for p in part.interval {
            assert!(((p - 2.0 / 7.0).powi(2) - z2 * p * (1.0 - p) / 7.0).abs() < 1e-12);
        }
        assert!(Share::of_units(&[]).share.is_nan());
    }

    #[test]
    fn exceeding_counts_pairs_and_halves_of_ties() {
        let same = Share::of_exceeding(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]);
        assert_eq!((same.share, same.n), (0.5, 3));
        assert_eq!(Share::of_exceeding(&[4.0, 5.0], &[1.0, 2.0, 3.0]).share, 1.0);
        assert_eq!(Share::of_exceeding(&[1.0], &[1.0, 2.0, 3.0, 0.0]).share, 0.375);
    }

    #[test]
    fn the_ratio_bootstrap_is_exact_where_all_ratios_are_equal_and_covers_elsewhere() {
        let below: Vec<f64> = (1..=30).map(f64::from).collect();
        let above: Vec<f64> = below.iter().map(|b| 0.25 * b).collect();
        let few = Resampling::new(200, 3);
        assert_eq!(few.ratio_interval(&above, &below), Some([0.25, 0.25]));
        let above: Vec<f64> = (0..30).map(|i| if i % 2 == 0 { 2.0 } else { 0.0 }).collect();
        let found = Resampling::new(2000, 3).ratio_interval(&above, &[1.0; 30]);
        let [low, high] = found.expect("pairs");
        // Normal theory: 1 ± 1.96 · 1 / √30.
        assert!((low - 0.642).abs() < 0.08 && (high - 1.358).abs() < 0.08);
        assert_eq!(few.ratio_interval(&above, &below[1..]), None);
        assert_eq!(few.ratio_interval(&above, &[0.0; 30]), None);
    }

    #[test]
    fn samples_without_spread_have_no_test() {
        assert_eq!(paired_t(&[1.0, 2.0], &[0.0, 1.0]), None);
        assert_eq!(paired_t(&[1.0], &[0.0]), None);
        // All differences are 0.1, to rounding.
        assert_eq!(paired_t(&[0.3, 0.4, 0.9], &[0.2, 0.3, 0.8]), None);
        assert_eq!(box_summary(&[]), None);
    }

    #[test]
    fn the_cluster_bootstrap_covers_the_mean_and_depends_on_its_seed_only() {
        let means: Vec<f64> = (0..20).map(f64::from).collect();
        let interval = Resampling::new(2000, 7).interval(&means).expect("clusters");
        assert!(interval[0] < 9.5 && 9.5 < interval[1]);
        // Normal theory for the mean of 0..19: 9.5 ± 1.96 * 5.77 / sqrt(20), about 7.0 to 12.0.
        assert!((interval[0] - 7.0).abs() < 0.4 && (interval[1] - 12.0).abs() < 0.4);
        assert_eq!(Some(interval), Resampling::new(2000, 7).interval(&means));
        assert_eq!(Resampling::new(2000, 7).interval(&means[..Resampling::FEWEST - 1]), None);
        // Drawn together with others, a sample has the interval that it has alone.
        let turned: Vec<f64> = means.iter().map(|mean| -mean).collect();
        let resampling = Resampling::new(2001, 7);
        let together = resampling.intervals(&[&means, &means[1..], &turned, &[]]);
        let alone = |means: &[f64]| resampling.interval(means);
        assert_eq!(together[..2], [alone(&means), alone(&means[1..])]);
        assert_eq!(together[2], together[0].map(|[low, high]| [-high, -low]));
        assert_eq!(together[3], None);
    }

    #[test]
    fn a_permuted_cohort_has_identical_intervals() {
        let means: Vec<f64> = (0..14).map(|i| (f64::from(i) * 1.7).sin()).collect();
        let below: Vec<f64> = (0..14).map(|i| 2.0 + (f64::from(i) * 0.9).cos()).collect();
        let resampling = Resampling::new(2000, 1);
        let found = |order: &[usize]| {
            let [above, below] = [&means, &below]
                .map(|numbers| order.iter().map(|&place| numbers[place]).collect::<Vec<f64>>());
            (resampling.interval(&above), resampling.ratio_interval(&above, &below))
        };
        let as_given: Vec<usize> = (0..14).collect();
        let permuted: Vec<usize> = (0..14).map(|i| (5 * i + 3) % 14).collect();
        assert!(found(&as_given).0.is_some() && found(&as_given).1.is_some());
        assert_eq!(found(&permuted), found(&as_given));
    }

    #[test]
    fn box_whiskers_end_at_values() {
        let chart = box_summary(&[1.0, 2.0, 3.0, 4.0, 100.0]).expect("values");
        assert_eq!(chart.quartiles, [2.0, 3.0, 4.0]);
        assert_eq!((chart.whiskers, chart.outliers), ([1.0, 4.0], vec![100.0]));
        // The first quartile lies between an outlier and the next value.
        let chart = box_summary(&[3.0, 19.0, 20.0, 21.0]).expect("values");
        assert_eq!((chart.quartiles[0], chart.whiskers[0]), (15.0, 15.0));
        assert_eq!(chart.outliers, [3.0]);
    }
}
