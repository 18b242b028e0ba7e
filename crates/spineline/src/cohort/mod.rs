//! Many patients: the paper's statistics and, beside each, one that respects the patient of a vertebra.
//!
//! Pooled means, their normal intervals and the pooled paired t-tests are the paper's. The patient-level tests take one
//! mean per patient, and the bootstrap resamples patients. Fitted and held-out films are never pooled. Models are
//! compared on the films that both could simulate, and how many could not is counted.
//!
//! # References
//! [jalalian-loa], sections 3 and 4, table 2.

mod baselines;
mod claims;
mod comparison;
mod films;
mod known_patients;
mod lines;
mod numbers;
mod others;
mod outcomes;
mod patient;
mod patients;
mod refused;
mod rotation_prior;
mod words;
mod workers;

pub use baselines::{BaselineTest, BaselinesOverPatients, PredictionErrors};
pub use claims::{ClaimVerdict, Claims, NEAR_SEGMENTS, PatientClaims};
pub use comparison::{ComparisonOutcome, PairedComparison, enough_words, too_few_words};
pub use films::{ChainCount, DoubtedFilm};
pub use known_patients::{KnownPatients, PatientMarks, SamePatient};
pub use lines::{ErrorKind, LinePairTest, LinesOverPatients, MissingResult, RoleErrors};
pub use outcomes::{LineOutcomes, OutcomeCounts};
pub use patient::{CohortPatient, NoResult};
pub use patients::Clustered;
pub use refused::{RefusalStep, RefusedCase};
pub use rotation_prior::{LearnedRotations, learn_rotation_prior};
pub use workers::{OneThread, Workers};

use crate::action::LineKind;
use crate::analysis::FilmRole;
use crate::evaluate::statistics::{Resampling, Summary};
use others::Seen;
use patient::{Estimate, PatientFilm};
use patients::Patients;

/// Resamples of a cluster bootstrap.
const RESAMPLES: u32 = 2000;

/// A way to estimate the least-rotating segments, over some films.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateStatistics {
    /// Distances to the least-rotating segments, in segments.
    pub distance_segments: Clustered,
    /// Distances in mm on the erect film.
    pub distance_mm: Clustered,
    /// Rotation of the estimated segments, in degrees.
    pub rotation_deg: Clustered,
    /// All distances in segments, patient by patient.
    pub all_distances_segments: Vec<f64>,
    /// All rotations in degrees, patient by patient.
    pub all_rotations_deg: Vec<f64>,
}

impl EstimateStatistics {
    /// Share of the estimates at a distance of 0, 1 and 2 segments, and beyond; NaN without an estimate.
    #[must_use]
    pub fn shares(&self) -> [f64; 4] {
        let values = &self.all_distances_segments;
        let mut counts = [0.0; 4];
        for distance in values {
            counts[(*distance as usize).min(3)] += 1.0;
        }
        counts.map(|count| count / values.len() as f64)
    }
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
    pub rotation_deg: Clustered,
    /// Rotations of the least-rotating segments, in degrees.
    pub least_rotation_deg: Clustered,
    /// All of them, patient by patient.
    pub all_least_rotations_deg: Vec<f64>,
    /// Inflections as estimates over all films, over bends, and over neutral and traction films.
    pub inflection: [EstimateStatistics; 3],
    /// MMS_Mean over bends, and over neutral and traction films.
    pub mean_least: [EstimateStatistics; 2],
    /// Inflections against MMS_Mean: distance on bends and on the others, rotation on bends and on the others.
    pub table_2: [PairedComparison; 4],
    /// Patients whose erect curve has exactly two inflections.
    pub two_inflections: usize,
    /// Patients with a film without a scale, which does not count in lengths.
    pub without_scale: usize,
    /// Joints per fitted film that turn against the force along the inflection line; `None` where no patient has a model of it.
    pub contradicted_by_inflection_line: Option<Summary>,
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
    /// The films of these patients, by patient.
    pub doubted_films: Vec<DoubtedFilm>,
    /// The chains of the patients, the one of most patients first.
    pub chains: Vec<ChainCount>,
}

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
    /// Statistics of some patients; the seed is for the bootstrap and the permutation tests. A patient with a film that may not show
    /// what it is named after counts in no mean, interval or test.
    ///
    /// ```
    /// use spineline::analysis::{AnalysisOptions, analyze_movement};
    /// use spineline::cohort::{Cohort, CohortPatient};
    /// use spineline_phantom::{Readers, Scenario, generate};
    ///
    /// let mut patients = Vec::new();
    /// for subject in 0..2 {
    ///     let case = generate(subject, Scenario::Bend, &Readers::exact(), 1)?.case;
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
        Self::by(patients, seed, &OneThread)
    }

    /// The same, with predictions, resampling and tests done by the workers.
    #[must_use]
    pub fn by(all: &[CohortPatient], seed: u64, workers: &dyn Workers) -> Self {
        let resampling = Resampling::new(RESAMPLES, seed);
        let counts = |patient: &CohortPatient| !patient.has_doubted_film();
        let patients = Patients::new(all, resampling, workers, counts);
        let counted: Vec<&CohortPatient> = all.iter().filter(|one| counts(one)).collect();
        let mean = |value: fn(&CohortPatient) -> Option<f64>| -> Summary {
            Summary::of(&counted.iter().filter_map(|one| value(one)).collect::<Vec<f64>>())
        };
        let [rmse_mm, rmse_deg, least_rotation_deg] = of_films(&patients);
        let [on_all, on_bends, on_others, mean_on_bends, mean_on_others] = estimates(&patients);
        let compared = LinesOverPatients::of(all, &patients);
        let kinds: Vec<LineKind> = compared.kinds().collect();
        let [location_test, ferguson_test] =
            ErrorKind::ALL.map(|error| compared.paper_test(error, seed));
        let rotations: Vec<Summary> = counted.iter().map(|patient| patient.rotation_deg).collect();
        let doubted = all.iter().filter(|patient| patient.has_doubted_film());
        Self {
            patients: all.len(),
            synthetic: all.iter().any(|patient| patient.synthetic),
            segments: mean(|patient| Some(patient.segments as f64)),
            segment_mm: mean(|patient| patient.films[0].has_scale.then_some(patient.segment_mm)),
            rmse_mm,
            rmse_deg,
            rotation_deg: Clustered::of(&rotations, &resampling),
            least_rotation_deg,
            all_least_rotations_deg: patients.values(|seen, values| {
                seen.patient.films.iter().for_each(|film| least_rotations(film, values));
            }),
            inflection: [on_all, on_bends, on_others],
            mean_least: [mean_on_bends, mean_on_others],
            table_2: table_2(&patients),
            two_inflections: all.iter().filter(|patient| patient.inflections == 2).count(),
            without_scale: all.iter().filter(|patient| !patient.has_scale()).count(),
            contradicted_by_inflection_line: kinds
                .contains(&LineKind::Inflection)
                .then(|| contradicted(&counted)),
            baselines: BaselinesOverPatients::of(all, &patients, &kinds),
            compared,
            ferguson_test,
            location_test,
            outcomes: LineOutcomes::all(all),
            doubted: doubted.clone().count(),
            doubted_films: doubted.flat_map(|patient| patient.doubts.iter().cloned()).collect(),
            chains: ChainCount::all(all.iter().map(|patient| patient.levels)),
        }
    }

    /// How the tests of a line ended; `None` where no patient has a model of it.
    #[must_use]
    pub fn outcomes(&self, kind: LineKind) -> Option<&LineOutcomes> {
        self.outcomes.iter().find(|found| found.kind == kind)
    }
}

fn least_rotations(film: &PatientFilm, values: &mut Vec<f64>) {
    values.extend(film.least_rotations_deg.iter().flatten());
}

/// Residuals of the curves' locations and tilts, and the least rotations.
fn of_films(patients: &Patients<'_>) -> [Clustered; 3] {
    let values: [fn(&PatientFilm, &mut Vec<f64>); 3] = [
        |film, values| values.extend(film.rmse_mm),
        |film, values| values.push(film.rmse_deg),
        least_rotations,
    ];
    let found = patients.clustered(&values, |seen, value, values| {
        seen.patient.films.iter().for_each(|film| value(film, values));
    });
    std::array::from_fn(|place| found[place])
}

/// The estimates of the least-rotating segments that a film has in one way.
type EstimatesOf = fn(&PatientFilm) -> Option<&[Estimate; 2]>;
type EstimateValue = fn(&Estimate) -> f64;

const INFLECTIONS: EstimatesOf = |film| film.inflection_estimates.as_ref();
const MEAN_LEAST: EstimatesOf = |film| film.mean_least_estimates.as_ref();
const DISTANCE: EstimateValue = |estimate| estimate.distance_segments;
const DISTANCE_MM: EstimateValue = |estimate| estimate.distance_mm;
const ROTATION: EstimateValue = |estimate| estimate.rotation_deg;

/// Inflections on all films, on bends and on the others, and MMS_Mean on bends and on the others.
fn estimates(patients: &Patients<'_>) -> [EstimateStatistics; 5] {
    let sets = [
        (Films::All, INFLECTIONS),
        (Films::Bends, INFLECTIONS),
        (Films::Others, INFLECTIONS),
        (Films::Bends, MEAN_LEAST),
        (Films::Others, MEAN_LEAST),
    ];
    let samples =
        sets.map(|(films, of)| [DISTANCE, DISTANCE_MM, ROTATION].map(|value| (films, of, value)));
    type Sample = (Films, EstimatesOf, EstimateValue);
    let add = |seen: &Seen<'_>, sample: &Sample, values: &mut Vec<f64>| {
        let (films, of, value) = sample;
        let films = seen.patient.films.iter().filter(|film| films.has(film));
        let found = films.filter_map(of).flatten().map(value);
        values.extend(found.filter(|value| !value.is_nan()));
    };
    let found = patients.clustered(samples.as_flattened(), add);
    std::array::from_fn(|set| {
        let [distances, _, rotations] = samples[set];
        EstimateStatistics {
            distance_segments: found[3 * set],
            distance_mm: found[3 * set + 1],
            rotation_deg: found[3 * set + 2],
            all_distances_segments: patients.values(|seen, values| add(seen, &distances, values)),
            all_rotations_deg: patients.values(|seen, values| add(seen, &rotations, values)),
        }
    })
}

/// Inflections against MMS_Mean where both are known.
fn table_2(patients: &Patients<'_>) -> [PairedComparison; 4] {
    let pairs = [
        (Films::Bends, DISTANCE),
        (Films::Others, DISTANCE),
        (Films::Bends, ROTATION),
        (Films::Others, ROTATION),
    ];
    let found = patients.compared(&pairs, |seen, (films, value), [a, b]| {
        for film in seen.patient.films.iter().filter(|film| films.has(film)) {
            if let Some((inflection, mean_least)) = INFLECTIONS(film).zip(MEAN_LEAST(film)) {
                a.extend(inflection.iter().map(value));
                b.extend(mean_least.iter().map(value));
            }
        }
    });
    std::array::from_fn(|place| found[place])
}

/// Joints per fitted film that turn against the force along the inflection line.
fn contradicted(patients: &[&CohortPatient]) -> Summary {
    let of = |patient: &&CohortPatient| {
        let films = patient.films_of(FilmRole::Fitted, [LineKind::Inflection]);
        Summary::of(&films.map(|[errors]| errors.contradicted()).collect::<Vec<_>>())
    };
    Summary::pooled(&patients.iter().map(of).collect::<Vec<_>>())
}
