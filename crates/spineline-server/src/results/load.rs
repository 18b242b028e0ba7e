//! Response of the personalised spine to a dragged force.

use spineline::analysis::{Analysis, LineModel};
use spineline::anatomy::Level;
use spineline::multibody::{BodyLoad, Deformed, GeneralStatics, Goal, Loading};
use spineline::number::fixed;
use spineline::response::{
    CurveChange, erect_shape, go_on, largest_displacement_mm, measure_angles, respond,
};
use spineline::spatial::{Vec3, vector_words};

use super::loads::fitted_model;
use super::simulated::deformed_shape;
use crate::access::OpenResult;
use crate::api::{LoadAnswer, LoadRequest, Problem};
use crate::extract::{Json, WithBody};
use crate::problem::{Answer, Failure};
use crate::result_cache::{StudyResult, computed};

/// Longer arrows are refused as input errors.
const MAX_ARROW_MM: f64 = 5_000.0;

/// The response to a dragged load.
#[utoipa::path(post, path = "/api/studies/{study}/load", params(("study" = String, Path)),
    request_body = LoadRequest,
    responses((status = 200, body = LoadAnswer), Problem))]
pub async fn load(
    WithBody(Json(request), OpenResult(result)): WithBody<Json<LoadRequest>, OpenResult>,
) -> Answer<Json<LoadAnswer>> {
    computed(move || answer(&result, &request)).await?.map(Json)
}

fn answer(result: &StudyResult, request: &LoadRequest) -> Answer<LoadAnswer> {
    let (analysis, model) = fitted_model(result, request.kind)?;
    let movable =
        analysis.movement.levels().iter().skip(1).position(|level| level.name() == request.level);
    let vertebra = 1 + movable.ok_or_else(|| {
        Failure::refused(format!("{:?} cannot carry a load", request.level)).help(
            "loads act on the vertebrae of the model above the fixed one, L3 to T2 where all are marked",
        )
    })?;
    let force_n = Vec3::from(request.tip_mm) - analysis.movement.spine.midpoints_mm[vertebra];
    let size = force_n.norm();
    if size.is_nan() || size > MAX_ARROW_MM {
        let length = if size.is_finite() {
            format!("{} mm long", fixed(size, 0))
        } else {
            "too long to be measured".to_owned()
        };
        let text = format!("the arrow is {length}; the limit is {} mm", fixed(MAX_ARROW_MM, 0));
        return Err(Failure::refused(text).help("drag a shorter arrow"));
    }
    loaded(analysis, model, vertebra, force_n)
}

/// The shape and its load factor.
struct Found {
    deformed: Deformed,
    part: f64,
    status_text: String,
    converged: bool,
}

fn loaded(
    analysis: &Analysis,
    model: &LineModel,
    vertebra: usize,
    force_n: Vec3,
) -> Answer<LoadAnswer> {
    let spine = &analysis.movement.spine;
    let erect = erect_shape(spine);
    let found = if force_n == Vec3::zeros() {
        let status_text = "No load: the erect shape".to_owned();
        Found { deformed: erect.clone(), part: 1.0, status_text, converged: true }
    } else {
        equilibrium(analysis, model, vertebra, force_n, &erect)?
    };
    Ok(LoadAnswer {
        converged: found.converged,
        status_text: found.status_text,
        load_text: load_text(
            analysis,
            model,
            analysis.movement.levels().as_slice()[vertebra],
            force_n,
        ),
        part: found.part,
        texts: texts(analysis, &erect, &found.deformed),
        shape: deformed_shape(spine, &found.deformed),
    })
}

fn equilibrium(
    analysis: &Analysis,
    model: &LineModel,
    vertebra: usize,
    force_n: Vec3,
    erect: &Deformed,
) -> Answer<Found> {
    let springs = model.stiffness_matrices(&analysis.movement.library);
    let statics = GeneralStatics::new(&analysis.movement.spine, springs, analysis.options.support)
        .map_err(|error| {
            Failure::refused(error.to_string()).help("read the notices of the model")
        })?;
    let loading = Loading::single(vertebra, BodyLoad::at_midpoint(force_n));
    let response = respond(&statics, &loading, Goal::FullLoad, 1.0, &mut go_on)
        .map_err(|error| Failure::of(&error))?;
    if let Some(result) = response.result() {
        let status_text = "Equilibrium, reached from the erect spine".to_owned();
        let deformed = result.deformed.clone();
        return Ok(Found { deformed, part: 1.0, status_text, converged: true });
    }
    let (part, deformed) = response.last_reached(&analysis.movement.spine).unwrap_or((0.0, erect));
    let status_text = format!(
        "Not a result: {}. The shape at {} % of the load is shown",
        response.ending.meaning(),
        fixed(100.0 * part, 0)
    );
    Ok(Found { deformed: deformed.clone(), part, status_text, converged: false })
}

fn load_text(analysis: &Analysis, model: &LineModel, level: Level, force_n: Vec3) -> String {
    let (size, way) = (force_n.norm(), vector_words(force_n.into()));
    if model.is_absolute(analysis.options.gauge) {
        return format!("{} N at the midpoint of {level}: {way}", fixed(size, 0));
    }
    format!(
        "Relative force {} at the midpoint of {level}: {way}; no force was measured: it is relative to the nominal stiffness, only shapes and ratios are meaningful",
        fixed(size, 0)
    )
}

fn texts(analysis: &Analysis, erect: &Deformed, shape: &Deformed) -> Vec<String> {
    let (vertebra, moved_mm) = largest_displacement_mm(&analysis.movement.spine, shape);
    let levels = analysis.movement.levels();
    let level = levels.as_slice()[vertebra];
    let places = analysis.movement.curve_places();
    let [before, after] = [erect, shape].map(|shape| measure_angles(shape, &places));
    let mut texts = vec![format!("{level} moves most: {} mm", fixed(moved_mm, 1))];
    texts.extend(CurveChange::between(&before, &after).map(|change| {
        let CurveChange { region, before, after, .. } = change;
        format!("{region} curve: {} {after} instead of {before}", change.size_name())
    }));
    texts.push(format!(
        "lateral tilt of {}–{} against {0}'s axis: {}",
        levels.base(),
        levels.top(),
        after.lateral_tilt.leaning()
    ));
    texts
}
