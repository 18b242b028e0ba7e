//! Intervals of a model under loads by landmark noise: replicates in the background, with progress and cancel.

mod kept;

use std::sync::Arc;

use axum::extract::State;
use spineline::uncertainty::{LoadedReplicate, LoadedUncertainty};
use spineline_store::KeptComputation;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::background::{Task, in_turns, start};
use super::computations::replicates::{BLOCK, checked, with_monte_carlo};
use super::loads::{simulated_file, tables};
use crate::access::{EditorResult, OpenResult};
use crate::api::{LineKindName, LoadIntervalRequest, LoadIntervalRow, LoadIntervalsView, Problem};
use crate::extract::{Json, Path, WithBody};
use crate::jobs::{Jobs, LoadIntervalJob, LoadIntervalWork, progress};
use crate::problem::{Answer, Failure};
use crate::result_cache::computed;
use crate::state::AppState;
pub use kept::recall;
use kept::tally;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(load_intervals, compute_load_intervals, cancel_intervals))
}

/// Intervals of the model of a line of action under loads, with the load file that they belong to.
#[utoipa::path(get, path = "/api/studies/{study}/loads/{line}/intervals",
    params(("study" = String, Path), ("line" = LineKindName, Path)),
    responses((status = 200, body = LoadIntervalsView), Problem))]
async fn load_intervals(
    State(state): State<AppState>,
    OpenResult(result): OpenResult,
    Path((_, line)): Path<(String, LineKindName)>,
) -> Answer<Json<LoadIntervalsView>> {
    result.analysed()?;
    recall(&state, &result).await?;
    let job = state.load_intervals.of_line(&result, line);
    computed(move || view(job.as_deref())).await.map(Json)
}

/// Computes intervals in the background.
#[utoipa::path(post, path = "/api/studies/{study}/loads/{line}/intervals",
    params(("study" = String, Path), ("line" = LineKindName, Path)),
    request_body = LoadIntervalRequest,
    responses((status = 200, body = LoadIntervalsView), Problem))]
async fn compute_load_intervals(
    State(state): State<AppState>,
    Path((_, line)): Path<(String, LineKindName)>,
    WithBody(Json(request), EditorResult(result)): WithBody<
        Json<LoadIntervalRequest>,
        EditorResult,
    >,
) -> Answer<Json<LoadIntervalsView>> {
    let asked = checked(request.count)?;
    let (of, file) = (Arc::clone(&result), request.file);
    let work = computed(move || {
        let simulated = simulated_file(&of, line, &file)?;
        Ok::<_, Failure>(LoadIntervalWork { line, file, simulated })
    });
    let job = start(&state, &result, work.await??, asked)?;
    Ok(Json(view(Some(&job))))
}

/// Cancels the replicates after the running ones.
#[utoipa::path(delete, path = "/api/studies/{study}/loads/{line}/intervals",
    params(("study" = String, Path), ("line" = LineKindName, Path)),
    responses((status = 200, body = LoadIntervalsView), Problem))]
async fn cancel_intervals(
    State(state): State<AppState>,
    EditorResult(result): EditorResult,
    Path((_, line)): Path<(String, LineKindName)>,
) -> Answer<Json<LoadIntervalsView>> {
    let job = state.load_intervals.of_line(&result, line);
    if let Some(job) = &job {
        job.cancel();
    }
    computed(move || view(job.as_deref())).await.map(Json)
}

impl Task for LoadIntervalWork {
    const RUNNING: [&'static str; 2] =
        ["intervals are being computed on this study", "wait for them, or cancel them"];

    fn jobs(state: &AppState) -> &Jobs<Self> {
        &state.load_intervals
    }

    async fn run(
        state: &AppState,
        job: &Arc<LoadIntervalJob>,
    ) -> Answer<Option<LoadedUncertainty>> {
        all(state, job).await
    }

    fn kept(job: &LoadIntervalJob, found: &LoadedUncertainty) -> Option<KeptComputation> {
        kept::written(job, found).ok()
    }
}

/// All replicates, block by block; `None` where they were cancelled.
async fn all(state: &AppState, job: &Arc<LoadIntervalJob>) -> Answer<Option<LoadedUncertainty>> {
    let found = in_turns(state, job, BLOCK, |job, places| {
        let loads = job.work.simulated.on_replicates(job.work.line.0, None);
        with_monte_carlo(&job.result, |monte_carlo| -> Vec<LoadedReplicate> {
            places.map(|index| monte_carlo.loaded_replicate(index, &loads)).collect()
        })
    });
    let Some(found) = found.await? else { return Ok(None) };
    let of = Arc::clone(job);
    let uncertainty = computed(move || {
        tally(&of.result, &of.work, |mut tally| {
            found.iter().for_each(|replicate| tally.add(replicate));
            tally.finish(of.asked)
        })
    });
    uncertainty.await?.map(Some)
}

/// State, progress and intervals.
fn view(job: Option<&LoadIntervalJob>) -> LoadIntervalsView {
    let (progress, found) = progress(job);
    let mut view = LoadIntervalsView {
        progress,
        file: job.map(|job| job.work.file.clone()).unwrap_or_default(),
        rows: Vec::new(),
    };
    if let Some((job, found)) = job.zip(found)
        && let Some(analysis) = job.result.analysis()
    {
        let rows = tables(analysis, &job.work.simulated, Some(found)).intervals();
        let row = |(label, intervals): (String, [String; 3])| LoadIntervalRow {
            label,
            intervals: intervals.to_vec(),
        };
        view.rows = rows.into_iter().map(row).collect();
        view.progress.texts = found.words();
    }
    view
}
