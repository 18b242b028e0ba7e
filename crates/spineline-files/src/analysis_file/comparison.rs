use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::action::LineKind;
use spineline::analysis::{
    Analysis, BAND_COVERAGE, BendEvidence, ComparedFilm, Compatibility, FilmBands, FilmPredictor,
    FilmRole, FreeNumbers, LinesCompared, MeanErrors,
};
use spineline::anatomy::{Levels, Posture};
use spineline::cohort::{BaselineTest, BaselinesOverPatients};
use spineline::evaluate::{Band, Baseline, BaselinePrediction, FilmShape};
use spineline::personalize::TestOutcome;

use super::band::BandRecord;
use super::model::ModelRecord;
use super::posture::ScaleRecord;

/// Every line on the films on which it has a result, every bend left out once.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(super) struct ComparisonRecord {
    /// Whether all lines were fitted to the same data. A free line needs the whole shape also where the others are fitted to
    /// Ferguson angles.
    same_data: bool,
    /// By line.
    lines: BTreeMap<String, LineRecord>,
    /// By baseline and role: mean error over the films that the baseline predicts.
    baselines_mm: BTreeMap<String, BTreeMap<String, f64>>,
    /// Every line, and every other load and base, beside the best prediction without mechanics.
    against_baselines: Vec<AgainstRecord>,
    /// Every film once per role.
    films: Vec<FilmRecord>,
    /// How often the bands of predicted films hold the measured film.
    band_coverage: String,
    /// The radii that hold all vertebrae of a film together, over the radii for one vertebra.
    band_film_factor: f64,
    /// By line: whether the bends reject a single force along it. The test of the line itself exists for every
    /// line but the estimated one, which comes from the same rotations.
    compatibility: BTreeMap<String, CompatibilityRecord>,
    /// By the bend that was left out, and line: the model that the other bend alone gave, and what it predicts.
    left_out_bends: BTreeMap<Posture, BTreeMap<String, ModelRecord>>,
    /// The comparison as text.
    verdict: Vec<String>,
}

/// A model beside the prediction without mechanics with the smallest error on the films of a role: of those that know T2's tilt, or of
/// those that do not, each beside the models that know as much.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct AgainstRecord {
    /// Name of the line, or of the load and base.
    model: String,
    /// `left_out_bend` or `held_out`.
    role: String,
    baseline: Baseline,
    /// Films that both predict.
    films: usize,
    /// Mean location error of the model less the error of the prediction: below zero where the model is better.
    difference_mm: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct LineRecord {
    /// Data of the fit: `shape` or `ferguson`.
    fitted_to: String,
    numbers: NumbersRecord,
    /// By role (`fitted`, `left_out_bend`, `held_out`), over the films on which the line has a result.
    errors: BTreeMap<String, MeanErrors>,
    /// Mean location error by role, over the films that the line predicts from T2's location and tilt.
    with_tilt_mm: BTreeMap<String, f64>,
}

/// Numbers that a model takes from films.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct NumbersRecord {
    /// Free stiffness multipliers: one less than there are, where only ratios are identified.
    multipliers: usize,
    /// Forces, one per fitted film.
    forces: usize,
    /// Parameters of the places of the fitted films' loads.
    line: usize,
    /// Their sum.
    fitted: usize,
    /// Numbers that every further film gives before it is predicted.
    per_predicted_film: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct FilmRecord {
    posture: Posture,
    /// `fitted`, `left_out_bend` or `held_out`.
    role: String,
    /// By line; `null` where it has no result.
    location_mm: BTreeMap<String, Option<f64>>,
    /// By line, predicted from T2's location and tilt, `null` where it has no result; empty for fitted films.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    with_tilt_mm: BTreeMap<String, Option<f64>>,
    /// Predictions without mechanics, by pattern of joint rotations; empty for fitted films.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    baselines: BTreeMap<String, BaselineRecord>,
    /// By line and prediction without mechanics; empty for fitted films.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    band_95: BTreeMap<String, BandRecord>,
}

/// A film as a pattern of joint rotations without mechanics predicts it, from T2 alone.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct BaselineRecord {
    /// `converged` or how else the fit to T2 ended.
    status: String,
    /// Factor on a pattern of rotations; `null` for a distribution.
    amount: Option<f64>,
    #[serde(flatten)]
    scale: ScaleRecord,
    location_mm: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct CompatibilityRecord {
    /// Outcome of all bends for the line.
    outcome: TestOutcome,
    /// Tests over which Holm's correction was taken.
    tests: usize,
    bends: Vec<BendRecord>,
    /// Bends on which no force was found.
    without_force: Vec<Posture>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct BendRecord {
    posture: Posture,
    /// Outcome of the bend for the line. Joints alone can reject a line, and do not keep one.
    outcome: TestOutcome,
    joints: usize,
    /// Counter-rotating joints.
    against: usize,
    /// Those beyond two standard deviations.
    beyond_noise: usize,
    /// Their part in the work of all joints.
    weight: f64,
    /// Probability that noise alone gives such a counter-rotation at any joint, after Holm's correction; `null` where
    /// joints were not tested: their noise is not known, or the place of the line is assumed.
    joints_p_holm: Option<f64>,
    joints_reject: bool,
    /// p value of the test of the line itself, after Holm's correction; `null` without a test.
    line_p_holm: Option<f64>,
    line_rejects: bool,
}

impl ComparisonRecord {
    /// `None` without a model to compare.
    pub fn new(analysis: &Analysis) -> Option<Self> {
        if analysis.models.is_empty() {
            return None;
        }
        let found = analysis.comparison();
        let films = found.films.iter().zip(&analysis.bands().films);
        let compatibility = analysis.models.iter().map(|model| {
            (model.kind.key().to_owned(), compatibility(&analysis.compatibility(model)))
        });
        let left_out = found.left_out.iter().map(|bend| {
            let models = bend.models.iter();
            let models =
                models.map(|m| (m.kind.key().to_owned(), ModelRecord::new(m, analysis))).collect();
            (bend.posture, models)
        });
        Some(Self {
            same_data: found.same_data(),
            lines: (0..found.lines.len()).map(|i| line(found, i)).collect(),
            baselines_mm: baselines_mm(found),
            against_baselines: against_baselines(analysis),
            films: films
                .map(|(one, bands)| film(one, bands, found, analysis.movement.levels()))
                .collect(),
            band_coverage: BAND_COVERAGE.to_owned(),
            band_film_factor: Band::WHOLE_FILM,
            compatibility: compatibility.collect(),
            left_out_bends: left_out.collect(),
            verdict: analysis.verdict(),
        })
    }
}

fn baselines_mm(found: &LinesCompared) -> BTreeMap<String, BTreeMap<String, f64>> {
    let of = |one: Baseline| (one.key().to_owned(), by_role(found, FilmPredictor::Baseline(one)));
    Baseline::ALL.into_iter().map(of).collect()
}

/// Mean errors of a predictor by role.
fn by_role(found: &LinesCompared, by: FilmPredictor) -> BTreeMap<String, f64> {
    let errors = FilmRole::ALL.into_iter();
    let errors = errors.filter_map(|role| Some((role.key().to_owned(), found.error_mm(by, role)?)));
    errors.collect()
}

fn against_baselines(analysis: &Analysis) -> Vec<AgainstRecord> {
    fn record<M>(
        baselines: &BaselinesOverPatients,
        test: &BaselineTest<M>,
        model: String,
    ) -> Option<AgainstRecord> {
        let best = baselines.best(test.role, test.baseline.knows_tilt())?;
        (best.by == test.baseline).then(|| AgainstRecord {
            model,
            role: test.role.key().to_owned(),
            baseline: test.baseline,
            films: test.films,
            difference_mm: test.comparison.mean_difference,
        })
    }
    let all = BaselinesOverPatients::of_patient(analysis);
    let lines = all.tests.iter();
    let lines = lines.filter_map(|test| record(&all, test, test.predictor().key()));
    let hypotheses = all.hypothesis_tests.iter();
    lines.chain(hypotheses.filter_map(|test| record(&all, test, test.model.key()))).collect()
}

fn line(found: &LinesCompared, place: usize) -> (String, LineRecord) {
    let line = &found.lines[place];
    let errors = FilmRole::ALL
        .into_iter()
        .filter_map(|role| Some((role.key().to_owned(), found.errors(place, role)?)));
    let record = LineRecord {
        fitted_to: line.target.key().to_owned(),
        numbers: NumbersRecord::new(&line.numbers),
        errors: errors.collect(),
        with_tilt_mm: by_role(found, FilmPredictor::LineWithTilt(line.kind)),
    };
    (line.kind.key().to_owned(), record)
}

impl NumbersRecord {
    pub fn new(numbers: &FreeNumbers) -> Self {
        Self {
            multipliers: numbers.multipliers,
            forces: numbers.forces,
            line: numbers.line,
            fitted: numbers.fitted(),
            per_predicted_film: numbers.per_predicted_film,
        }
    }
}

fn film(
    film: &ComparedFilm,
    bands: &FilmBands,
    found: &LinesCompared,
    levels: Levels,
) -> FilmRecord {
    let band = |(by, band): &(FilmPredictor, Band)| (by.key(), BandRecord::new(band, levels));
    let by_line = |by: fn(LineKind) -> FilmPredictor| {
        found.lines.iter().map(move |line| {
            let mm = found.shape(film, by(line.kind)).map(FilmShape::mean_location_error_mm);
            (line.kind.key().to_owned(), mm)
        })
    };
    let with_tilt = by_line(FilmPredictor::LineWithTilt).filter(|_| film.role != FilmRole::Fitted);
    FilmRecord {
        posture: film.posture,
        role: film.role.key().to_owned(),
        location_mm: by_line(FilmPredictor::Line).collect(),
        with_tilt_mm: with_tilt.collect(),
        baselines: film.baselines.iter().map(baseline).collect(),
        band_95: bands.bands.iter().map(band).collect(),
    }
}

fn baseline(found: &BaselinePrediction) -> (String, BaselineRecord) {
    let record = BaselineRecord {
        status: found.status.key().to_owned(),
        amount: found.amount,
        scale: found.shape.scale.into(),
        location_mm: found.shape.mean_location_error_mm(),
    };
    (found.baseline.key().to_owned(), record)
}

fn compatibility(found: &Compatibility) -> CompatibilityRecord {
    let bend = |bend: &BendEvidence| BendRecord {
        posture: bend.posture,
        outcome: bend.outcome(),
        joints: bend.joints,
        against: bend.against,
        beyond_noise: bend.beyond_noise,
        weight: bend.weight,
        joints_p_holm: bend.joints_p,
        joints_reject: bend.joints_reject(),
        line_p_holm: bend.line_p,
        line_rejects: bend.line_rejects(),
    };
    CompatibilityRecord {
        outcome: found.outcome(),
        tests: found.tests,
        bends: found.bends.iter().map(bend).collect(),
        without_force: found.without_force.clone(),
    }
}
