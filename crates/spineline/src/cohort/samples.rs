//! Samples of a cohort, gathered patient by patient, so that no patient has to stay in memory.

use super::workers::{Workers, results};
use super::{Clustered, PairedComparison, Seen};
use crate::evaluate::statistics::{Resampling, Summary};

/// Appends the values of a patient to a sample.
type Values = Box<dyn Fn(&Seen<'_>, &mut Vec<f64>)>;
/// The same of two samples of the same things.
type BothValues = Box<dyn Fn(&Seen<'_>, [&mut Vec<f64>; 2])>;

/// How many things a patient has.
type Number = Box<dyn Fn(&Seen<'_>) -> usize>;

/// Samples that were asked for. Every patient is shown to them in two rounds, since deviations need the means; what is kept is one mean
/// per patient and sample.
pub(super) struct Samples {
    resampling: Resampling,
    /// Whether the values are kept too, for pictures.
    keeps_values: bool,
    /// Patients that will be shown: room for their means is made at once, since room that grows by doubling is up to twice as much.
    patients: usize,
    is_first_round: bool,
    sampled: Vec<(Values, Sample)>,
    paired: Vec<(BothValues, Pairs)>,
    /// Of all pairs, after the last round.
    compared: Vec<PairedComparison>,
    averaged: Vec<(Values, Vec<f64>)>,
    counted: Vec<(Number, usize)>,
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

impl Samples {
    /// Rounds through all patients.
    pub const ROUNDS: usize = 2;
    /// Samples of one piece of work: so many that drawing the patients is a small part of it.
    const RESAMPLED_TOGETHER: usize = 16;

    pub fn new(resampling: Resampling, keeps_values: bool, patients: usize) -> Self {
        Self {
            resampling,
            keeps_values,
            patients,
            is_first_round: true,
            sampled: Vec::new(),
            paired: Vec::new(),
            compared: Vec::new(),
            averaged: Vec::new(),
            counted: Vec::new(),
        }
    }

    /// Which patients a resample draws.
    pub const fn resampling(&self) -> &Resampling {
        &self.resampling
    }

    /// Asks for a sample.
    pub fn sample(&mut self, of: impl Fn(&Seen<'_>, &mut Vec<f64>) + 'static) -> Sampled {
        let means = Vec::with_capacity(self.patients);
        self.sampled.push((Box::new(of), Sample { means, ..Sample::default() }));
        Sampled(self.sampled.len() - 1)
    }

    /// Asks for the comparison of two.
    pub fn pair(&mut self, of: impl Fn(&Seen<'_>, [&mut Vec<f64>; 2]) + 'static) -> Paired {
        let differences = Vec::with_capacity(self.patients);
        self.paired.push((Box::new(of), Pairs { differences, ..Pairs::default() }));
        Paired(self.paired.len() - 1)
    }

    /// Asks for one mean per patient.
    pub fn average(&mut self, of: impl Fn(&Seen<'_>, &mut Vec<f64>) + 'static) -> Averaged {
        self.averaged.push((Box::new(of), Vec::with_capacity(self.patients)));
        Averaged(self.averaged.len() - 1)
    }

    /// Asks for a number of things.
    pub fn count(&mut self, of: impl Fn(&Seen<'_>) -> usize + 'static) -> Counted {
        self.counted.push((Box::new(of), 0));
        Counted(self.counted.len() - 1)
    }

    /// Shows a patient to all of them.
    pub fn add(&mut self, seen: &Seen<'_>) {
        let (mut values, mut others) = (Vec::new(), Vec::new());
        for (of, sample) in &mut self.sampled {
            values.clear();
            of(seen, &mut values);
            sample.add(&values, self.keeps_values);
        }
        for (of, pairs) in &mut self.paired {
            values.clear();
            others.clear();
            of(seen, [&mut values, &mut others]);
            pairs.add(&values, &others);
        }
        if self.is_first_round {
            for (of, means) in &mut self.averaged {
                values.clear();
                of(seen, &mut values);
                means.push(Summary::of(&values).mean);
            }
            for (of, count) in &mut self.counted {
                *count += of(seen);
            }
        }
    }

    /// After the last patient of a round.
    pub fn end_round(&mut self, workers: &dyn Workers) {
        self.sampled.iter_mut().for_each(|(_, sample)| sample.pooled.end_round());
        self.paired.iter_mut().for_each(|(_, pairs)| pairs.pooled.end_round());
        if self.is_first_round {
            self.resample(workers);
        } else {
            self.compare(workers);
        }
        self.is_first_round = false;
    }

    /// Resamples the patients of all samples.
    fn resample(&mut self, workers: &dyn Workers) {
        let means = self.sampled.iter().map(|(_, sample)| &sample.means[..]);
        let differences = self.paired.iter().map(|(_, pairs)| &pairs.differences[..]);
        let all: Vec<&[f64]> = means.chain(differences).collect();
        // Samples of as many patients draw the same ones, so they stand together.
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by_key(|&place| all[place].len());
        let pieces: Vec<&[usize]> = order.chunks(Self::RESAMPLED_TOGETHER).collect();
        let found = results(workers, pieces.len(), |piece| {
            let samples: Vec<&[f64]> = pieces[piece].iter().map(|&place| all[place]).collect();
            self.resampling.intervals(&samples)
        });
        let mut intervals = vec![None; all.len()];
        for (&place, interval) in order.iter().zip(found.into_iter().flatten()) {
            intervals[place] = interval;
        }
        let (of_samples, of_pairs) = intervals.split_at(self.sampled.len());
        for ((_, sample), found) in self.sampled.iter_mut().zip(of_samples) {
            sample.bootstrap = *found;
        }
        for ((_, pairs), found) in self.paired.iter_mut().zip(of_pairs) {
            pairs.bootstrap = *found;
        }
    }

    /// Tests all pairs.
    fn compare(&mut self, workers: &dyn Workers) {
        let pairs: Vec<&Pairs> = self.paired.iter().map(|(_, pairs)| pairs).collect();
        let seed = self.resampling.seed();
        self.compared = results(workers, pairs.len(), |place| {
            let Pairs { pooled, differences, bootstrap } = pairs[place];
            PairedComparison::of_differences(pooled.summary(), differences, *bootstrap, seed)
        });
    }

    /// The statistics of a sample, after the last round.
    pub fn clustered(&mut self, Sampled(place): Sampled) -> Clustered {
        let Sample { pooled, means, bootstrap, values } =
            std::mem::take(&mut self.sampled[place].1);
        Clustered { values, pooled: pooled.summary(), patients: Summary::of(&means), bootstrap }
    }

    /// The tests of two samples, after the last round.
    pub fn comparison(&self, Paired(place): Paired) -> PairedComparison {
        self.compared[place]
    }

    /// One mean per patient; NaN for one without a value.
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
    /// Of every patient with a value.
    means: Vec<f64>,
    bootstrap: Option<[f64; 2]>,
    values: Vec<f64>,
}

impl Sample {
    fn add(&mut self, values: &[f64], keeps_values: bool) {
        if self.pooled.is_first_round() && !values.is_empty() {
            self.means.push(Summary::of(values).mean);
            if keeps_values {
                self.values.extend_from_slice(values);
            }
        }
        values.iter().for_each(|&value| self.pooled.add(value));
    }
}

#[derive(Default)]
struct Pairs {
    /// Of all differences.
    pooled: Pooled,
    /// Of the means of every patient with a pair.
    differences: Vec<f64>,
    bootstrap: Option<[f64; 2]>,
}

impl Pairs {
    fn add(&mut self, a: &[f64], b: &[f64]) {
        if self.pooled.is_first_round() && !a.is_empty() {
            self.differences.push(Summary::of(a).mean - Summary::of(b).mean);
        }
        a.iter().zip(b).for_each(|(a, b)| self.pooled.add(a - b));
    }
}

/// What [`Summary::of`] gives for values that come twice in one order, to the bit.
#[derive(Default)]
struct Pooled {
    n: usize,
    sum: f64,
    /// Known after the first round.
    mean: Option<f64>,
    squares: f64,
}

impl Pooled {
    const fn is_first_round(&self) -> bool {
        self.mean.is_none()
    }

    fn add(&mut self, value: f64) {
        if let Some(mean) = self.mean {
            self.squares += (value - mean).powi(2);
        } else {
            self.n += 1;
            self.sum += value;
        }
    }

    fn end_round(&mut self) {
        self.mean.get_or_insert(self.sum / self.n as f64);
    }

    fn summary(&self) -> Summary {
        let n = self.n;
        let sd = if n > 1 { (self.squares / (n - 1) as f64).sqrt() } else { f64::NAN };
        Summary { n, mean: self.mean.unwrap_or(f64::NAN), sd }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_rounds_give_the_summary_of_all_values_to_the_bit() {
        for n in [0, 1, 2, 1000] {
            let values: Vec<f64> = (0..n).map(|i| (f64::from(i) * 0.7).sin() + 3.0).collect();
            let mut pooled = Pooled::default();
            for _ in 0..Samples::ROUNDS {
                values.iter().for_each(|&value| pooled.add(value));
                pooled.end_round();
            }
            let (found, whole) = (pooled.summary(), Summary::of(&values));
            assert_eq!(found.n, whole.n);
            let bits = |summary: Summary| [summary.mean, summary.sd].map(f64::to_bits);
            assert!(n < 2 || bits(found) == bits(whole), "{found:?} and {whole:?}");
            assert_eq!(found.sd.is_nan(), whole.sd.is_nan());
        }
    }
}
