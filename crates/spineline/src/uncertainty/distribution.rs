//! Moments and quantiles of a stream, in memory that does not grow with it.

use tdigest::TDigest;

use crate::evaluate::statistics::quantile;

/// Values that are gathered before the digest takes them in, sorted; as long as no more came, quantiles are exact.
const BUFFER: usize = 2048;
/// Centroids of a digest: enough for quantiles that are off by less than a quarter of their sampling error (tested).
const CENTROIDS: usize = 1000;

/// The distribution of a stream of numbers.
///
/// Quantiles come from a t-digest, whose error is smallest in the tails. Values are taken in blocks of one size, so that
/// the same stream gives the same bytes, however it was computed.
///
/// # References
/// [dunning-2019]; mean and deviation by [welford-1962].
#[derive(Debug, Clone, Default)]
pub(super) struct Distribution {
    buffer: Vec<f64>,
    digest: Option<TDigest>,
    pub count: u64,
    pub mean: f64,
    squares: f64,
}

impl Distribution {
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let off = value - self.mean;
        self.mean += off / self.count as f64;
        self.squares += off * (value - self.mean);
        self.buffer.push(value);
        if self.buffer.len() == BUFFER {
            self.flush();
        }
    }

    fn flush(&mut self) {
        self.buffer.sort_by(f64::total_cmp);
        let digest = self.digest.take().unwrap_or_else(|| TDigest::new_with_size(CENTROIDS));
        self.digest = Some(digest.merge_sorted(std::mem::take(&mut self.buffer)));
    }

    /// Standard deviation; `None` for fewer than two values, which have no spread.
    pub fn sd(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.squares / (self.count - 1) as f64).sqrt())
    }

    /// The quantiles of given parts; `None` without a value.
    pub fn quantiles<const N: usize>(mut self, parts: [f64; N]) -> Option<[f64; N]> {
        if self.digest.is_none() {
            self.buffer.sort_by(f64::total_cmp);
            let is_known = !self.buffer.is_empty();
            return is_known.then(|| parts.map(|part| quantile(&self.buffer, part)));
        }
        self.flush();
        let digest = self.digest?;
        let found = parts.map(|part| digest.estimate_quantile(part));
        found.iter().all(Option::is_some).then(|| found.map(Option::unwrap_or_default))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha12Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution as _, StandardNormal};

    /// A quarter of the sampling error of a quantile.
    const LIMIT: f64 = 0.25;
    const PARTS: [f64; 5] = [0.025, 0.25, 0.5, 0.75, 0.975];

    fn summary(values: &[f64]) -> Distribution {
        let mut distribution = Distribution::default();
        values.iter().for_each(|value| distribution.add(*value));
        distribution
    }

    /// Largest error of the estimated quantiles, in places among the sorted values, as a part of their sampling error.
    fn worst(values: &[f64]) -> f64 {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let found = summary(values).quantiles(PARTS).expect("values");
        let count = values.len() as f64;
        let off = |(part, quantile): (f64, f64)| {
            let place = sorted.partition_point(|value| *value < quantile) as f64;
            (place - part * count).abs() / (part * (1.0 - part) * count).sqrt()
        };
        PARTS.into_iter().zip(found).map(off).fold(0.0, f64::max)
    }

    fn normals(count: usize) -> Vec<f64> {
        let mut rng = ChaCha12Rng::seed_from_u64(3);
        (0..count).map(|_| StandardNormal.sample(&mut rng)).collect()
    }

    #[test]
    fn quantiles_of_normal_and_skewed_samples_are_near_the_exact_ones() {
        // Oracle: sorting.
        for count in [2_000, 10_000, 50_000] {
            let normal = normals(count);
            let skewed: Vec<f64> = normal.iter().map(|z| z.exp()).collect();
            for values in [normal, skewed] {
                let off = worst(&values);
                assert!(off < LIMIT, "{count}: {off}");
            }
        }
        assert_eq!(summary(&[3.0, 1.0, 2.0]).quantiles([0.5]), Some([2.0]), "few are kept");
    }

    #[test]
    fn moments_equal_the_samples() {
        let found = summary(&[1.0, 2.0, 4.0, 9.0]);
        assert!((found.mean - 4.0).abs() < 1e-15);
        // Squares about the mean: 9 + 4 + 0 + 25 = 38.
        let sd = found.sd().expect("four values");
        assert!((sd - (38.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(found.count, 4);
        assert_eq!((summary(&[1.0]).sd(), summary(&[]).sd()), (None, None), "no spread is known");
    }

    #[test]
    fn one_value_again_and_again_has_no_spread() {
        let found = summary(&[0.3; 5000]);
        assert!(found.sd().is_some_and(|sd| sd < 1e-15));
        assert_eq!(found.quantiles(PARTS), Some([0.3; 5]));
        assert_eq!(Distribution::default().quantiles(PARTS), None);
    }

    #[test]
    fn memory_does_not_grow_with_the_stream() {
        let found = summary(&normals(200_000));
        assert!(found.buffer.capacity() <= BUFFER);
        let centroids = found.digest.as_ref().map_or(0, |digest| digest.centroids().len());
        assert!((1..=CENTROIDS).contains(&centroids), "{centroids}");
    }
}
