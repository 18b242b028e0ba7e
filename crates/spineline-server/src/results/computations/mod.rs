//! What takes longer than a page waits, computed in the background with progress and cancel.

mod kept;
mod models;
pub mod replicates;
mod view;

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::extract::State;
use axum::http::StatusCode;
use spineline_store::Role;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::{open_study, study_result};
use crate::api::{ComputationName, ComputationRequest, ComputationView, Problem};
use crate::computation_jobs::{ComputationJob, Found, JobKind};
use crate::extract::{Json, Path};
use crate::jobs::Job;
use crate::problem::{Answer, Failure};
use crate::result_cache::{StudyResult, computed};
use crate::state::AppState;
use crate::user::User;
pub use kept::{inputs_with, recall};
use view::view;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(computation, compute, cancel))
}

const fn kind_of(name: ComputationName) -> JobKind {
    match name {
        ComputationName::Replicates => JobKind::Replicates,
        ComputationName::Identifiability => JobKind::Identifiability,
        ComputationName::Models => JobKind::Models,
    }
}

/// A computation of the current results.
#[utoipa::path(get, path = "/api/studies/{study}/computations/{computation}",
    params(("study" = String, Path), ("computation" = ComputationName, Path)),
    responses((status = 200, body = ComputationView), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn computation(
    State(state): State<AppState>,
    user: User,
    Path((study, name)): Path<(String, ComputationName)>,
) -> Answer<Json<ComputationView>> {
    let result = analysed(&state, &user, &study, Role::Reader).await?;
    recall(&state, &result).await?;
    let job = state.jobs().of(&result, kind_of(name));
    computed(move || view(name, job.as_deref())).await.map(Json)
}

/// Computes in the background, from the current results.
#[utoipa::path(post, path = "/api/studies/{study}/computations/{computation}",
    params(("study" = String, Path), ("computation" = ComputationName, Path)),
    request_body = ComputationRequest,
    responses((status = 200, body = ComputationView), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn compute(
    State(state): State<AppState>,
    user: User,
    Path((study, name)): Path<(String, ComputationName)>,
    Json(request): Json<ComputationRequest>,
) -> Answer<Json<ComputationView>> {
    let result = analysed(&state, &user, &study, Role::Editor).await?;
    let kind = kind_of(name);
    let asked = steps(&result, kind, &request)?;
    let job = state.jobs().begin(&result, (kind, ()), asked).ok_or_else(|| {
        Failure::new(StatusCode::CONFLICT, "running", "this is being computed")
            .help("wait for it, or cancel it")
    })?;
    tokio::spawn(run(state, kind, Arc::clone(&job)));
    Ok(Json(view(name, Some(&job))))
}

/// Cancels a computation after its running step.
#[utoipa::path(delete, path = "/api/studies/{study}/computations/{computation}",
    params(("study" = String, Path), ("computation" = ComputationName, Path)),
    responses((status = 200, body = ComputationView), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn cancel(
    State(state): State<AppState>,
    user: User,
    Path((study, name)): Path<(String, ComputationName)>,
) -> Answer<Json<ComputationView>> {
    let result = analysed(&state, &user, &study, Role::Editor).await?;
    let job = state.jobs().of(&result, kind_of(name));
    if let Some(job) = &job {
        job.cancel();
    }
    computed(move || view(name, job.as_deref())).await.map(Json)
}

/// The results of a study that the user may see, with at least this role.
pub async fn analysed(
    state: &AppState,
    user: &User,
    study: &str,
    least: Role,
) -> Answer<Arc<StudyResult>> {
    let study = open_study(state, user, study).await?;
    let (asker, of) = (user.clone(), study.clone());
    state.ask(move |store| asker.need_on_study(store, &of, least)).await?;
    let result = study_result(state, &study).await?;
    result.analysed()?;
    Ok(result)
}

/// How many steps a computation has.
fn steps(result: &StudyResult, kind: JobKind, request: &ComputationRequest) -> Answer<u64> {
    let refused = |text: String, help: &str| {
        Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "refused", text).help(help)
    };
    match (kind, request.count) {
        (JobKind::Replicates, count) => replicates::checked(count.unwrap_or_default()),
        (_, Some(_)) => Err(refused(
            "a number of replicates is given for something else".to_owned(),
            "leave `count` out",
        )),
        (_, None) if result.analysed()?.models.is_empty() => {
            Err(refused("this study has no model".to_owned(), "add a bending film, and read it"))
        }
        (JobKind::Identifiability, None) => Ok(result.analysed()?.models.len() as u64),
        (JobKind::Models, None) => Ok(models::steps()),
    }
}

async fn run(state: AppState, kind: JobKind, job: Arc<ComputationJob>) {
    let found = match kind {
        JobKind::Replicates => replicates::all(&state, &job).await,
        JobKind::Identifiability => identifiability(&state, &job).await,
        JobKind::Models => models::all(&state, &job).await,
    };
    let found = match found {
        Ok(Some(found)) => kept::keep(&state, &job, found).await.map(Some),
        other => other,
    };
    job.end(found);
}

/// One step after another in its turn, each with its number; `None` where they were cancelled.
pub async fn in_turns<Work, Found, T>(
    state: &AppState,
    job: &Arc<Job<Work, Found>>,
    block: u64,
    work: impl Fn(&Job<Work, Found>, Range<u64>) -> Answer<Vec<T>> + Clone + Send + 'static,
) -> Answer<Option<Vec<T>>>
where
    Work: Send + Sync + 'static,
    Found: Send + Sync + 'static,
    T: Send + 'static,
{
    let mut found = Vec::new();
    for start in (0..job.asked).step_by(usize::try_from(block).unwrap_or(1)) {
        // The semaphore is never closed.
        let _turn = state.jobs().turns.acquire().await;
        if job.is_cancelled() {
            return Ok(None);
        }
        let (of, work) = (Arc::clone(job), work.clone());
        let end = job.asked.min(start + block);
        found.extend(computed(move || work(&of, start..end)).await??);
        job.done.store(end, Ordering::Relaxed);
    }
    Ok(Some(found))
}

/// What the films say of the multipliers, one model of a line after another.
async fn identifiability(state: &AppState, job: &Arc<ComputationJob>) -> Answer<Option<Found>> {
    let found = in_turns(state, job, 1, |job, places| {
        let analysis = job.result.analysed()?;
        let models = places.filter_map(|place| analysis.models.get(usize::try_from(place).ok()?));
        Ok(models.map(|model| analysis.identifiability(model)).collect())
    });
    Ok(found.await?.map(Found::Identifiability))
}
