//! The personalised models of a study in 3D.

use spineline::analysis::{Analysis, LineModel, MultiplierEnding, MultiplierVerdict};
use spineline::anatomy::Level;
use spineline::measure::SpacingPlane;
use spineline::personalize::FitStatus;

use super::loads::RELATIVE_SYMBOL;
use super::notices;
use super::simulated::{deformed_shape, shape, simulated};
use crate::access::OpenResult;
use crate::api::{
    BodySize, Identified, JointView, LineModelView, MeasuredShape, ModelView, MultiplierView,
    Notice, PostureName, Problem, Severity, Wire,
};
use crate::extract::Json;
use crate::problem::Answer;
use crate::result_cache::{StudyResult, computed};

/// The models of a study.
#[utoipa::path(get, path = "/api/studies/{study}/model", params(("study" = String, Path)),
    responses((status = 200, body = ModelView), Problem))]
pub async fn model(OpenResult(result): OpenResult) -> Answer<Json<ModelView>> {
    computed(move || result.analysed().map(|analysis| view(&result, analysis))).await?.map(Json)
}

fn view(result: &StudyResult, analysis: &Analysis) -> ModelView {
    let movement = &analysis.movement;
    let erect = spineline::response::erect_shape(&movement.spine);
    let moved = movement.films.iter().skip(1);
    let relative = analysis.relative_stiffness();
    let lines = analysis.models.iter().zip(&relative);
    let is_absolute = |model: &LineModel| model.is_absolute(analysis.options.gauge);
    let absolute = !analysis.models.is_empty() && analysis.models.iter().all(is_absolute);
    let automatic = analysis.choose_model();
    ModelView {
        study: result.study.to_string(),
        synthetic: analysis.synthetic,
        profile_text: analysis.profile_words().to_owned(),
        gauge_text: analysis.gauge_words().to_owned(),
        options_text: result.options_text(),
        length_unit: match movement.scale().plane {
            SpacingPlane::Pixels => "mm, for a spine of typical length",
            plane => plane.unit(),
        }
        .to_owned(),
        bodies: bodies(analysis),
        pitch_from: movement
            .levels()
            .iter()
            .map(|level| Wire(analysis.pitch_source(level)))
            .collect(),
        erect: deformed_shape(&movement.spine, &erect),
        measured: moved
            .map(|posture| {
                let (midpoints_mm, axes) =
                    movement.spine.posed_on_film(&posture.outline, &movement.erect().outline);
                MeasuredShape {
                    posture: Wire(posture.outline.posture),
                    shape: shape(&movement.spine, &midpoints_mm, &axes),
                }
            })
            .collect(),
        lines: lines.map(|(model, relative)| line(analysis, model, relative)).collect(),
        force_symbol: if absolute { "N" } else { RELATIVE_SYMBOL }.to_owned(),
        force_unit_text: if absolute { "1 N" } else { "a relative force of 1, not 1 newton" }
            .to_owned(),
        automatic: automatic.as_ref().map(|choice| Wire(choice.kind)),
        automatic_text: automatic.map(|choice| choice.words),
        verdict: analysis.verdict(),
        notices: model_notices(result, analysis),
    }
}

fn bodies(analysis: &Analysis) -> Vec<BodySize> {
    let body = |(level, size): (Level, spineline::multibody::BodySize)| BodySize {
        level: level.to_string(),
        width_mm: size.width_mm,
        depth_mm: size.depth_mm,
        height_mm: size.height_mm,
    };
    analysis.movement.levels().iter().zip(analysis.body_sizes()).map(body).collect()
}

fn line(analysis: &Analysis, model: &LineModel, relative: &[f64]) -> LineModelView {
    let converged = model.fit.status == FitStatus::Converged
        && model.simulations.iter().all(spineline::evaluate::Simulation::is_usable);
    LineModelView {
        kind: Wire(model.kind),
        label: model.kind.to_string(),
        converged,
        status_text: analysis.fit_words(model),
        multipliers: multipliers(analysis, model),
        joints: joints(analysis, model, relative),
        postures: model.simulations.iter().map(|s| simulated(analysis, model, s)).collect(),
        fitted_error_mm: model.mean_location_error_mm(true),
        held_out_error_mm: model.mean_location_error_mm(false),
    }
}

fn multipliers(analysis: &Analysis, model: &LineModel) -> Vec<MultiplierView> {
    let verdicts = model.verdicts(analysis);
    let named = model.groups.titles().zip(model.multipliers()).zip(&verdicts);
    let view = |((name, factor), verdict): ((String, f64), &MultiplierVerdict)| MultiplierView {
        label: name,
        factor: factor * model.fit.absolute_scale,
        identified: match verdict.ending {
            MultiplierEnding::Absolute => Identified::Absolute,
            MultiplierEnding::Ratio => Identified::RatioOnly,
            MultiplierEnding::AtBound(_) | MultiplierEnding::OthersAtBounds => Identified::Bound,
            MultiplierEnding::Contradicted => Identified::Contradicted,
            MultiplierEnding::NotConverged => Identified::NotConverged,
        },
        text: verdict.to_string(),
    };
    named.map(view).collect()
}

fn joints(analysis: &Analysis, model: &LineModel, relative: &[f64]) -> Vec<JointView> {
    let pairs = analysis.movement.levels().joint_pairs().zip(relative).enumerate();
    let view = |(joint, (pair, &relative)): (usize, ([Level; 2], &f64))| JointView {
        label: format!("{}/{}", pair[0], pair[1]),
        relative,
        text: analysis.spring_words(model, joint),
        contradicted_in: contradicted_in(model, pair[0]),
    };
    pairs.map(view).collect()
}

fn contradicted_in(model: &LineModel, inferior: Level) -> Vec<PostureName> {
    let turns = |s: &&spineline::evaluate::Simulation| {
        s.is_usable() && s.contradicted.iter().any(|joint| joint.inferior == inferior)
    };
    model.simulations.iter().filter(turns).map(|s| Wire(s.shape.posture)).collect()
}

/// The notices of a study, with a warning if its lengths are typical and not measured.
fn model_notices(result: &StudyResult, analysis: &Analysis) -> Vec<Notice> {
    let mut notices = notices::with_comparison(result);
    if !analysis.movement.scale().has_millimetres() {
        let text = "the erect film has no spacing: the spine is drawn with a typical length";
        notices.push(Notice::new(Severity::Contradiction, "drawn_typical", text));
    }
    notices::sorted(notices)
}
