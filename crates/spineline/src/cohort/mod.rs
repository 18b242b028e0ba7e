//! Many patients: the paper's statistics and, beside each, one that respects who a vertebra belongs to.
//!
//! Pooled means, their normal intervals and the pooled paired t-tests are the paper's. The patient-level tests take one
//! mean per patient, and the bootstrap resamples patients. Fitted and held-out films are never pooled. Models are
//! compared on the films that both could simulate, and how many could not is counted.
//!
//! # References
//! [jalalian-loa], sections 3 and 4, table 2.

mod baselines;
mod bytes;
mod census;
mod claims;
mod comparison;
mod films;
mod lines;
mod others;
mod outcomes;
mod patient;
mod refused;
mod rotation_prior;
mod rows;
mod samples;
mod words;
mod workers;

pub use baselines::{BaselineErrors, BaselineTest, BaselinesOverPatients};
pub use census::{CohortSource, TakePart};
pub use claims::{ClaimVerdict, Claims, NEAR_SEGMENTS, PatientClaims};
pub use comparison::{ComparisonOutcome, PairedComparison};
pub use films::{ChainCount, DoubtedFilm};
pub use lines::{ErrorKind, LinePairTest, LinesOverPatients, MissingResult, NoResult, RoleErrors};
pub use outcomes::{LineOutcomes, OutcomeCounts};
pub use patient::CohortPatient;
pub use refused::{RefusalStep, RefusedCase};
pub use rotation_prior::{LearnedRotations, learn_rotation_prior};
pub use rows::{CohortRows, RowsInMemory};
pub use workers::{OneThread, Workers};

use crate::action::LineKind;
use crate::evaluate::statistics::{Resampling, Summary};
use crate::motion::SegmentEstimate;
use census::{Census, Gathering};
use others::Seen;
use patient::{FilmErrors, PatientFilm, SimulatedFilm};
use samples::{Kept, Paired, Sampled, Samples};

/// Resamples of a cluster bootstrap.
const RESAMPLES: u32 = 2000;

/// A sample that belongs to patients.
#[derive(Debug, Clone, PartialEq)]
pub struct Clustered {
    /// All values, patient by patient; none in a cohort that was made without them ([`Cohort::of_source`]).
    pub values: Vec<f64>,
    /// Of all values, as if they were independent.
    pub pooled: Summary,
    /// Of one mean per patient.
    pub patients: Summary,
    /// 95 % interval of the mean by resampling patients.
    pub bootstrap: Option<[f64; 2]>,
}

impl Clustered {
    /// From the values of every patient.
    fn new(by_patient: &[Vec<f64>], resampling: &Resampling) -> Self {
        let values = by_patient.concat();
        let with_values = by_patient.iter().filter(|values| !values.is_empty());
        let means: Vec<f64> = with_values.map(|values| Summary::of(values).mean).collect();
        Self {
            pooled: Summary::of(&values),
            patients: Summary::of(&means),
            bootstrap: resampling.interval(&means),
            values,
        }
    }
}

/// As [`Clustered`], without the values: of quantities that a film has many of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusteredSummary {
    /// Of all values, as if they were independent.
    pub pooled: Summary,
    /// Of one mean per patient.
    pub patients: Summary,
    /// 95 % interval of the mean by resampling patients.
    pub bootstrap: Option<[f64; 2]>,
}

impl ClusteredSummary {
    /// From one summary per patient; patients without values do not count.
    fn new(by_patient: &[Summary], resampling: &Resampling) -> Self {
        let with_values = by_patient.iter().filter(|summary| summary.n > 0);
        let means: Vec<f64> = with_values.map(|summary| summary.mean).collect();
        Self {
            pooled: Summary::pooled(by_patient),
            patients: Summary::of(&means),
            bootstrap: resampling.interval(&means),
        }
    }
}

impl From<&Clustered> for ClusteredSummary {
    fn from(values: &Clustered) -> Self {
        Self { pooled: values.pooled, patients: values.patients, bootstrap: values.bootstrap }
    }
}

/// A way to guess the least-rotating segments, over some films.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateStatistics {
    /// Distances to the least-rotating segments, in segments.
    pub distance_segments: Clustered,
    /// Distances in mm on the erect film.
    pub distance_mm: Clustered,
    /// Rotation of the guessed segments, in degrees.
    pub rotation_deg: Clustered,
}

impl EstimateStatistics {
    /// Share of the guesses at a distance of 0, 1 and 2 segments, and beyond; NaN in a cohort without values.
    #[must_use]
    pub fn shares(&self) -> [f64; 4] {
        let values = &self.distance_segments.values;
        let mut counts = [0.0; 4];
        for distance in values {
            counts[(*distance as usize).min(3)] += 1.0;
        }
        counts.map(|count| count / values.len() as f64)
    }
}

/// Errors of one model over some films.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorStatistics {
    /// Absolute errors of the Ferguson angles, in degrees.
    pub ferguson_deg: Clustered,
    /// Location errors of the vertebrae: E_LOC.
    pub location_mm: Clustered,
    /// Films without a usable simulation.
    pub unusable: usize,
}

/// One line of action over a cohort.
#[derive(Debug, Clone, PartialEq)]
pub struct LineStatistics {
    /// The line.
    pub kind: LineKind,
    /// On films that the stiffness was fitted to.
    pub fitted: ErrorStatistics,
    /// On films that it was not fitted to.
    pub held_out: ErrorStatistics,
    /// Joints per fitted film that turn against the force.
    pub contradicted: Clustered,
    /// Their part in the work of all joints.
    pub contradicted_weight: Clustered,
}

/// All results of a cohort.
#[derive(Debug, Clone, PartialEq)]
pub struct Cohort {
    /// Patients.
    pub patients: usize,
    /// Whether any of them is synthetic.
    pub synthetic: bool,
    /// Segments per chain: n.
    pub segments: Summary,
    /// Length of a segment: l.
    pub segment_mm: Summary,
    /// Residuals of the curves' locations, one per film.
    pub rmse_mm: Clustered,
    /// Residuals of the curves' tilts, in degrees.
    pub rmse_deg: Clustered,
    /// Rotations of all segments, in degrees: r.
    pub rotation_deg: ClusteredSummary,
    /// Rotations of the least-rotating segments.
    pub least_rotation_deg: Clustered,
    /// Inflections as estimates over all films, over bends, and over neutral and traction films.
    pub inflection: [EstimateStatistics; 3],
    /// MMS_Mean over bends, and over neutral and traction films.
    pub mean_least: [EstimateStatistics; 2],
    /// Inflections against MMS_Mean: distance on bends and on the others, rotation on bends and on the others.
    pub table_2: [PairedComparison; 4],
    /// Patients whose erect curve has exactly two inflections.
    pub two_inflections: usize,
    /// Lines of action that were modelled.
    pub lines: Vec<LineStatistics>,
    /// The lines on the same films, bends left out among them, with every test between them.
    pub compared: LinesOverPatients,
    /// Predictions without mechanics, and whether lines beat them.
    pub baselines: BaselinesOverPatients,
    /// Ferguson errors of the inflection line against the iliac line on fitted films: the paper's test.
    pub ferguson_test: PairedComparison,
    /// Location errors of the inflection line against the iliac line on fitted films: the paper's test.
    pub location_test: PairedComparison,
    /// By line that is not fitted to the films: how often patients and bends reject and keep a single force along it.
    pub outcomes: Vec<LineOutcomes>,
    /// Patients with a film that may not show what it is named after.
    pub doubted: usize,
    /// The films of these patients, by patient, as [`Listed`].
    pub doubted_films: Vec<DoubtedFilm>,
    /// The chains of the patients, the one of most patients first.
    pub chains: Vec<ChainCount>,
}

/// Which patients the lists of a cohort have: own means ([`RoleErrors::by_patient_mm`]), doubted films, and films without a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Listed {
    /// The first patients ([`Cohort::LISTED`]) of which there is something to list.
    First,
    /// All.
    All,
}

/// Which films count.
#[derive(Clone, Copy, PartialEq)]
enum Films {
    All,
    Bends,
    Others,
}

impl Films {
    fn has(self, film: &PatientFilm) -> bool {
        let bends = film.posture.bend().is_some();
        film.has_motion
            && match self {
                Self::All => true,
                Self::Bends => bends,
                Self::Others => !bends,
            }
    }
}

impl Cohort {
    /// Patients in each list of a cohort that lists the first ones ([`Listed::First`]).
    pub const LISTED: usize = 200;

    /// Statistics of some patients; the seed is that of the bootstrap and of the permutation tests.
    ///
    /// ```
    /// use spineline::analysis::{AnalysisOptions, analyze_movement};
    /// use spineline::cohort::{Cohort, CohortPatient};
    /// use spineline_phantom::{Readers, Truth, generate};
    ///
    /// let mut patients = Vec::new();
    /// for subject in 0..2 {
    ///     let case = generate(subject, Truth::Bend, &Readers::exact(), 1)?.case;
    ///     let analysis = analyze_movement(&case, &AnalysisOptions::default())?;
    ///     patients.push(CohortPatient::of(&analysis));
    /// }
    /// let cohort = Cohort::of(&patients, 1);
    /// assert_eq!(cohort.patients, 2);
    /// // Synthetic patients make a synthetic cohort.
    /// assert!(cohort.synthetic);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of(patients: &[CohortPatient], seed: u64) -> Self {
        let (rows, kept) =
            (&mut RowsInMemory::default(), Kept { values: true, listed: usize::MAX });
        let Ok(cohort) = Self::gathered(&mut &*patients, rows, kept, seed, &OneThread);
        cohort
    }

    /// The same of patients that need not be in memory, without the values behind the statistics. `rows` take about a thousand bytes
    /// per patient; of memory it needs about a hundred, whatever the films, and what is listed. Resampling and tests, which take most
    /// of the time, are done by the workers.
    ///
    /// # Errors
    /// If a patient or a row cannot be read again.
    pub fn of_source<S: CohortSource>(
        patients: &mut S,
        rows: &mut impl CohortRows<S::Error>,
        listed: Listed,
        seed: u64,
        workers: &dyn Workers,
    ) -> Result<Self, S::Error> {
        let listed = match listed {
            Listed::First => Self::LISTED,
            Listed::All => usize::MAX,
        };
        Self::gathered(patients, rows, Kept { values: false, listed }, seed, workers)
    }

    fn gathered<S: CohortSource>(
        patients: &mut S,
        rows: &mut impl CohortRows<S::Error>,
        kept: Kept,
        seed: u64,
        workers: &dyn Workers,
    ) -> Result<Self, S::Error> {
        let mut gathering = Gathering::begin(patients, Resampling::new(RESAMPLES, seed), kept)?;
        let Gathering { census, samples, .. } = &mut gathering;
        let statistics = Self::ask(census, samples);
        gathering.go_through(patients, rows, workers)?;
        let Gathering { census, mut samples, .. } = gathering;
        Ok(statistics(census, &mut samples))
    }

    /// Asks for all samples; gives what makes the result of them.
    fn ask(
        census: &Census,
        samples: &mut Samples,
    ) -> impl FnOnce(Census, &mut Samples) -> Self + use<> {
        let rmse_mm = of_films(samples, |film, values| values.push(film.rmse_mm));
        let rmse_deg = of_films(samples, |film, values| values.push(film.rmse_deg));
        let least_rotation_deg =
            of_films(samples, |film, values| values.extend(&film.least_rotations_deg));
        let inflection = [Films::All, Films::Bends, Films::Others]
            .map(|which| estimates(samples, which, |film| film.inflection_estimates.as_ref()));
        let mean_least = [Films::Bends, Films::Others]
            .map(|which| estimates(samples, which, |film| film.mean_least_estimates.as_ref()));
        let table_2 = table_2(samples);
        let modelled = LineKind::ALL.into_iter().filter(|kind| census.modelled.contains(kind));
        let lines: Vec<_> = modelled.map(|kind| line(samples, kind)).collect();
        let ferguson_test = paper_test(samples, |errors| &errors.ferguson_deg);
        let location_test = paper_test(samples, |errors| &errors.location_mm);
        let same_data = !census.has_different_data;
        let compared = LinesOverPatients::ask(census.numbers.clone(), same_data, samples);
        let baselines = BaselinesOverPatients::ask(&census.kinds(), &census.hypotheses, samples);
        move |census, samples| Self {
            patients: census.patients,
            synthetic: census.synthetic,
            segments: Summary::of(&census.segments),
            segment_mm: Summary::of(&census.segment_mm),
            rmse_mm: samples.clustered(rmse_mm),
            rmse_deg: samples.clustered(rmse_deg),
            rotation_deg: ClusteredSummary::new(&census.rotation_deg, samples.resampling()),
            least_rotation_deg: samples.clustered(least_rotation_deg),
            inflection: inflection.map(|estimates| estimates(samples)),
            mean_least: mean_least.map(|estimates| estimates(samples)),
            table_2: table_2.map(|compared| samples.comparison(compared)),
            two_inflections: census.two_inflections,
            lines: lines.into_iter().map(|line| line(samples)).collect(),
            ferguson_test: samples.comparison(ferguson_test),
            location_test: samples.comparison(location_test),
            baselines: baselines(samples),
            compared: LinesOverPatients {
                missing: census.missing,
                with_missing: census.with_missing,
                ..compared(samples)
            },
            outcomes: census.outcomes,
            doubted: census.doubted,
            doubted_films: census.doubted_films,
            chains: census.chains,
        }
    }

    /// How the tests of a line ended; `None` where no patient has a model of it.
    #[must_use]
    pub fn outcomes(&self, kind: LineKind) -> Option<&LineOutcomes> {
        self.outcomes.iter().find(|found| found.kind == kind)
    }

    /// One line's statistics.
    #[must_use]
    pub fn line(&self, kind: LineKind) -> Option<&LineStatistics> {
        self.lines.iter().find(|line| line.kind == kind)
    }
}

fn of_films(
    samples: &mut Samples,
    value: impl Fn(&PatientFilm, &mut Vec<f64>) + 'static,
) -> Sampled {
    samples.sample(move |seen, values| {
        seen.patient.films.iter().for_each(|film| value(film, values));
    })
}

/// The estimates of the least-rotating segments that a film has in one way.
type EstimatesOf = fn(&PatientFilm) -> Option<&[SegmentEstimate; 2]>;

fn estimates(
    samples: &mut Samples,
    which: Films,
    of: EstimatesOf,
) -> impl FnOnce(&mut Samples) -> EstimateStatistics + use<> {
    let values: [fn(&SegmentEstimate) -> f64; 3] =
        [|e| e.distance_segments as f64, |e| e.distance_mm, |e| e.rotation.deg()];
    let [segments, mm, rotation] = values.map(|value| {
        samples.sample(move |seen, values| {
            let films = seen.patient.films.iter().filter(|film| which.has(film));
            values.extend(films.filter_map(of).flatten().map(value));
        })
    });
    move |samples| EstimateStatistics {
        distance_segments: samples.clustered(segments),
        distance_mm: samples.clustered(mm),
        rotation_deg: samples.clustered(rotation),
    }
}

/// Inflections against MMS_Mean where both are known.
fn table_2(samples: &mut Samples) -> [Paired; 4] {
    let mut pair = |which: Films, value: fn(&SegmentEstimate) -> f64| {
        samples.pair(move |seen, [a, b]| {
            let films = seen.patient.films.iter().filter(|film| which.has(film));
            let both = films.filter_map(|film| {
                film.inflection_estimates.as_ref().zip(film.mean_least_estimates.as_ref())
            });
            for (inflection, mean_least) in both {
                a.extend(inflection.iter().map(value));
                b.extend(mean_least.iter().map(value));
            }
        })
    };
    [
        pair(Films::Bends, |e| e.distance_segments as f64),
        pair(Films::Others, |e| e.distance_segments as f64),
        pair(Films::Bends, |e| e.rotation.deg()),
        pair(Films::Others, |e| e.rotation.deg()),
    ]
}

fn line(
    samples: &mut Samples,
    kind: LineKind,
) -> impl FnOnce(&mut Samples) -> LineStatistics + use<> {
    let mut usable = |fitted: bool, value: fn(&SimulatedFilm, &mut Vec<f64>)| {
        samples.sample(move |seen, values| {
            let films = seen.patient.simulated(kind, fitted).filter(|film| film.is_usable);
            films.for_each(|film| value(film, values));
        })
    };
    let errors = [true, false].map(|fitted| {
        let ferguson = usable(fitted, |film, values| values.extend(&film.errors.ferguson_deg));
        (ferguson, usable(fitted, |film, values| values.extend(&film.errors.location_mm)))
    });
    let contradicted = usable(true, |film, values| values.push(film.contradicted as f64));
    let weight = usable(true, |film, values| values.push(film.contradicted_weight));
    let unusable = [true, false].map(|fitted| {
        samples.count(move |seen| {
            seen.patient.simulated(kind, fitted).filter(|film| !film.is_usable).count()
        })
    });
    move |samples| {
        let [fitted, held_out] = [0, 1].map(|place| ErrorStatistics {
            ferguson_deg: samples.clustered(errors[place].0),
            location_mm: samples.clustered(errors[place].1),
            unusable: samples.number(unusable[place]),
        });
        LineStatistics {
            kind,
            fitted,
            held_out,
            contradicted: samples.clustered(contradicted),
            contradicted_weight: samples.clustered(weight),
        }
    }
}

/// Errors of the inflection line against those of the iliac line, on fitted films that both could simulate.
fn paper_test(samples: &mut Samples, errors: fn(&FilmErrors) -> &[f64]) -> Paired {
    samples.pair(move |seen, [a, b]| {
        let usable = |kind| seen.patient.simulated(kind, true).filter(|film| film.is_usable);
        for first in usable(LineKind::Inflection) {
            let second = usable(LineKind::Iliac).find(|film| film.posture == first.posture);
            if let Some(second) = second {
                a.extend_from_slice(errors(&first.errors));
                b.extend_from_slice(errors(&second.errors));
            }
        }
    })
}
