//! What a cohort must know of its patients before it can gather their samples.

use std::convert::Infallible;
use std::num::NonZeroUsize;

use super::lines::missing;
use super::others::Others;
use super::rows::CohortRows;
use super::samples::{Kept, Samples};
use super::workers::{Workers, results};
use super::{ChainCount, CohortPatient, DoubtedFilm, LineOutcomes, MissingResult};
use crate::action::LineKind;
use crate::analysis::FreeNumbers;
use crate::evaluate::statistics::{Resampling, Summary};
use crate::hypothesis::Hypothesis;

/// The patients of a cohort, which can be gone through again in the same order.
pub trait CohortSource {
    /// Why a patient cannot be read again.
    type Error;

    /// Shows every patient, at most `most` at a time.
    ///
    /// # Errors
    /// If a patient cannot be read again, or with the error of what it is shown to.
    fn each_part(
        &mut self,
        most: NonZeroUsize,
        take: &mut TakePart<'_, Self::Error>,
    ) -> Result<(), Self::Error>;
}

/// Takes some patients of a [`CohortSource`].
pub type TakePart<'a, Error> = dyn FnMut(&[CohortPatient]) -> Result<(), Error> + 'a;

/// So many patients are in memory at a time.
const PART: NonZeroUsize = NonZeroUsize::new(64).expect("it is more than zero");

impl CohortSource for &[CohortPatient] {
    type Error = Infallible;

    fn each_part(
        &mut self,
        most: NonZeroUsize,
        take: &mut TakePart<'_, Infallible>,
    ) -> Result<(), Infallible> {
        self.chunks(most.get()).try_for_each(take)
    }
}

/// What is known of the patients, and the samples that are asked for.
pub(super) struct Gathering {
    pub census: Census,
    pub samples: Samples,
    others: Others,
}

impl Gathering {
    /// Goes through the patients once.
    pub fn begin<S: CohortSource>(
        patients: &mut S,
        resampling: Resampling,
        kept: Kept,
    ) -> Result<Self, S::Error> {
        let (mut census, mut others) = (Census::listing(kept.listed), Others::default());
        patients.each_part(PART, &mut |part| {
            for patient in part {
                census.add(patient);
                others.add(patient.levels, &patient.bends);
            }
            Ok(())
        })?;
        census.end();
        others.end();
        Ok(Self { census, samples: Samples::new(resampling, kept), others })
    }

    /// Shows the patients to the samples. `rows` take what is set aside.
    pub fn go_through<S: CohortSource>(
        &mut self,
        patients: &mut S,
        rows: &mut impl CohortRows<S::Error>,
        workers: &dyn Workers,
    ) -> Result<(), S::Error> {
        let kinds = self.census.kinds();
        let mut place = 0;
        patients.each_part(PART, &mut |part| {
            let see = |i: usize| self.others.see(&part[i], place + i);
            for seen in results(workers, part.len(), see) {
                rows.add(self.samples.add(&seen))?;
                self.census.add_missing(missing(seen.patient, &kinds));
            }
            place += part.len();
            Ok(())
        })?;
        self.samples.end(rows, workers)
    }
}

/// Counts and short lists over all patients.
#[derive(Default)]
pub(super) struct Census {
    /// Patients in each list.
    listed: usize,
    pub patients: usize,
    pub synthetic: bool,
    /// By patient.
    pub segments: Vec<f64>,
    pub segment_mm: Vec<f64>,
    pub rotation_deg: Vec<Summary>,
    pub two_inflections: usize,
    /// Lines with a model of some patient.
    pub modelled: Vec<LineKind>,
    /// Every line, with the numbers that it takes from films of the first patient with a model of it.
    pub numbers: Vec<(LineKind, FreeNumbers)>,
    /// Whether some patient's lines were fitted to different data.
    pub has_different_data: bool,
    pub hypotheses: Vec<Hypothesis>,
    pub outcomes: Vec<LineOutcomes>,
    pub doubted: usize,
    pub doubted_films: Vec<DoubtedFilm>,
    pub chains: Vec<ChainCount>,
    /// Patients with a film on which a line has no result, found while the samples are gathered.
    pub with_missing: usize,
    pub missing: Vec<MissingResult>,
}

impl Census {
    fn listing(listed: usize) -> Self {
        Self { listed, ..Self::default() }
    }

    /// Every line.
    pub fn kinds(&self) -> Vec<LineKind> {
        self.numbers.iter().map(|(kind, _)| *kind).collect()
    }

    /// After the last patient.
    fn end(&mut self) {
        self.numbers.sort_by_key(|(kind, _)| *kind);
        self.hypotheses.sort();
        self.outcomes.sort_by_key(|found| found.kind);
        ChainCount::sort(&mut self.chains);
    }

    fn add(&mut self, patient: &CohortPatient) {
        self.patients += 1;
        self.synthetic |= patient.synthetic;
        self.segments.push(patient.segments as f64);
        self.segment_mm.push(patient.segment_mm);
        self.rotation_deg.push(patient.rotation_deg);
        self.two_inflections += usize::from(patient.inflections == 2);
        for kind in patient.models.iter().map(|model| model.kind) {
            if !self.modelled.contains(&kind) {
                self.modelled.push(kind);
            }
        }
        for line in &patient.lines {
            if self.numbers.iter().all(|(kind, _)| *kind != line.kind) {
                self.numbers.push((line.kind, line.numbers));
            }
        }
        self.has_different_data |= !patient.same_data;
        for hypothesis in patient.hypotheses.iter().map(|fit| fit.hypothesis) {
            if !self.hypotheses.contains(&hypothesis) {
                self.hypotheses.push(hypothesis);
            }
        }
        self.add_tests(patient);
        if patient.has_doubted_film() {
            self.doubted += 1;
            if self.doubted <= self.listed {
                self.doubted_films.extend_from_slice(&patient.doubts);
            }
        }
        match self.chains.iter_mut().find(|count| count.levels == patient.levels) {
            Some(count) => count.patients += 1,
            None => self.chains.push(ChainCount { levels: patient.levels, patients: 1 }),
        }
    }

    /// Films of a patient on which lines have no result.
    fn add_missing(&mut self, missing: Vec<MissingResult>) {
        self.with_missing += usize::from(!missing.is_empty());
        if self.with_missing <= self.listed {
            self.missing.extend(missing);
        }
    }

    /// Tests of a single force along a line.
    fn add_tests(&mut self, patient: &CohortPatient) {
        let is_doubted = patient.has_doubted_film();
        for &(kind, outcome) in &patient.tested {
            self.outcomes_of(kind).add_patient(outcome, is_doubted);
        }
        for &(kind, outcome) in patient.films.iter().flat_map(|film| &film.tested) {
            self.outcomes_of(kind).add_bend(outcome, is_doubted);
        }
    }

    fn outcomes_of(&mut self, kind: LineKind) -> &mut LineOutcomes {
        let place = self.outcomes.iter().position(|one| one.kind == kind);
        let place = place.unwrap_or_else(|| {
            self.outcomes.push(LineOutcomes::of(kind));
            self.outcomes.len() - 1
        });
        &mut self.outcomes[place]
    }
}
