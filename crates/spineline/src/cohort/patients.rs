//! Statistics over the patients of a cohort: loops over all of them, one per sample.

use super::others::{Others, Seen};
use super::workers::{Workers, results};
use super::{CohortPatient, PairedComparison};
use crate::evaluate::statistics::{Pooled, Resampling, Summary};

/// Statistics of a sample that belongs to patients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clustered {
    /// Of all values, as if they were independent.
    pub pooled: Summary,
    /// Of one mean per patient.
    pub patients: Summary,
    /// 95 % interval of the mean by resampling patients.
    pub bootstrap: Option<[f64; 2]>,
}

impl Clustered {
    /// From one summary per patient; patients without values do not count.
    pub(super) fn of(by_patient: &[Summary], resampling: &Resampling) -> Self {
        let with_values = by_patient.iter().filter(|summary| summary.n > 0);
        let means: Vec<f64> = with_values.map(|summary| summary.mean).collect();
        Self {
            pooled: Summary::pooled(by_patient),
            patients: Summary::of(&means),
            bootstrap: resampling.interval(&means),
        }
    }
}

/// The patients that count, with predictions of each from the others.
pub(super) struct Patients<'a> {
    /// `None` for one that does not count.
    seen: Vec<Option<Seen<'a>>>,
    resampling: Resampling,
    workers: &'a dyn Workers,
}

struct Sample {
    /// Of all values.
    pooled: Summary,
    /// One mean per patient with a value.
    means: Vec<f64>,
}

impl<'a> Patients<'a> {
    /// Samples that are resampled together: drawing the patients is then a small part of the work.
    const RESAMPLED_TOGETHER: std::ops::RangeInclusive<usize> = 6..=16;
    /// Pieces of work in which the samples of a family are resampled, for the threads of the workers.
    const PIECES: usize = 4;

    /// Those that count of a cohort.
    pub fn new(
        all: &'a [CohortPatient],
        resampling: Resampling,
        workers: &'a dyn Workers,
        counts: fn(&CohortPatient) -> bool,
    ) -> Self {
        let others = Others::of(all, counts);
        let seen = results(workers, all.len(), |place| {
            counts(&all[place]).then(|| others.see(&all[place], place))
        });
        Self { seen, resampling, workers }
    }

    fn counted(&self) -> impl Iterator<Item = &Seen<'a>> {
        self.seen.iter().flatten()
    }

    /// Sum of a count over the patients.
    pub fn count(&self, of: impl Fn(&Seen<'_>) -> usize) -> usize {
        self.counted().map(of).sum()
    }

    /// All values, patient by patient.
    pub fn values(&self, of: impl Fn(&Seen<'_>, &mut Vec<f64>)) -> Vec<f64> {
        let mut values = Vec::new();
        self.counted().for_each(|seen| of(seen, &mut values));
        values.shrink_to_fit();
        values
    }

    /// One mean per patient of the cohort; NaN for one without a value, and for one that does not count.
    pub fn means(&self, of: impl Fn(&Seen<'_>, &mut Vec<f64>)) -> Vec<f64> {
        let mut values = Vec::new();
        let mean = |seen: &Option<Seen<'_>>| {
            values.clear();
            if let Some(seen) = seen {
                of(seen, &mut values);
            }
            Summary::of(&values).mean
        };
        self.seen.iter().map(mean).collect()
    }

    /// The statistics of a family of samples, one per key. `of` appends the values of a patient.
    pub fn clustered<Key: Sync>(
        &self,
        keys: &[Key],
        of: impl Fn(&Seen<'_>, &Key, &mut Vec<f64>) + Sync,
    ) -> Vec<Clustered> {
        let samples = results(self.workers, keys.len(), |place| {
            let mut values = Vec::new();
            self.sample(|seen| {
                values.clear();
                of(seen, &keys[place], &mut values);
                let own = Summary::of(&values);
                (own, own.mean)
            })
        });
        let intervals = self.intervals(&samples);
        let statistics = samples.iter().zip(intervals).map(|(sample, bootstrap)| Clustered {
            pooled: sample.pooled,
            patients: Summary::of(&sample.means),
            bootstrap,
        });
        statistics.collect()
    }

    /// The tests of a family of pairs of samples, one per key. `of` appends the values of a patient to both.
    pub fn compared<Key: Sync>(
        &self,
        keys: &[Key],
        of: impl Fn(&Seen<'_>, &Key, [&mut Vec<f64>; 2]) + Sync,
    ) -> Vec<PairedComparison> {
        let samples = results(self.workers, keys.len(), |place| {
            let (mut first, mut second) = (Vec::new(), Vec::new());
            self.sample(|seen| {
                first.clear();
                second.clear();
                of(seen, &keys[place], [&mut first, &mut second]);
                let difference = Summary::of(&first).mean - Summary::of(&second).mean;
                first.iter_mut().zip(&second).for_each(|(a, b)| *a -= b);
                (Summary::of(&first), difference)
            })
        });
        let intervals = self.intervals(&samples);
        results(self.workers, keys.len(), |place| {
            let Sample { pooled, means } = &samples[place];
            let seed = self.resampling.seed();
            PairedComparison::of_differences(*pooled, means, intervals[place], seed)
        })
    }

    /// A sample from each patient: the summary and the mean of its values.
    fn sample(&self, of: impl FnMut(&Seen<'_>) -> (Summary, f64)) -> Sample {
        let (mut pooled, mut means) = (Pooled::default(), Vec::new());
        for (own, mean) in self.counted().map(of) {
            if own.n > 0 {
                pooled.add(own);
                means.push(mean);
            }
        }
        Sample { pooled: pooled.summary(), means }
    }

    /// 95 % intervals of the means of samples by resampling patients.
    fn intervals(&self, samples: &[Sample]) -> Vec<Option<[f64; 2]>> {
        // Samples of as many patients draw the same ones, so they stand together.
        let mut order: Vec<usize> = (0..samples.len()).collect();
        order.sort_by_key(|&place| samples[place].means.len());
        let (least, most) = Self::RESAMPLED_TOGETHER.into_inner();
        let size = samples.len().div_ceil(Self::PIECES).clamp(least, most);
        let pieces: Vec<&[usize]> = order.chunks(size).collect();
        let found = results(self.workers, pieces.len(), |piece| {
            let means: Vec<&[f64]> =
                pieces[piece].iter().map(|&place| &samples[place].means[..]).collect();
            self.resampling.intervals(&means)
        });
        let mut intervals = vec![None; samples.len()];
        for (place, interval) in order.into_iter().zip(found.concat()) {
            intervals[place] = interval;
        }
        intervals
    }
}
