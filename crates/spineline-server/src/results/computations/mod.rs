//! Long computations, in the background with progress and cancel.

mod kept;
mod models;
pub mod replicates;
mod view;

use std::sync::Arc;

use axum::extract::State;
use spineline_store::KeptComputation;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::background::{Task, in_turns, start};
use crate::access::{EditorResult, OpenResult};
use crate::api::{
    Computation, ComputationName, ComputationRequest, ComputationView, Problem, Wire,
};
use crate::extract::{Json, Path, WithBody};
use crate::jobs::{ComputationJob, Found, Jobs};
use crate::problem::{Answer, Failure};
use crate::result_cache::{StudyResult, computed};
use crate::state::AppState;
pub use kept::{inputs_with, recall};
use view::view;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(computation, compute, cancel))
}

/// A computation of the current results.
#[utoipa::path(get, path = "/api/studies/{study}/computations/{computation}",
    params(("study" = String, Path), ("computation" = ComputationName, Path)),
    responses((status = 200, body = ComputationView), Problem))]
async fn computation(
    State(state): State<AppState>,
    OpenResult(result): OpenResult,
    Path((_, Wire(name))): Path<(String, ComputationName)>,
) -> Answer<Json<ComputationView>> {
    result.analysed()?;
    recall(&state, &result).await?;
    let job = state.jobs.of(&result, name.key());
    computed(move || view(name, job.as_deref())).await.map(Json)
}

/// Computes in the background, from the current results.
#[utoipa::path(post, path = "/api/studies/{study}/computations/{computation}",
    params(("study" = String, Path), ("computation" = ComputationName, Path)),
    request_body = ComputationRequest,
    responses((status = 200, body = ComputationView), Problem))]
async fn compute(
    State(state): State<AppState>,
    Path((_, Wire(name))): Path<(String, ComputationName)>,
    WithBody(Json(request), EditorResult(result)): WithBody<Json<ComputationRequest>, EditorResult>,
) -> Answer<Json<ComputationView>> {
    let asked = steps(&result, name, &request)?;
    let job = start(&state, &result, name, asked)?;
    Ok(Json(view(name, Some(&job))))
}

/// Cancels a computation after its running step.
#[utoipa::path(delete, path = "/api/studies/{study}/computations/{computation}",
    params(("study" = String, Path), ("computation" = ComputationName, Path)),
    responses((status = 200, body = ComputationView), Problem))]
async fn cancel(
    State(state): State<AppState>,
    EditorResult(result): EditorResult,
    Path((_, Wire(name))): Path<(String, ComputationName)>,
) -> Answer<Json<ComputationView>> {
    let job = state.jobs.of(&result, name.key());
    if let Some(job) = &job {
        job.cancel();
    }
    computed(move || view(name, job.as_deref())).await.map(Json)
}

/// How many steps a computation has.
fn steps(result: &StudyResult, name: Computation, request: &ComputationRequest) -> Answer<u64> {
    let refused = |text: String, help: &str| Failure::refused(text).help(help);
    match (name, request.count) {
        (Computation::Replicates, Some(count)) => replicates::checked(count),
        (Computation::Replicates, None) => Err(refused(
            "the number of replicates is missing".to_owned(),
            "give it as `count`, such as 1000",
        )),
        (_, Some(_)) => Err(refused(
            "only replicates take a number of replicates".to_owned(),
            "leave `count` out",
        )),
        (_, None) if result.analysed()?.models.is_empty() => {
            Err(refused("this study has no model".to_owned(), "add a bending film, and read it"))
        }
        (Computation::Identifiability, None) => Ok(result.analysed()?.models.len() as u64),
        (Computation::Models, None) => Ok(models::steps()),
    }
}

impl Task for Computation {
    const RUNNING: [&'static str; 2] = ["this is being computed", "wait for it, or cancel it"];

    fn jobs(state: &AppState) -> &Jobs<Self> {
        &state.jobs
    }

    async fn run(state: &AppState, job: &Arc<ComputationJob>) -> Answer<Option<Found>> {
        match job.work {
            Self::Replicates => replicates::all(state, job).await,
            Self::Identifiability => identifiability(state, job).await,
            Self::Models => models::all(state, job).await,
        }
    }

    fn kept(job: &ComputationJob, found: &Found) -> Option<KeptComputation> {
        kept::written(job, found)
    }
}

/// The identifiability of the multipliers, model by model.
async fn identifiability(state: &AppState, job: &Arc<ComputationJob>) -> Answer<Option<Found>> {
    let found = in_turns(state, job, 1, |job, places| {
        let analysis = job.result.analysed()?;
        let models = places.filter_map(|place| analysis.models.get(usize::try_from(place).ok()?));
        Ok(models.map(|model| analysis.identifiability(model)).collect())
    });
    Ok(found.await?.map(Found::Identifiability))
}
