//! The effect of one pad at every level: tried on all cores in the background, with progress and cancel.

mod view;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::extract::State;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use spineline::response::{OtherLoads, PadEffect, PadTrial, go_on, try_pad};
use spineline_files::LoadFile;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::background::{Task, start};
use super::loads::{check_count, personalised_model};
use crate::access::{EditorResult, OpenResult};
use crate::api::{LineKindName, PadMapRequest, PadMapView, Problem};
use crate::extract::{Json, Path, WithBody};
use crate::jobs::{Jobs, PadMapJob, PadMapWork};
use crate::problem::{Answer, Failure};
use crate::result_cache::{StudyResult, computed};
use crate::state::AppState;
use view::{STEPS, view};

/// More than any pad pushes, and the stiffest of them.
const MAX_FORCE: f64 = 10_000.0;
const MAX_PER_MM: f64 = 1_000.0;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(pad_map, compute_pad_map, cancel_pad_map))
}

/// The pads that were tried on the model of a line of action.
#[utoipa::path(get, path = "/api/studies/{study}/loads/{line}/pad-map",
    params(("study" = String, Path), ("line" = LineKindName, Path)),
    responses((status = 200, body = PadMapView), Problem))]
async fn pad_map(
    State(state): State<AppState>,
    OpenResult(result): OpenResult,
    Path((_, line)): Path<(String, LineKindName)>,
) -> Answer<Json<PadMapView>> {
    result.analysed()?;
    Ok(Json(view(map_of(&state, &result, line).as_deref())))
}

/// Tries pads in the background.
#[utoipa::path(post, path = "/api/studies/{study}/loads/{line}/pad-map",
    params(("study" = String, Path), ("line" = LineKindName, Path)), request_body = PadMapRequest,
    responses((status = 200, body = PadMapView), Problem))]
async fn compute_pad_map(
    State(state): State<AppState>,
    Path((_, line)): Path<(String, LineKindName)>,
    WithBody(Json(request), EditorResult(result)): WithBody<Json<PadMapRequest>, EditorResult>,
) -> Answer<Json<PadMapView>> {
    check("largest force", request.largest_force, MAX_FORCE)?;
    check("stiffness per mm", request.n_per_mm, MAX_PER_MM)?;
    let of = Arc::clone(&result);
    let model = computed(move || personalised_model(&of, line)).await??;
    let others = LoadFile::new(request.beside.iter().map(|load| load.0.clone()).collect());
    check_count(&others)?;
    let others = others.place(&model).map_err(|error| Failure::of(&error))?.loading;
    let trials = PadTrial::all(model.levels.len(), request.largest_force, STEPS);
    let asked = trials.len() as u64;
    let work = PadMapWork { line, request, others, model, trials };
    let job = start(&state, &result, work, asked)?;
    Ok(Json(view(Some(&job))))
}

/// Cancels the trials after the running ones.
#[utoipa::path(delete, path = "/api/studies/{study}/loads/{line}/pad-map",
    params(("study" = String, Path), ("line" = LineKindName, Path)),
    responses((status = 200, body = PadMapView), Problem))]
async fn cancel_pad_map(
    State(state): State<AppState>,
    EditorResult(result): EditorResult,
    Path((_, line)): Path<(String, LineKindName)>,
) -> Answer<Json<PadMapView>> {
    let job = map_of(&state, &result, line);
    if let Some(job) = &job {
        job.cancel();
    }
    Ok(Json(view(job.as_deref())))
}

/// The map of this line; `None` if the map belongs to another line.
fn map_of(
    state: &AppState,
    result: &Arc<StudyResult>,
    line: LineKindName,
) -> Option<Arc<PadMapJob>> {
    state.pad_maps.of(result, PadMapWork::KEY).filter(|job| job.work.line == line)
}

fn check(what: &str, value: f64, limit: f64) -> Answer<()> {
    if value > 0.0 && value <= limit {
        return Ok(());
    }
    let text = format!("{what}: {value}; it must be above 0 and at most {limit}");
    Err(Failure::refused(text).help("correct this number"))
}

impl Task for PadMapWork {
    const RUNNING: [&'static str; 2] =
        ["pads are being tried on this study", "wait for them, or cancel them"];

    fn jobs(state: &AppState) -> &Jobs<Self> {
        &state.pad_maps
    }

    async fn run(state: &AppState, job: &Arc<PadMapJob>) -> Answer<Option<Vec<PadEffect>>> {
        // The semaphore is never closed.
        let _turn = state.pad_maps.turns.acquire().await;
        let of = Arc::clone(job);
        computed(move || tried(&of)).await.and_then(|found| found)
    }
}

/// The effects of all pads, in the order of the trials; `None` where they were cancelled.
fn tried(job: &PadMapJob) -> Answer<Option<Vec<PadEffect>>> {
    let PadMapWork { model, trials, others, .. } = &job.work;
    let unusable = |text: String| Failure::refused(text).help("read the notices of the model");
    let statics = model.statics().map_err(|error| unusable(error.to_string()))?;
    let places = model.curves.as_deref().unwrap_or_default();
    let others = OtherLoads::new(&statics, others.clone(), &mut go_on).map_err(|error| {
        Failure::refused(error.to_string())
            .help("change the loads of the plan, or try the pads alone")
    })?;
    let effect_of = |trial: PadTrial| {
        let mut on_point = |_, _: &_| {
            if job.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let effect = try_pad(&statics, &others, places, trial, &mut on_point);
        job.done.fetch_add(1, Ordering::Relaxed);
        effect
    };
    // A pool of the map alone: PDFs and demos use the shared one, and would wait for the whole map.
    let pool = ThreadPoolBuilder::new()
        .build()
        .map_err(|error| Failure::internal(format!("threads could not be started: {error}")))?;
    let found: Vec<_> = pool.install(|| {
        trials.par_iter().map(|&trial| (!job.is_cancelled()).then(|| effect_of(trial))).collect()
    });
    if job.is_cancelled() {
        return Ok(None);
    }
    let effects = found.into_iter().flatten().collect::<Result<Vec<PadEffect>, _>>();
    effects.map(Some).map_err(|error| unusable(error.to_string()))
}
