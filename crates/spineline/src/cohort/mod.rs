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
mod rotation_prior;
mod words;

pub use baselines::{BaselineErrors, BaselineTest, BaselinesOverPatients};
pub use claims::{ClaimVerdict, Claims, NEAR_SEGMENTS, PatientClaims};
pub use comparison::PairedComparison;
pub use films::{ChainCount, DoubtedFilm};
pub use lines::{ErrorKind, LinePairTest, LinesOverPatients, MissingResult, NoResult, RoleErrors};
pub use rotation_prior::{LearnedRotations, learn_rotation_prior};

use crate::action::LineKind;
use crate::analysis::{Analysis, LinesCompared, PostureAnalysis, ferguson_errors_deg};
use crate::evaluate::Simulation;
use crate::evaluate::statistics::{Summary, cluster_bootstrap};
use crate::motion::SegmentEstimate;

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
    fn new(by_patient: Vec<Vec<f64>>, seed: u64) -> Self {
        let all: Vec<f64> = by_patient.iter().flatten().copied().collect();
        let means: Vec<f64> =
            by_patient.iter().filter(|v| !v.is_empty()).map(|v| Summary::of(v).mean).collect();
        Self {
            pooled: Summary::of(&all),
            patients: Summary::of(&means),
            bootstrap: cluster_bootstrap(&by_patient, RESAMPLES, seed),
            by_patient,
        }
    }

    /// All values, patient by patient.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.by_patient.iter().flatten().copied().collect()
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
    pub rotation_deg: Clustered,
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
    /// Patients whose bends reject a single force through the inflections, and all patients who were tested.
    ///
    /// Patients with a film that may be a wrong one are in neither number.
    pub incompatible: (usize, usize),
    /// Patients with a film that may not show what it is named after.
    pub doubted: usize,
    /// The films of these patients, by patient.
    pub doubted_films: Vec<DoubtedFilm>,
    /// The chains of the patients, the one of most patients first.
    pub chains: Vec<ChainCount>,
    /// Bending films whose own load runs elsewhere than through the inflections, beyond chance and by what matters, and
    /// all that were tested.
    pub line_rejected: (usize, usize),
}

/// Which films count.
#[derive(Clone, Copy, PartialEq)]
enum Films {
    All,
    Bends,
    Others,
}

impl Films {
    fn has(self, posture: &PostureAnalysis) -> bool {
        let bends = posture.outline.posture.bend().is_some();
        posture.motion.is_some()
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
    /// use spineline::cohort::Cohort;
    /// use spineline_phantom::{Readers, Truth, generate};
    ///
    /// let mut analyses = Vec::new();
    /// for subject in 0..2 {
    ///     let case = generate(subject, Truth::Bend, &Readers::exact(), 1)?.case;
    ///     analyses.push(analyze_movement(&case, &AnalysisOptions::default())?);
    /// }
    /// let cohort = Cohort::of(&analyses.iter().collect::<Vec<_>>(), 1);
    /// assert_eq!(cohort.patients, 2);
    /// // Synthetic patients make a synthetic cohort.
    /// assert!(cohort.synthetic);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of(analyses: &[&Analysis], seed: u64) -> Self {
        let compared: Vec<LinesCompared> = analyses.iter().map(|a| a.compare_lines()).collect();
        let clustered = |value: &dyn Fn(&Analysis) -> Vec<f64>| {
            Clustered::new(analyses.iter().map(|a| value(a)).collect(), seed)
        };
        let films = |value: &dyn Fn(&PostureAnalysis) -> Vec<f64>| {
            clustered(&|a: &Analysis| a.postures.iter().flat_map(value).collect())
        };
        let inflection = |which: Films| {
            estimates(analyses, which, seed, |p| p.inflection_estimates.as_ref().map(|e| &e[..]))
        };
        let mean_least = |which: Films| {
            estimates(analyses, which, seed, |p| p.mean_least_estimates.as_ref().map(|e| &e[..]))
        };
        let kinds = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated, LineKind::Given];
        let numbers = |value: &dyn Fn(&Analysis) -> f64| {
            Summary::of(&analyses.iter().map(|a| value(a)).collect::<Vec<f64>>())
        };
        let incompatible: Vec<bool> = analyses
            .iter()
            .filter(|a| !a.has_doubted_film())
            .filter_map(|a| {
                let model = a.models.iter().find(|m| m.kind == LineKind::Inflection)?;
                Some(a.compatibility(model)).filter(|c| !c.bends.is_empty()).map(|c| c.rejects())
            })
            .collect();
        let count = |of: &[bool]| (of.iter().filter(|found| **found).count(), of.len());
        let tested: Vec<bool> = analyses
            .iter()
            .flat_map(|a| &a.postures)
            .filter(|p| Films::Bends.has(p))
            .filter_map(|p| p.line_comparison().map(|c| c.test.rejects()))
            .collect();
        Self {
            patients: analyses.len(),
            synthetic: analyses.iter().any(|a| a.synthetic),
            segments: numbers(&|a| a.chain.segments as f64),
            segment_mm: numbers(&|a| a.chain.segment_mm),
            rmse_mm: films(&|p| vec![p.fit.rmse_mm]),
            rmse_deg: films(&|p| vec![p.fit.rmse_tilt.deg()]),
            rotation_deg: films(&|p| {
                p.motion.iter().flat_map(|m| m.rotations.iter().map(|r| r.deg())).collect()
            }),
            least_rotation_deg: films(&|p| {
                p.motion.iter().flat_map(|m| m.least.map(|k| m.rotations[k].deg())).collect()
            }),
            inflection: [Films::All, Films::Bends, Films::Others].map(inflection),
            mean_least: [Films::Bends, Films::Others].map(mean_least),
            table_2: table_2(analyses, seed),
            two_inflections: analyses.iter().filter(|a| a.inflections.all.len() == 2).count(),
            lines: kinds.into_iter().filter_map(|kind| line(analyses, kind, seed)).collect(),
            ferguson_test: paper_test(analyses, seed, ferguson_errors_deg),
            location_test: paper_test(analyses, seed, |s| s.location_errors_mm.clone()),
            baselines: BaselinesOverPatients::of(analyses, &compared, seed),
            compared: LinesOverPatients::of(analyses, &compared, seed),
            incompatible: count(&incompatible),
            doubted: analyses.iter().filter(|a| a.has_doubted_film()).count(),
            doubted_films: DoubtedFilm::of(analyses),
            chains: ChainCount::of(analyses),
            line_rejected: count(&tested),
        }
    }

    /// One line's statistics.
    #[must_use]
    pub fn line(&self, kind: LineKind) -> Option<&LineStatistics> {
        self.lines.iter().find(|line| line.kind == kind)
    }
}

fn estimates(
    analyses: &[&Analysis],
    which: Films,
    seed: u64,
    of: impl Fn(&PostureAnalysis) -> Option<&[SegmentEstimate]>,
) -> EstimateStatistics {
    let clustered = |value: &dyn Fn(&SegmentEstimate) -> f64| {
        let patient = |a: &&Analysis| {
            let films = a.postures.iter().filter(|p| which.has(p));
            films.filter_map(&of).flatten().map(value).collect()
        };
        Clustered::new(analyses.iter().map(patient).collect(), seed)
    };
    EstimateStatistics {
        distance_segments: clustered(&|e| e.distance_segments as f64),
        distance_mm: clustered(&|e| e.distance_mm),
        rotation_deg: clustered(&|e| e.rotation.deg()),
    }
}

/// Inflections against MMS_Mean where both are known.
fn table_2(analyses: &[&Analysis], seed: u64) -> [PairedComparison; 4] {
    let pairs = |which: Films, value: &dyn Fn(&SegmentEstimate) -> f64| {
        let (mut a, mut b) = (Vec::new(), Vec::new());
        for analysis in analyses {
            let both = analysis.postures.iter().filter(|p| which.has(p)).filter_map(|p| {
                p.inflection_estimates.as_ref().zip(p.mean_least_estimates.as_ref())
            });
            let (mut of_a, mut of_b) = (Vec::new(), Vec::new());
            for (inflection, mean_least) in both {
                of_a.extend(inflection.iter().map(value));
                of_b.extend(mean_least.iter().map(value));
            }
            a.push(of_a);
            b.push(of_b);
        }
        PairedComparison::new(&a, &b, seed)
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

fn simulations(
    analysis: &Analysis,
    kind: LineKind,
    fitted: bool,
) -> impl Iterator<Item = &Simulation> {
    let models = analysis.models.iter().filter(move |m| m.kind == kind);
    models.flat_map(|m| &m.postures).filter(move |s| s.fitted == fitted)
}

fn line(analyses: &[&Analysis], kind: LineKind, seed: u64) -> Option<LineStatistics> {
    if !analyses.iter().any(|a| a.models.iter().any(|m| m.kind == kind)) {
        return None;
    }
    let clustered = |fitted: bool, value: &dyn Fn(&Simulation) -> Vec<f64>| {
        let patient = |a: &&Analysis| {
            simulations(a, kind, fitted).filter(|s| s.is_usable()).flat_map(value).collect()
        };
        Clustered::new(analyses.iter().map(patient).collect(), seed)
    };
    let errors = |fitted: bool| ErrorStatistics {
        ferguson_deg: clustered(fitted, &ferguson_errors_deg),
        location_mm: clustered(fitted, &|s| s.location_errors_mm.clone()),
        unusable: analyses
            .iter()
            .flat_map(|a| simulations(a, kind, fitted))
            .filter(|s| !s.is_usable())
            .count(),
    };
    Some(LineStatistics {
        kind,
        fitted: errors(true),
        held_out: errors(false),
        contradicted: clustered(true, &|s| vec![s.contradicted.len() as f64]),
        contradicted_weight: clustered(true, &|s| vec![s.contradicted_weight()]),
    })
}

/// Errors of the inflection line against those of the iliac line, on fitted films that both could simulate.
fn paper_test(
    analyses: &[&Analysis],
    seed: u64,
    errors: impl Fn(&Simulation) -> Vec<f64>,
) -> PairedComparison {
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for analysis in analyses {
        let (mut of_a, mut of_b) = (Vec::new(), Vec::new());
        for first in simulations(analysis, LineKind::Inflection, true).filter(|s| s.is_usable()) {
            let second = simulations(analysis, LineKind::Iliac, true)
                .find(|s| s.posture == first.posture && s.is_usable());
            if let Some(second) = second {
                of_a.extend(errors(first));
                of_b.extend(errors(second));
            }
        }
        a.push(of_a);
        b.push(of_b);
    }
    PairedComparison::new(&a, &b, seed)
}
