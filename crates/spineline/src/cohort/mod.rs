//! Many patients: the paper's statistics and, beside each, one that respects who a vertebra belongs to.
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
mod lines;
mod patient;
mod rotation_prior;
mod words;

pub use baselines::{BaselineErrors, BaselineTest, BaselinesOverPatients};
pub use claims::{ClaimVerdict, Claims, NEAR_SEGMENTS, PatientClaims};
pub use comparison::PairedComparison;
pub use films::{ChainCount, DoubtedFilm};
pub use lines::{ErrorKind, LinePairTest, LinesOverPatients, MissingResult, NoResult, RoleErrors};
pub use patient::CohortPatient;
pub use rotation_prior::{LearnedRotations, learn_rotation_prior};

use crate::action::LineKind;
use crate::evaluate::statistics::{Resampling, Summary};
use crate::motion::SegmentEstimate;
use patient::{FilmErrors, PatientFilm, SimulatedFilm};

/// Resamples of a cluster bootstrap.
const RESAMPLES: u32 = 2000;

/// A sample that belongs to patients.
#[derive(Debug, Clone, PartialEq)]
pub struct Clustered {
    /// Values by patient.
    pub by_patient: Vec<Vec<f64>>,
    /// Of all values, as if they were independent.
    pub pooled: Summary,
    /// Of one mean per patient.
    pub patients: Summary,
    /// 95 % interval of the mean by resampling patients.
    pub bootstrap: Option<[f64; 2]>,
}

impl Clustered {
    fn new(by_patient: Vec<Vec<f64>>, resampling: &Resampling) -> Self {
        let all: Vec<f64> = by_patient.iter().flatten().copied().collect();
        let means: Vec<f64> =
            by_patient.iter().filter(|v| !v.is_empty()).map(|v| Summary::of(v).mean).collect();
        Self {
            pooled: Summary::of(&all),
            patients: Summary::of(&means),
            bootstrap: resampling.interval(&by_patient),
            by_patient,
        }
    }

    /// All values, patient by patient.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.by_patient.iter().flatten().copied().collect()
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
    fn new(by_patient: impl Iterator<Item = Summary>, resampling: &Resampling) -> Self {
        let by_patient: Vec<Summary> = by_patient.filter(|summary| summary.n > 0).collect();
        let means: Vec<Vec<f64>> = by_patient.iter().map(|summary| vec![summary.mean]).collect();
        Self {
            pooled: Summary::pooled(&by_patient),
            patients: Summary::of(&means.concat()),
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
    /// Share of the guesses at a distance of 0, 1 and 2 segments, and beyond.
    #[must_use]
    pub fn shares(&self) -> [f64; 4] {
        let values = self.distance_segments.values();
        let mut counts = [0.0; 4];
        for distance in &values {
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
    /// By line that is not fitted to the films: how often patients and bends reject a single force along it.
    pub rejections: Vec<LineRejections>,
    /// Patients with a film that may not show what it is named after.
    pub doubted: usize,
    /// The films of these patients, by patient.
    pub doubted_films: Vec<DoubtedFilm>,
    /// The chains of the patients, the one of most patients first.
    pub chains: Vec<ChainCount>,
}

/// How often a single force along a line is rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineRejections {
    /// The line.
    pub kind: LineKind,
    /// Patients whose bends reject it ([`crate::analysis::Compatibility::rejects`]), and all patients who were tested.
    ///
    /// Patients with a film that may be a wrong one are in neither number.
    pub patients: (usize, usize),
    /// Bending films on which the line of best fit to the rotations differs from it by chance with a probability below 5 %
    /// ([`crate::personalize::LineTest::rejects`]), and all that were tested, one by one.
    pub bends: (usize, usize),
}

impl LineRejections {
    fn of(patients: &[CohortPatient], kind: LineKind) -> Option<Self> {
        let count = |tested: &mut dyn Iterator<Item = &(LineKind, bool)>| {
            let own = tested.filter(|one| one.0 == kind);
            own.fold((0, 0), |(rejected, all), one| (rejected + usize::from(one.1), all + 1))
        };
        let films = patients.iter().flat_map(|patient| &patient.films);
        let mut bends = films.filter(|film| Films::Bends.has(film)).flat_map(|film| &film.tested);
        let mut by_patient = patients.iter().flat_map(|patient| &patient.tested);
        let found = Self { kind, patients: count(&mut by_patient), bends: count(&mut bends) };
        (found.patients.1 + found.bends.1 > 0).then_some(found)
    }
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
        let bends = film.outline.posture.bend().is_some();
        film.has_motion
            && match self {
                Self::All => true,
                Self::Bends => bends,
                Self::Others => !bends,
            }
    }
}

impl Cohort {
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
        let resampling = &Resampling::new(patients.len(), RESAMPLES, seed);
        let films = |value: &dyn Fn(&PatientFilm) -> Vec<f64>| {
            let patient = |one: &CohortPatient| one.films.iter().flat_map(value).collect();
            Clustered::new(patients.iter().map(patient).collect(), resampling)
        };
        let inflection = |which: Films| {
            estimates(patients, which, resampling, |p| p.inflection_estimates.as_ref())
        };
        let mean_least = |which: Films| {
            estimates(patients, which, resampling, |p| p.mean_least_estimates.as_ref())
        };
        let kinds = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated, LineKind::Given];
        let numbers = |value: &dyn Fn(&CohortPatient) -> f64| {
            Summary::of(&patients.iter().map(value).collect::<Vec<f64>>())
        };
        Self {
            patients: patients.len(),
            synthetic: patients.iter().any(|patient| patient.synthetic),
            segments: numbers(&|patient| patient.segments as f64),
            segment_mm: numbers(&|patient| patient.segment_mm),
            rmse_mm: films(&|film| vec![film.rmse_mm]),
            rmse_deg: films(&|film| vec![film.rmse_deg]),
            rotation_deg: ClusteredSummary::new(
                patients.iter().map(|one| one.rotation_deg),
                resampling,
            ),
            least_rotation_deg: films(&|film| film.least_rotations_deg.clone()),
            inflection: [Films::All, Films::Bends, Films::Others].map(inflection),
            mean_least: [Films::Bends, Films::Others].map(mean_least),
            table_2: table_2(patients, resampling),
            two_inflections: patients.iter().filter(|patient| patient.inflections == 2).count(),
            lines: kinds.into_iter().filter_map(|kind| line(patients, kind, resampling)).collect(),
            ferguson_test: paper_test(patients, resampling, |errors| &errors.ferguson_deg),
            location_test: paper_test(patients, resampling, |errors| &errors.location_mm),
            baselines: BaselinesOverPatients::of(patients, resampling),
            compared: LinesOverPatients::of(patients, resampling),
            rejections: kinds
                .into_iter()
                .filter_map(|kind| LineRejections::of(patients, kind))
                .collect(),
            doubted: patients.iter().filter(|patient| patient.has_doubted_film()).count(),
            doubted_films: patients.iter().flat_map(|patient| patient.doubts.clone()).collect(),
            chains: ChainCount::of(patients),
        }
    }

    /// How often a line is rejected; `None` where it was not tested.
    #[must_use]
    pub fn rejections(&self, kind: LineKind) -> Option<&LineRejections> {
        self.rejections.iter().find(|found| found.kind == kind)
    }

    /// One line's statistics.
    #[must_use]
    pub fn line(&self, kind: LineKind) -> Option<&LineStatistics> {
        self.lines.iter().find(|line| line.kind == kind)
    }
}

fn estimates(
    patients: &[CohortPatient],
    which: Films,
    resampling: &Resampling,
    of: impl Fn(&PatientFilm) -> Option<&[SegmentEstimate; 2]>,
) -> EstimateStatistics {
    let clustered = |value: &dyn Fn(&SegmentEstimate) -> f64| {
        let patient = |one: &CohortPatient| {
            let films = one.films.iter().filter(|film| which.has(film));
            films.filter_map(&of).flatten().map(value).collect()
        };
        Clustered::new(patients.iter().map(patient).collect(), resampling)
    };
    EstimateStatistics {
        distance_segments: clustered(&|e| e.distance_segments as f64),
        distance_mm: clustered(&|e| e.distance_mm),
        rotation_deg: clustered(&|e| e.rotation.deg()),
    }
}

/// Inflections against MMS_Mean where both are known.
fn table_2(patients: &[CohortPatient], resampling: &Resampling) -> [PairedComparison; 4] {
    let pairs = |which: Films, value: &dyn Fn(&SegmentEstimate) -> f64| {
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for patient in patients {
            let both = patient.films.iter().filter(|film| which.has(film)).filter_map(|film| {
                film.inflection_estimates.as_ref().zip(film.mean_least_estimates.as_ref())
            });
            let (mut of_a, mut of_b) = (Vec::new(), Vec::new());
            for (inflection, mean_least) in both {
                of_a.extend(inflection.iter().map(value));
                of_b.extend(mean_least.iter().map(value));
            }
            a.push(of_a);
            b.push(of_b);
        }
        PairedComparison::new(&a, &b, resampling)
    };
    let distance = |e: &SegmentEstimate| e.distance_segments as f64;
    let rotation = |e: &SegmentEstimate| e.rotation.deg();
    [
        pairs(Films::Bends, &distance),
        pairs(Films::Others, &distance),
        pairs(Films::Bends, &rotation),
        pairs(Films::Others, &rotation),
    ]
}

fn line(
    patients: &[CohortPatient],
    kind: LineKind,
    resampling: &Resampling,
) -> Option<LineStatistics> {
    if !patients.iter().any(|patient| patient.models.iter().any(|model| model.kind == kind)) {
        return None;
    }
    let clustered = |fitted: bool, value: &dyn Fn(&SimulatedFilm) -> Vec<f64>| {
        let patient = |one: &CohortPatient| {
            one.simulated(kind, fitted).filter(|film| film.is_usable).flat_map(value).collect()
        };
        Clustered::new(patients.iter().map(patient).collect(), resampling)
    };
    let errors = |fitted: bool| ErrorStatistics {
        ferguson_deg: clustered(fitted, &|film| film.errors.ferguson_deg.clone()),
        location_mm: clustered(fitted, &|film| film.errors.location_mm.clone()),
        unusable: patients
            .iter()
            .flat_map(|patient| patient.simulated(kind, fitted))
            .filter(|film| !film.is_usable)
            .count(),
    };
    Some(LineStatistics {
        kind,
        fitted: errors(true),
        held_out: errors(false),
        contradicted: clustered(true, &|film| vec![film.contradicted as f64]),
        contradicted_weight: clustered(true, &|film| vec![film.contradicted_weight]),
    })
}

/// Errors of the inflection line against those of the iliac line, on fitted films that both could simulate.
fn paper_test(
    patients: &[CohortPatient],
    resampling: &Resampling,
    errors: impl Fn(&FilmErrors) -> &[f64],
) -> PairedComparison {
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for patient in patients {
        let (mut of_a, mut of_b) = (Vec::new(), Vec::new());
        for first in patient.simulated(LineKind::Inflection, true).filter(|film| film.is_usable) {
            let second = patient
                .simulated(LineKind::Iliac, true)
                .find(|film| film.posture == first.posture && film.is_usable);
            if let Some(second) = second {
                of_a.extend_from_slice(errors(&first.errors));
                of_b.extend_from_slice(errors(&second.errors));
            }
        }
        a.push(of_a);
        b.push(of_b);
    }
    PairedComparison::new(&a, &b, resampling)
}
