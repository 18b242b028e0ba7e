//! Samples of a cohort, gathered patient by patient, so that no patient has to stay in memory.

use super::rows::CohortRows;
use super::workers::{Workers, results};
use super::{Clustered, PairedComparison, Seen};
use crate::evaluate::statistics::{Pooled, Resampling, Summary};

/// Appends the values of a patient to a sample.
type Values = Box<dyn Fn(&Seen<'_>, &mut Vec<f64>)>;
/// The same of two samples of the same things.
type BothValues = Box<dyn Fn(&Seen<'_>, [&mut Vec<f64>; 2])>;

/// How many things a patient has.
type Number = Box<dyn Fn(&Seen<'_>) -> usize>;

/// Samples that were asked for. Every patient is shown to them once. One mean per patient and sample is set aside, and read again a few
/// samples at a time.
pub(super) struct Samples {
    resampling: Resampling,
    kept: Kept,
    patients: usize,
    sampled: Vec<(Values, Sample)>,
    paired: Vec<(BothValues, Pairs)>,
    averaged: Vec<(Values, Vec<f64>)>,
    counted: Vec<(Number, usize)>,
    /// Means of the last patient, one per sample and pair.
    row: Vec<f64>,
}

/// What a cohort keeps of its patients, beside statistics.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kept {
    /// Whether all values of samples are kept, for pictures.
    pub values: bool,
    /// Of so many first patients what is listed: own means, doubted films, films without a result.
    pub listed: usize,
}

/// A sample that was asked for.
#[derive(Clone, Copy)]
pub(super) struct Sampled(usize);
/// Two samples of the same things.
#[derive(Clone, Copy)]
pub(super) struct Paired(usize);
/// One mean per patient.
#[derive(Clone, Copy)]
pub(super) struct Averaged(usize);
/// A number of things.
#[derive(Clone, Copy)]
pub(super) struct Counted(usize);

/// In the row of a patient without a value of a sample. No computation gives these bits.
const NO_VALUE: u64 = u64::MAX;

impl Samples {
    /// Samples of one piece of work: so many that drawing the patients is a small part of it.
    const RESAMPLED_TOGETHER: usize = 16;
    /// Means that are in memory at a time: 16 MB of them, but those of one sample at least.
    const LOADED: usize = 2 << 20;
    /// The samples that are in memory make at least so many pieces of work, for the threads of the workers.
    const PIECES: usize = 4;

    pub fn new(resampling: Resampling, kept: Kept) -> Self {
        Self {
            resampling,
            kept,
            patients: 0,
            sampled: Vec::new(),
            paired: Vec::new(),
            averaged: Vec::new(),
            counted: Vec::new(),
            row: Vec::new(),
        }
    }

    /// Which patients a resample draws.
    pub const fn resampling(&self) -> &Resampling {
        &self.resampling
    }

    /// Asks for a sample.
    pub fn sample(&mut self, of: impl Fn(&Seen<'_>, &mut Vec<f64>) + 'static) -> Sampled {
        self.sampled.push((Box::new(of), Sample::default()));
        Sampled(self.sampled.len() - 1)
    }

    /// Asks for the comparison of two.
    pub fn pair(&mut self, of: impl Fn(&Seen<'_>, [&mut Vec<f64>; 2]) + 'static) -> Paired {
        self.paired.push((Box::new(of), Pairs::default()));
        Paired(self.paired.len() - 1)
    }

    /// Asks for one mean per patient.
    pub fn average(&mut self, of: impl Fn(&Seen<'_>, &mut Vec<f64>) + 'static) -> Averaged {
        self.averaged.push((Box::new(of), Vec::new()));
        Averaged(self.averaged.len() - 1)
    }

    /// Asks for a number of things.
    pub fn count(&mut self, of: impl Fn(&Seen<'_>) -> usize + 'static) -> Counted {
        self.counted.push((Box::new(of), 0));
        Counted(self.counted.len() - 1)
    }

    /// Shows a patient to all of them; gives its row of means.
    pub fn add(&mut self, seen: &Seen<'_>) -> &[f64] {
        let (mut values, mut others) = (Vec::new(), Vec::new());
        self.row.clear();
        for (of, sample) in &mut self.sampled {
            values.clear();
            of(seen, &mut values);
            let own = Summary::of(&values);
            sample.pooled.add(own);
            self.row.push(if own.n > 0 { own.mean } else { f64::from_bits(NO_VALUE) });
            if self.kept.values {
                sample.values.extend_from_slice(&values);
            }
        }
        for (of, pairs) in &mut self.paired {
            values.clear();
            others.clear();
            of(seen, [&mut values, &mut others]);
            let [first, second] = [&values, &others].map(|values| Summary::of(values));
            let difference = first.mean - second.mean;
            self.row.push(if first.n > 0 { difference } else { f64::from_bits(NO_VALUE) });
            values.iter_mut().zip(&others).for_each(|(a, b)| *a -= b);
            pairs.pooled.add(Summary::of(&values));
        }
        for (of, means) in self.averaged.iter_mut().filter(|_| self.patients < self.kept.listed) {
            values.clear();
            of(seen, &mut values);
            means.push(Summary::of(&values).mean);
        }
        for (of, count) in &mut self.counted {
            *count += of(seen);
        }
        self.patients += 1;
        &self.row
    }

    /// After the last patient: makes the statistics of all samples from the rows of the patients.
    pub fn end<Error>(
        &mut self,
        rows: &mut impl CohortRows<Error>,
        workers: &dyn Workers,
    ) -> Result<(), Error> {
        let numbers = self.sampled.len() + self.paired.len();
        let mut counts = vec![0; numbers];
        rows.each(numbers, &mut |row| {
            for (count, value) in counts.iter_mut().zip(row) {
                *count += usize::from(value.to_bits() != NO_VALUE);
            }
        })?;
        // Samples of as many patients draw the same ones, so they stand together.
        let mut order: Vec<usize> = (0..numbers).collect();
        order.sort_by_key(|&place| counts[place]);
        let at_once = (Self::LOADED / self.patients.max(1)).max(1);
        for places in order.chunks(at_once) {
            let mut means: Vec<Vec<f64>> =
                places.iter().map(|&place| Vec::with_capacity(counts[place])).collect();
            rows.each(numbers, &mut |row| {
                for (means, &place) in means.iter_mut().zip(places) {
                    means.extend(Some(row[place]).filter(|mean| mean.to_bits() != NO_VALUE));
                }
            })?;
            self.conclude(places, &means, workers);
        }
        Ok(())
    }

    /// Makes the statistics of some samples from one mean per patient.
    fn conclude(&mut self, places: &[usize], means: &[Vec<f64>], workers: &dyn Workers) {
        let intervals = self.intervals(means, workers);
        // Pairs stand behind samples in a row.
        let pair = |&place: &usize| place.checked_sub(self.sampled.len());
        let pairs: Vec<Option<usize>> = places.iter().map(pair).collect();
        let pooled = |pair: usize| self.paired[pair].1.pooled.summary();
        let pooled: Vec<Option<Summary>> = pairs.iter().map(|pair| pair.map(pooled)).collect();
        let seed = self.resampling.seed();
        let compared = results(workers, places.len(), |i| {
            let (means, interval) = (&means[i], intervals[i]);
            pooled[i].map(|all| PairedComparison::of_differences(all, means, interval, seed))
        });
        for (i, compared) in compared.into_iter().enumerate() {
            match pairs[i] {
                Some(pair) => self.paired[pair].1.compared = compared,
                None => {
                    let concluded = (Summary::of(&means[i]), intervals[i]);
                    self.sampled[places[i]].1.concluded = Some(concluded);
                }
            }
        }
    }

    /// Resamples the patients of some samples.
    fn intervals(&self, means: &[Vec<f64>], workers: &dyn Workers) -> Vec<Option<[f64; 2]>> {
        let size = means.len().div_ceil(Self::PIECES).min(Self::RESAMPLED_TOGETHER);
        let pieces: Vec<&[Vec<f64>]> = means.chunks(size).collect();
        let resampling = &self.resampling;
        let found = results(workers, pieces.len(), |piece| {
            let samples: Vec<&[f64]> = pieces[piece].iter().map(Vec::as_slice).collect();
            resampling.intervals(&samples)
        });
        found.concat()
    }

    /// The statistics of a sample, at the end.
    pub fn clustered(&mut self, Sampled(place): Sampled) -> Clustered {
        let Sample { pooled, concluded, values } = std::mem::take(&mut self.sampled[place].1);
        let (patients, bootstrap) = concluded.expect("all samples were concluded");
        Clustered { values, pooled: pooled.summary(), patients, bootstrap }
    }

    /// The tests of two samples, at the end.
    pub fn comparison(&self, Paired(place): Paired) -> PairedComparison {
        self.paired[place].1.compared.expect("all samples were concluded")
    }

    /// One mean per patient, of those whose means are kept; NaN for one without a value.
    pub fn averages(&mut self, Averaged(place): Averaged) -> Vec<f64> {
        std::mem::take(&mut self.averaged[place].1)
    }

    /// How many things there are.
    pub fn number(&self, Counted(place): Counted) -> usize {
        self.counted[place].1
    }
}

#[derive(Default)]
struct Sample {
    pooled: Pooled,
    /// Of one mean per patient, and the interval of their mean; known at the end.
    concluded: Option<(Summary, Option<[f64; 2]>)>,
    values: Vec<f64>,
}

#[derive(Default)]
struct Pairs {
    /// Of all differences.
    pooled: Pooled,
    /// Known at the end.
    compared: Option<PairedComparison>,
}
