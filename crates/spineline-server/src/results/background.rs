//! Jobs from their start to their result in the store, which survives a restart.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::http::StatusCode;
use spineline_store::KeptComputation;

use crate::jobs::{Job, Jobs, Work};
use crate::problem::{Answer, Failure};
use crate::result_cache::{StudyResult, computed};
use crate::state::AppState;

/// How a kind of work is computed and stored.
pub trait Task: Work + Sized {
    /// Why a second job is refused while one runs, and what to do.
    const RUNNING: [&'static str; 2];

    fn jobs(state: &AppState) -> &Jobs<Self>;

    /// Computes; `None` where the job was cancelled.
    fn run(
        state: &AppState,
        job: &Arc<Job<Self>>,
    ) -> impl Future<Output = Answer<Option<Self::Found>>> + Send;

    /// The part of the result that the store keeps; by default none.
    fn kept(_job: &Job<Self>, _found: &Self::Found) -> Option<KeptComputation> {
        None
    }
}

/// Begins a job in the background.
///
/// # Errors
/// A refusal while such a job of these results runs.
pub fn start<T: Task>(
    state: &AppState,
    result: &Arc<StudyResult>,
    work: T,
    asked: u64,
) -> Answer<Arc<Job<T>>> {
    let job = T::jobs(state).begin(result, work, asked).ok_or_else(|| {
        let [text, help] = T::RUNNING;
        Failure::new(StatusCode::CONFLICT, "running", text).help(help)
    })?;
    let (state, running) = (state.clone(), Arc::clone(&job));
    tokio::spawn(async move {
        let found = match T::run(&state, &running).await {
            Ok(Some(found)) => keep(&state, &running, found).await.map(Some),
            other => other,
        };
        running.end(found);
    });
    Ok(job)
}

/// Stores a result before it is shown. If the store cannot be written, the page still shows it.
async fn keep<T: Task>(state: &AppState, job: &Arc<Job<T>>, found: T::Found) -> Answer<T::Found> {
    let of = Arc::clone(job);
    let (found, kept) = computed(move || {
        let kept = T::kept(&of, &found);
        (found, kept)
    })
    .await?;
    if let Some(kept) = kept {
        let (study, key) = (job.result.study.clone(), job.work.key());
        let _ = state.store(move |store| store.keep_computation(&study, key, &kept)).await;
    }
    Ok(found)
}

/// Restores a stored result, unless a job of this kind and these results is known. `read` gives `None` for a result of
/// other inputs.
pub async fn recall<T: Task>(
    state: &AppState,
    result: &Arc<StudyResult>,
    key: &'static str,
    read: impl FnOnce(&StudyResult, &KeptComputation) -> Option<(T, T::Found)> + Send + 'static,
) -> Answer<()> {
    if T::jobs(state).of(result, key).is_some() {
        return Ok(());
    }
    let study = result.study.clone();
    let kept = state.store(move |store| store.computation(&study, key)).await?;
    let Some(kept) = kept else { return Ok(()) };
    let (of, asked) = (Arc::clone(result), kept.asked);
    if let Some((work, found)) = computed(move || read(&of, &kept)).await? {
        T::jobs(state).recall(result, work, asked, found);
    }
    Ok(())
}

/// Runs numbered steps in turn; `None` if they were cancelled.
pub async fn in_turns<W: Work, T: Send + 'static>(
    state: &AppState,
    job: &Arc<Job<W>>,
    block: u64,
    work: impl Fn(&Job<W>, Range<u64>) -> Answer<Vec<T>> + Clone + Send + 'static,
) -> Answer<Option<Vec<T>>> {
    let mut found = Vec::new();
    for start in (0..job.asked).step_by(usize::try_from(block).unwrap_or(1)) {
        // The semaphore is never closed.
        let _turn = state.jobs.turns.acquire().await;
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
