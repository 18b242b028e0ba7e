//! Intervals of a study's results by landmark noise: replicates in the background, with progress and cancel.

mod view;

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::extract::State;
use axum::http::StatusCode;
use spineline::uncertainty::{LandmarkNoise, MonteCarlo, Replicate, Uncertainty};
use spineline_store::Role;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::{open_study, study_result};
use crate::api::{Problem, ReplicatesRequest, ReplicatesView};
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::replicate_jobs::{Ending, Job};
use crate::result_cache::{StudyResult, computed};
use crate::session::User;
use crate::state::AppState;
use view::view;

/// Seed of the random streams, as that of the command line.
const SEED: u64 = 1;
const MAX_COUNT: u64 = 2000;
/// Replicates between two looks at the progress: a cancel waits for them.
const BLOCK: u64 = 4;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(replicates, compute, cancel))
}

/// The replicates of the current results.
#[utoipa::path(get, path = "/api/studies/{study}/replicates", params(("study" = String, Path)),
    responses((status = 200, body = ReplicatesView), (status = 403, body = Problem),
        (status = 409, body = Problem)))]
async fn replicates(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<ReplicatesView>> {
    let result = analysed(&state, &user, &study, Role::Reader).await?;
    Ok(Json(view(state.replicates().of(&result).as_deref())))
}

/// Computes replicates of the current results in the background.
#[utoipa::path(post, path = "/api/studies/{study}/replicates", params(("study" = String, Path)),
    request_body = ReplicatesRequest,
    responses((status = 200, body = ReplicatesView), (status = 403, body = Problem),
        (status = 409, body = Problem), (status = 422, body = Problem)))]
async fn compute(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
    Json(request): Json<ReplicatesRequest>,
) -> Answer<Json<ReplicatesView>> {
    let result = analysed(&state, &user, &study, Role::Editor).await?;
    if !(1..=MAX_COUNT).contains(&request.count) {
        let text = format!("{} replicates; the limit is 1 to {MAX_COUNT}", request.count);
        return Err(Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "refused", text)
            .help("the command line computes more: `analyze --replicates`"));
    }
    let job = state.replicates().begin(&result, request.count).ok_or_else(|| {
        Failure::new(StatusCode::CONFLICT, "running", "the replicates are being computed")
            .help("wait for them, or cancel them")
    })?;
    tokio::spawn(run(state, Arc::clone(&job)));
    Ok(Json(view(Some(&job))))
}

/// Cancels the computation after its running block.
#[utoipa::path(delete, path = "/api/studies/{study}/replicates", params(("study" = String, Path)),
    responses((status = 200, body = ReplicatesView), (status = 403, body = Problem),
        (status = 409, body = Problem)))]
async fn cancel(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<ReplicatesView>> {
    let result = analysed(&state, &user, &study, Role::Editor).await?;
    let job = state.replicates().of(&result);
    if let Some(job) = &job {
        job.cancel();
    }
    Ok(Json(view(job.as_deref())))
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

async fn run(state: AppState, job: Arc<Job>) {
    let ending = match all(&state, &job).await {
        Ok(Some(found)) => Ending::Done(Box::new(found)),
        Ok(None) => Ending::Cancelled,
        Err(failure) => Ending::Failed(failure.into_problem().message),
    };
    // A job runs once, so that nothing has ended it before.
    let _ = job.ending.set(ending);
}

/// All replicates, block by block; `None` where they were cancelled.
async fn all(state: &AppState, job: &Arc<Job>) -> Answer<Option<Uncertainty>> {
    let mut found: Vec<Replicate> = Vec::new();
    for start in (0..job.asked).step_by(usize::try_from(BLOCK).unwrap_or(1)) {
        // The semaphore is never closed.
        let _turn = state.replicates().turns.acquire().await;
        if job.is_cancelled() {
            return Ok(None);
        }
        let of = Arc::clone(job);
        let end = job.asked.min(start + BLOCK);
        found.extend(computed(move || block(&of.result, start..end)).await??);
        job.done.store(end, Ordering::Relaxed);
    }
    let of = Arc::clone(job);
    computed(move || {
        with_monte_carlo(&of.result, |monte_carlo| {
            let mut tally = monte_carlo.tally();
            found.iter().for_each(|replicate| tally.add(replicate));
            tally.finish(of.asked)
        })
    })
    .await?
    .map(Some)
}

fn block(result: &StudyResult, indices: Range<u64>) -> Answer<Vec<Replicate>> {
    with_monte_carlo(result, |monte_carlo| {
        indices.map(|index| monte_carlo.replicate(index)).collect()
    })
}

fn with_monte_carlo<T>(result: &StudyResult, work: impl FnOnce(&MonteCarlo<'_>) -> T) -> Answer<T> {
    let analysis = result.analysed()?;
    let case = result.current.usable_case();
    let noise = LandmarkNoise::Measured;
    let monte_carlo = MonteCarlo::new(&case, analysis, noise, SEED).map_err(|error| {
        Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "refused", error.to_string())
            .help(error.help())
    })?;
    Ok(work(&monte_carlo))
}
