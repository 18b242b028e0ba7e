//! The file of a cohort: lines of action over many patients.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::action::LineKind;
use spineline::analysis::FilmRole;
use spineline::anatomy::Level;
use spineline::cohort::{
    BaselineTest, ChainCount, Clustered, Cohort, ComparisonOutcome, DoubtedFilm, ErrorKind,
    LineOutcomes, LinePairTest, MissingResult, PairedComparison, PredictionErrors, RefusedCase,
    RoleErrors,
};
use spineline::evaluate::Baseline;
use spineline::evaluate::statistics::PairedT;

use crate::Provenance;
use crate::analysis_file::NumbersRecord;
use crate::text::finite;

/// The lines of action over many patients, on the same films. Location errors in mm, Ferguson errors in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(title = "Spineline cohort, version 1")]
pub struct CohortFile {
    format: String,
    version: u32,
    /// Program that wrote it.
    generator: String,
    /// Provenance.
    provenance: Provenance,
    /// Whether any patient is synthetic.
    synthetic: bool,
    /// The given cases that are not part of the numbers.
    refused: Vec<RefusedCase>,
    case_ids: Vec<String>,
    /// Seed of resampling and, beyond 20 patients, of the drawn sign flips.
    seed: u64,
    /// Which number is valid, and why.
    believe: String,
    /// Family of tests of Holm's correction.
    family: String,
    /// Number of tests in it.
    family_tests: usize,
    /// Whether all lines were fitted to the same data.
    same_data: bool,
    /// Section 3.1 and table 2 of the paper.
    movement: MovementRecord,
    /// Numbers that each line takes from films.
    numbers: BTreeMap<String, NumbersRecord>,
    /// By line and role, over the films on which the line has a result. Lines are compared by `tests` alone.
    errors: Vec<ErrorsRecord>,
    /// Films on which a line has no result, once per such line.
    films_without_result: Vec<MissingResult>,
    /// By pair of lines, role and error.
    tests: Vec<TestRecord>,
    /// Predictions without mechanics, by pattern of joint rotations and role.
    baselines: Vec<BaselineRecord>,
    /// Lines from T2's location and tilt, by line and role; their distribution of rotations is the published or the given one.
    lines_with_tilt: Vec<LineWithTiltRecord>,
    /// Lines against baselines that know as much of T2, by location error in mm, line minus baseline.
    baseline_tests: Vec<BaselineTestRecord>,
    /// Other loads and bases against them, likewise; a separate family of tests.
    hypothesis_tests: Vec<BaselineTestRecord>,
    /// Films that may not show what they are named after.
    doubted_films: Vec<DoubtedFilm>,
    /// The vertebrae of the patients' models; results of different ones are not comparable.
    chains: Vec<ChainRecord>,
    /// By line that is not fitted to the films: how the tests of a single force along it ended.
    outcomes: BTreeMap<String, LineOutcomes>,
    verdict: Vec<String>,
}

/// Curves, rotations of segments, and the two estimates of the least-rotating segments.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct MovementRecord {
    curve_residual_mm: SampleRecord,
    curve_residual_deg: SampleRecord,
    rotation_deg: SampleRecord,
    least_rotation_deg: SampleRecord,
    inflection_rotation_deg: SampleRecord,
    /// From the least-rotating segment of the window to the inflection.
    inflection_distance_segments: SampleRecord,
    inflection_distance_mm: SampleRecord,
    /// Share of inflections at 0, 1, 2 and more segments from the least-rotating one (figure 6a).
    inflection_shares: [Option<f64>; 4],
    /// Inflections minus MMS_Mean.
    table_2: Vec<EstimatesRecord>,
}

/// Inflections against MMS_Mean as estimates of the least-rotating segments.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct EstimatesRecord {
    /// `distance_segments` or `rotation_deg`.
    quantity: &'static str,
    /// `bends` or `neutral_and_traction`.
    films: &'static str,
    /// Of one mean difference per patient.
    mean_difference: Option<f64>,
    /// By resampling patients.
    interval_95: Option<[f64; 2]>,
    /// Paired t over one mean per patient, two-sided.
    patient_t: Option<PairedT>,
    /// The paper's paired t, as if all values were independent.
    pooled_t: Option<PairedT>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct ErrorsRecord {
    line: LineKind,
    role: FilmRole,
    films: usize,
    /// Films on which the line has no result.
    films_without_result: usize,
    location_mm: SampleRecord,
    ferguson_deg: SampleRecord,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct SampleRecord {
    patients: usize,
    /// Of one mean per patient.
    mean: Option<f64>,
    /// By resampling patients.
    interval_95: Option<[f64; 2]>,
    /// Of one mean per patient.
    sd: Option<f64>,
    /// As the paper has it: of all values, as if they were independent.
    pooled_mean: Option<f64>,
    pooled_sd: Option<f64>,
}

/// Patients whose models have the same vertebrae.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct ChainRecord {
    base: Level,
    top: Level,
    patients: usize,
}

/// Two lines on the films that both could simulate. Differences are first minus second.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct TestRecord {
    lines: [LineKind; 2],
    role: FilmRole,
    error: ErrorKind,
    films: usize,
    /// Films on which one of the two has no result, or both.
    films_without_result: usize,
    patients: usize,
    /// Numbers that each line takes from a film before it predicts it.
    per_predicted_film: [usize; 2],
    /// Of one mean difference per patient.
    mean_difference: Option<f64>,
    /// By resampling patients.
    interval_95: Option<[f64; 2]>,
    /// Mean over the deviation of the patients' differences.
    effect_d: Option<f64>,
    /// By the noncentral t distribution.
    effect_interval_95: Option<[f64; 2]>,
    /// Of flipping the signs of the patients' differences, two-sided.
    sign_flip_p: Option<f64>,
    /// Whether all flips were counted.
    sign_flip_exact: Option<bool>,
    /// The same after Holm's correction; this is the valid one.
    holm_p: Option<f64>,
    /// Paired t over one mean per patient, two-sided.
    patient_t: Option<PairedT>,
    /// The paper's paired t, as if all values were independent.
    pooled_t: Option<PairedT>,
    /// The line that predicts better: on films that were not fitted, beyond chance, without more numbers from them.
    predicts_better: Option<LineKind>,
}

/// A pattern of joint rotations that predicts films from T2 alone.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct BaselineRecord {
    baseline: Baseline,
    /// `left_out_bend` or `held_out`.
    role: FilmRole,
    films: usize,
    location_mm: SampleRecord,
}

/// A line that predicts films from T2's location and tilt.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct LineWithTiltRecord {
    line: LineKind,
    /// `left_out_bend` or `held_out`.
    role: FilmRole,
    films: usize,
    location_mm: SampleRecord,
}

/// A line, or another load and base, against a baseline, on the films that both predict.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct BaselineTestRecord {
    /// Name of the line, or of the load and base.
    model: String,
    baseline: Baseline,
    role: FilmRole,
    films: usize,
    patients: usize,
    /// Of one mean difference per patient, model minus baseline.
    mean_difference_mm: Option<f64>,
    /// By resampling patients.
    interval_95_mm: Option<[f64; 2]>,
    sign_flip_p: Option<f64>,
    /// After Holm's correction over all of these tests.
    holm_p: Option<f64>,
    /// The model compared with the baseline.
    outcome: ComparisonOutcome,
}

impl CohortFile {
    /// The file of a cohort, with its provenance.
    #[must_use]
    pub fn new(
        cohort: &Cohort,
        case_ids: Vec<String>,
        refused: &[RefusedCase],
        seed: u64,
        generator: &str,
        provenance: Provenance,
    ) -> Self {
        let compared = &cohort.compared;
        let numbers = compared.numbers.iter();
        Self {
            format: "spineline-cohort".to_owned(),
            version: 1,
            generator: generator.to_owned(),
            provenance,
            synthetic: cohort.synthetic,
            refused: refused.to_vec(),
            case_ids,
            seed,
            believe: compared.believe_words().to_owned(),
            family: compared.family_words(),
            family_tests: compared.family(),
            same_data: compared.same_data,
            movement: movement(cohort),
            numbers: numbers
                .map(|(kind, n)| (kind.key().to_owned(), NumbersRecord::new(n)))
                .collect(),
            errors: compared.errors.iter().map(errors).collect(),
            films_without_result: compared.missing.clone(),
            tests: compared.tests.iter().map(test).collect(),
            baselines: cohort.baselines.errors.iter().map(baseline).collect(),
            lines_with_tilt: cohort.baselines.lines_with_tilt.iter().map(with_tilt).collect(),
            baseline_tests: cohort
                .baselines
                .tests
                .iter()
                .map(|test| baseline_test(test, test.predictor().key()))
                .collect(),
            hypothesis_tests: cohort
                .baselines
                .hypothesis_tests
                .iter()
                .map(|test| baseline_test(test, test.model.key()))
                .collect(),
            doubted_films: cohort.doubted_films.clone(),
            chains: cohort.chains.iter().map(chain).collect(),
            outcomes: cohort.outcomes.iter().map(|o| (o.kind.key().to_owned(), *o)).collect(),
            verdict: cohort.sentences(),
        }
    }
}

fn movement(cohort: &Cohort) -> MovementRecord {
    let inflection = &cohort.inflection[0];
    let rows = ["distance_segments", "rotation_deg"]
        .into_iter()
        .flat_map(|quantity| ["bends", "neutral_and_traction"].map(|films| [quantity, films]));
    let test =
        |([quantity, films], found): ([&'static str; 2], &PairedComparison)| EstimatesRecord {
            quantity,
            films,
            mean_difference: finite(found.mean_difference),
            interval_95: found.bootstrap,
            patient_t: found.patients,
            pooled_t: found.pooled,
        };
    MovementRecord {
        curve_residual_mm: sample(&cohort.rmse_mm),
        curve_residual_deg: sample(&cohort.rmse_deg),
        rotation_deg: sample(&cohort.rotation_deg),
        least_rotation_deg: sample(&cohort.least_rotation_deg),
        inflection_rotation_deg: sample(&inflection.rotation_deg),
        inflection_distance_segments: sample(&inflection.distance_segments),
        inflection_distance_mm: sample(&inflection.distance_mm),
        inflection_shares: inflection.shares().map(finite),
        table_2: rows.zip(&cohort.table_2).map(test).collect(),
    }
}

fn sample(values: &Clustered) -> SampleRecord {
    SampleRecord {
        patients: values.patients.n,
        mean: finite(values.patients.mean),
        interval_95: values.bootstrap,
        sd: finite(values.patients.sd),
        pooled_mean: finite(values.pooled.mean),
        pooled_sd: finite(values.pooled.sd),
    }
}

fn with_tilt(found: &PredictionErrors<LineKind>) -> LineWithTiltRecord {
    LineWithTiltRecord {
        line: found.by,
        role: found.role,
        films: found.films,
        location_mm: sample(&found.location_mm),
    }
}

fn baseline(found: &PredictionErrors) -> BaselineRecord {
    BaselineRecord {
        baseline: found.by,
        role: found.role,
        films: found.films,
        location_mm: sample(&found.location_mm),
    }
}

fn baseline_test<M>(found: &BaselineTest<M>, model: String) -> BaselineTestRecord {
    let c = &found.comparison;
    BaselineTestRecord {
        model,
        baseline: found.baseline,
        role: found.role,
        films: found.films,
        patients: c.patients(),
        mean_difference_mm: finite(c.mean_difference),
        interval_95_mm: c.bootstrap,
        sign_flip_p: c.sign_flip.map(|test| test.p_two_sided),
        holm_p: found.holm_p,
        outcome: found.outcome(),
    }
}

fn errors(found: &RoleErrors) -> ErrorsRecord {
    ErrorsRecord {
        line: found.kind,
        role: found.role,
        films: found.films,
        films_without_result: found.without_result,
        location_mm: sample(&found.location_mm),
        ferguson_deg: sample(&found.ferguson_deg),
    }
}

fn chain(count: &ChainCount) -> ChainRecord {
    let ChainCount { levels, patients } = *count;
    ChainRecord { base: levels.base(), top: levels.top(), patients }
}

fn test(found: &LinePairTest) -> TestRecord {
    let c = &found.comparison;
    TestRecord {
        lines: found.lines,
        role: found.role,
        error: found.error,
        films: found.films,
        films_without_result: found.without_result,
        patients: c.patients(),
        per_predicted_film: found.per_predicted_film,
        mean_difference: finite(c.mean_difference),
        interval_95: c.bootstrap,
        effect_d: c.effect.map(|effect| effect.d),
        effect_interval_95: c.effect.map(|effect| effect.interval),
        sign_flip_p: c.sign_flip.map(|test| test.p_two_sided),
        sign_flip_exact: c.sign_flip.map(|test| test.exact),
        holm_p: found.holm_p,
        patient_t: c.patients,
        pooled_t: c.pooled,
        predicts_better: found.predicts_better(),
    }
}
