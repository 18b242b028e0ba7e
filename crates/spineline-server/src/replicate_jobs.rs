//! Replicates in the background: one computation per study, of its current results.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use spineline::uncertainty::Uncertainty;
use spineline_store::Name;
use tokio::sync::Semaphore;

use crate::result_cache::StudyResult;

/// Computations at once. Others wait between their blocks, so that the pages still answer.
const AT_ONCE: usize = 1;

/// All computations.
#[derive(Debug)]
pub struct ReplicateJobs {
    jobs: Mutex<BTreeMap<Name, Arc<Job>>>,
    /// Turns to compute a block.
    pub turns: Semaphore,
}

impl Default for ReplicateJobs {
    fn default() -> Self {
        Self { jobs: Mutex::default(), turns: Semaphore::new(AT_ONCE) }
    }
}

/// How a computation ended.
#[derive(Debug)]
pub enum Ending {
    /// All replicates.
    Done(Box<Uncertainty>),
    /// On request.
    Cancelled,
    /// With the reason.
    Failed(String),
}

/// Replicates of one result.
#[derive(Debug)]
pub struct Job {
    /// The landmarks and their analysis.
    pub result: Arc<StudyResult>,
    /// Replicates that were asked for.
    pub asked: u64,
    /// Replicates that are computed.
    pub done: AtomicU64,
    /// How it ended.
    pub ending: OnceLock<Ending>,
    cancelled: AtomicBool,
}

impl Job {
    /// Whether it was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Ends it after the running block.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// What the noise of landmarks does to the results, where all replicates are computed.
    pub fn uncertainty(&self) -> Option<&Uncertainty> {
        match self.ending.get()? {
            Ending::Done(found) => Some(found),
            Ending::Cancelled | Ending::Failed(_) => None,
        }
    }
}

impl ReplicateJobs {
    /// The computation of these results.
    pub fn of(&self, result: &Arc<StudyResult>) -> Option<Arc<Job>> {
        let jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        jobs.get(&result.study).filter(|job| Arc::ptr_eq(&job.result, result)).cloned()
    }

    /// Begins a computation of these results, and cancels that of older ones; `None` where one of these runs.
    pub fn begin(&self, result: &Arc<StudyResult>, asked: u64) -> Option<Arc<Job>> {
        let mut jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(job) = jobs.get(&result.study) {
            if Arc::ptr_eq(&job.result, result) && job.ending.get().is_none() {
                return None;
            }
            job.cancel();
        }
        let job = Arc::new(Job {
            result: Arc::clone(result),
            asked,
            done: AtomicU64::new(0),
            ending: OnceLock::new(),
            cancelled: AtomicBool::new(false),
        });
        jobs.insert(result.study.clone(), Arc::clone(&job));
        Some(job)
    }
}
