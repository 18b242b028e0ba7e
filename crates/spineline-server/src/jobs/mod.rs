//! Background jobs: one of each kind per study, from its current results, with progress and cancel.

mod computations;
mod loads;

pub use computations::{ComputationJob, Computed, Found};
pub use loads::{LoadIntervalJob, LoadIntervalWork, PadMapJob, PadMapWork};

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use spineline_store::Name;
use tokio::sync::Semaphore;

use crate::api::{ComputationState, ProgressView};
use crate::problem::Answer;
use crate::result_cache::StudyResult;

/// Jobs that compute concurrently. Others wait, so that the pages still answer.
const AT_ONCE: usize = 1;

/// What a job computes from the results of a study.
pub trait Work: Send + Sync + 'static {
    /// Its result.
    type Found: Send + Sync + 'static;

    /// Name of its kind, also in the store: a study has one job of each kind.
    fn key(&self) -> &'static str;
}

/// The job of every study and kind.
type JobMap<W> = BTreeMap<(Name, &'static str), Arc<Job<W>>>;

/// All jobs that do this work.
pub struct Jobs<W: Work> {
    jobs: Mutex<JobMap<W>>,
    /// Turns to compute.
    pub turns: Semaphore,
}

impl<W: Work> Default for Jobs<W> {
    fn default() -> Self {
        Self { jobs: Mutex::default(), turns: Semaphore::new(AT_ONCE) }
    }
}

/// How a job ended.
#[derive(Debug)]
pub enum Ending<Found> {
    /// All steps.
    Done(Found),
    /// On request.
    Cancelled,
    /// With the reason.
    Failed(String),
}

/// A job of one result.
pub struct Job<W: Work> {
    /// The landmarks and their analysis.
    pub result: Arc<StudyResult>,
    /// What is done.
    pub work: W,
    /// Number of steps.
    pub asked: u64,
    /// Steps that are done.
    pub done: AtomicU64,
    ending: OnceLock<Ending<W::Found>>,
    cancelled: AtomicBool,
}

impl<W: Work> Job<W> {
    fn new(result: &Arc<StudyResult>, work: W, asked: u64) -> Self {
        Self {
            result: Arc::clone(result),
            work,
            asked,
            done: AtomicU64::new(0),
            ending: OnceLock::new(),
            cancelled: AtomicBool::new(false),
        }
    }

    /// Whether it was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Ends it after the running step.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Its result, once all steps are done.
    pub fn found(&self) -> Option<&W::Found> {
        let Ending::Done(found) = self.ending.get()? else { return None };
        Some(found)
    }

    /// Ends it with its result; `None` where it was cancelled.
    pub fn end(&self, found: Answer<Option<W::Found>>) {
        let ending = match found {
            Ok(Some(found)) => Ending::Done(found),
            Ok(None) => Ending::Cancelled,
            Err(failure) => Ending::Failed(failure.into_problem().message),
        };
        // A job runs once, so it was not ended before.
        let _ = self.ending.set(ending);
    }
}

/// State, steps and result of a job, if one was begun; it reads once how the job ended, so state and result agree.
pub fn progress<W: Work>(job: Option<&Job<W>>) -> (ProgressView, Option<&W::Found>) {
    let (state, found, texts) = match job.map(|job| job.ending.get()) {
        None => (ComputationState::None, None, Vec::new()),
        Some(None) => (ComputationState::Running, None, Vec::new()),
        Some(Some(Ending::Done(found))) => (ComputationState::Done, Some(found), Vec::new()),
        Some(Some(Ending::Cancelled)) => (ComputationState::Cancelled, None, Vec::new()),
        Some(Some(Ending::Failed(why))) => (ComputationState::Failed, None, vec![why.clone()]),
    };
    let done = job.map_or(0, |job| job.done.load(Ordering::Relaxed));
    let asked = job.map_or(0, |job| job.asked);
    (ProgressView { state, done, asked, texts }, found)
}

impl<W: Work> Jobs<W> {
    /// The job of these results.
    pub fn of(&self, result: &Arc<StudyResult>, key: &'static str) -> Option<Arc<Job<W>>> {
        let jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        let job = jobs.get(&(result.study.clone(), key));
        job.filter(|job| Arc::ptr_eq(&job.result, result)).cloned()
    }

    /// Restores an earlier result of these inputs, unless the job is known.
    pub fn recall(&self, result: &Arc<StudyResult>, work: W, asked: u64, found: W::Found) {
        let mut jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (result.study.clone(), work.key());
        if jobs.get(&key).is_none_or(|job| !Arc::ptr_eq(&job.result, result)) {
            let job = Job::new(result, work, asked);
            job.done.store(asked, Ordering::Relaxed);
            job.end(Ok(Some(found)));
            if let Some(older) = jobs.insert(key, Arc::new(job)) {
                older.cancel();
            }
        }
    }

    /// Begins a job for these results, and cancels a job for older ones; `None` if one is running for these.
    pub fn begin(&self, result: &Arc<StudyResult>, work: W, asked: u64) -> Option<Arc<Job<W>>> {
        let mut jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (result.study.clone(), work.key());
        if let Some(job) = jobs.get(&key) {
            if Arc::ptr_eq(&job.result, result) && job.ending.get().is_none() {
                return None;
            }
            job.cancel();
        }
        let job = Arc::new(Job::new(result, work, asked));
        jobs.insert(key, Arc::clone(&job));
        Some(job)
    }
}
