//! Maps of pads in the background: one per study, of its current results.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use spineline::response::{PadEffect, PadTrial};
use spineline_files::StoredModel;
use spineline_store::Name;
use tokio::sync::Semaphore;

use crate::api::{LineName, PadMapRequest};
use crate::result_cache::StudyResult;

/// A map uses all cores, so that one is computed at a time.
const AT_ONCE: usize = 1;

/// All maps.
#[derive(Debug)]
pub struct PadMapJobs {
    jobs: Mutex<BTreeMap<Name, Arc<PadMapJob>>>,
    /// Turns to compute a map.
    pub turns: Semaphore,
}

impl Default for PadMapJobs {
    fn default() -> Self {
        Self { jobs: Mutex::default(), turns: Semaphore::new(AT_ONCE) }
    }
}

/// How a map ended.
#[derive(Debug)]
pub enum PadMapEnding {
    /// What every pad does, in the order of the trials.
    Done(Vec<PadEffect>),
    /// On request.
    Cancelled,
    /// With the reason.
    Failed(String),
}

/// A map of one result.
#[derive(Debug)]
pub struct PadMapJob {
    /// The landmarks and their analysis.
    pub result: Arc<StudyResult>,
    /// Line of action whose model is loaded.
    pub line: LineName,
    /// Force and stiffness.
    pub request: PadMapRequest,
    /// The model.
    pub model: StoredModel,
    /// The pads.
    pub trials: Vec<PadTrial>,
    /// Pads that were tried.
    pub done: AtomicU64,
    /// How it ended.
    pub ending: OnceLock<PadMapEnding>,
    cancelled: AtomicBool,
}

impl PadMapJob {
    /// A map that has not begun.
    pub fn new(
        result: Arc<StudyResult>,
        (line, model): (LineName, StoredModel),
        request: PadMapRequest,
        trials: Vec<PadTrial>,
    ) -> Self {
        Self {
            result,
            line,
            request,
            model,
            trials,
            done: AtomicU64::new(0),
            ending: OnceLock::new(),
            cancelled: AtomicBool::new(false),
        }
    }

    /// Whether it was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Ends it after the running trials.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}

impl PadMapJobs {
    /// The map of these results and this line.
    pub fn of(&self, result: &Arc<StudyResult>, line: LineName) -> Option<Arc<PadMapJob>> {
        let jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        let job = jobs.get(&result.study)?;
        (Arc::ptr_eq(&job.result, result) && job.line == line).then(|| Arc::clone(job))
    }

    /// Begins a map, and cancels that of older results; `None` where one of the same results runs.
    pub fn begin(&self, job: PadMapJob) -> Option<Arc<PadMapJob>> {
        let mut jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(before) = jobs.get(&job.result.study) {
            if Arc::ptr_eq(&before.result, &job.result) && before.ending.get().is_none() {
                return None;
            }
            before.cancel();
        }
        let job = Arc::new(job);
        jobs.insert(job.result.study.clone(), Arc::clone(&job));
        Some(job)
    }
}
