//! Computations in the background: one of each kind per study, of its current results.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use spineline::analysis::Analysis;
use spineline::personalize::Identifiability;
use spineline::uncertainty::Uncertainty;
use spineline_store::Name;
use tokio::sync::Semaphore;

use crate::result_cache::StudyResult;

/// Computations at once. Others wait between their blocks, so that the pages still answer.
const AT_ONCE: usize = 1;

/// What is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum JobKind {
    /// The effect of landmark noise.
    Replicates,
    /// What the films say of every multiplier.
    Identifiability,
    /// Other loads and bases than the lines.
    Models,
}

/// All computations.
#[derive(Debug)]
pub struct Jobs {
    jobs: Mutex<BTreeMap<(Name, JobKind), Arc<Job>>>,
    /// Turns to compute a block.
    pub turns: Semaphore,
}

impl Default for Jobs {
    fn default() -> Self {
        Self { jobs: Mutex::default(), turns: Semaphore::new(AT_ONCE) }
    }
}

/// What a computation has found.
#[derive(Debug)]
pub enum Found {
    /// The effect of landmark noise on the numbers.
    Replicates(Box<Uncertainty>),
    /// By model of a line; `None` where its fit did not converge.
    Identifiability(Vec<Option<Identifiability>>),
    /// The analysis with the other loads and bases.
    Models(Box<Analysis>),
}

/// How a computation ended.
#[derive(Debug)]
pub enum Ending {
    /// All steps.
    Done(Found),
    /// On request.
    Cancelled,
    /// With the reason.
    Failed(String),
}

/// A computation from one result.
#[derive(Debug)]
pub struct Job {
    /// The landmarks and their analysis.
    pub result: Arc<StudyResult>,
    /// What is computed.
    pub kind: JobKind,
    /// Number of steps.
    pub asked: u64,
    /// Steps that are done.
    pub done: AtomicU64,
    /// How it ended.
    pub ending: OnceLock<Ending>,
    cancelled: AtomicBool,
}

impl Job {
    fn new(result: &Arc<StudyResult>, kind: JobKind, asked: u64) -> Self {
        Self {
            result: Arc::clone(result),
            kind,
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

    /// Ends it after the running block.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    fn found(&self) -> Option<&Found> {
        match self.ending.get()? {
            Ending::Done(found) => Some(found),
            Ending::Cancelled | Ending::Failed(_) => None,
        }
    }
}

/// The computations of one result, as far as they are done.
#[derive(Debug, Default)]
pub struct Computed(Vec<Arc<Job>>);

impl Computed {
    /// What the noise of landmarks does to the results.
    pub fn uncertainty(&self) -> Option<&Uncertainty> {
        self.0.iter().find_map(|job| match job.found()? {
            Found::Replicates(found) => Some(&**found),
            _ => None,
        })
    }

    /// What the films say of every multiplier, by model.
    pub fn identifiability(&self) -> Option<&[Option<Identifiability>]> {
        self.0.iter().find_map(|job| match job.found()? {
            Found::Identifiability(found) => Some(&found[..]),
            _ => None,
        })
    }

    /// The analysis with other loads and bases.
    pub fn models(&self) -> Option<&Analysis> {
        self.0.iter().find_map(|job| match job.found()? {
            Found::Models(found) => Some(&**found),
            _ => None,
        })
    }
}

impl Jobs {
    /// The computation of these results.
    pub fn of(&self, result: &Arc<StudyResult>, kind: JobKind) -> Option<Arc<Job>> {
        let jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        let job = jobs.get(&(result.study.clone(), kind));
        job.filter(|job| Arc::ptr_eq(&job.result, result)).cloned()
    }

    /// What is computed of these results.
    pub fn computed(&self, result: &Arc<StudyResult>) -> Computed {
        let kinds = [JobKind::Replicates, JobKind::Identifiability, JobKind::Models];
        Computed(kinds.into_iter().filter_map(|kind| self.of(result, kind)).collect())
    }

    /// Takes up what was computed of these results before, where nothing else is known of them.
    pub fn recall(&self, result: &Arc<StudyResult>, kind: JobKind, asked: u64, found: Found) {
        let mut jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (result.study.clone(), kind);
        if jobs.get(&key).is_none_or(|job| !Arc::ptr_eq(&job.result, result)) {
            let job = Job::new(result, kind, asked);
            job.done.store(asked, Ordering::Relaxed);
            // It is new, so that nothing has ended it before.
            let _ = job.ending.set(Ending::Done(found));
            if let Some(older) = jobs.insert(key, Arc::new(job)) {
                older.cancel();
            }
        }
    }

    /// Begins a computation of these results, and cancels that of older ones; `None` where one of these runs.
    pub fn begin(&self, result: &Arc<StudyResult>, kind: JobKind, asked: u64) -> Option<Arc<Job>> {
        let mut jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (result.study.clone(), kind);
        if let Some(job) = jobs.get(&key) {
            if Arc::ptr_eq(&job.result, result) && job.ending.get().is_none() {
                return None;
            }
            job.cancel();
        }
        let job = Arc::new(Job::new(result, kind, asked));
        jobs.insert(key, Arc::clone(&job));
        Some(job)
    }
}
