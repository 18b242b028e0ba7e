//! Work on several threads.

use std::collections::BTreeMap;
use std::panic::{self, AssertUnwindSafe};
use std::sync::mpsc;

use indicatif::ProgressBar;
use rayon::prelude::*;
use spineline::cohort::Workers;

use super::failure::Failure;
use super::progress::bar;

/// A pool of threads; 0 uses all cores.
///
/// # Errors
/// If they cannot be started.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::internal(format!("threads could not be started: {error}")))
}

/// A pool whose threads do the statistics of a cohort.
pub struct Pool(rayon::ThreadPool);

impl Pool {
    /// As [`pool`].
    ///
    /// # Errors
    /// If the threads cannot be started.
    pub fn new(threads: usize) -> Result<Self, Failure> {
        pool(threads).map(Self)
    }
}

impl Workers for Pool {
    fn each(&self, pieces: usize, work: &(dyn Fn(usize) + Sync)) {
        self.0.install(|| (0..pieces).into_par_iter().for_each(work));
    }
}

/// Runs a function on all items in parallel and keeps their order; 0 threads uses all cores.
///
/// # Errors
/// If the threads cannot be started.
pub fn map_all<T: Sync, R: Send>(
    what: &str,
    items: &[T],
    threads: usize,
    run: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, Failure> {
    let pool = pool(threads)?;
    let bar = bar(what, items.len());
    let results = pool.install(|| {
        items
            .par_iter()
            .map(|item| {
                let result = run(item);
                bar.inc(1);
                result
            })
            .collect()
    });
    bar.finish_and_clear();
    Ok(results)
}

/// Results per thread that may wait for an earlier one in [`stream_all`].
const HELD_PER_THREAD: usize = 16;

/// Runs a function on all items in parallel and passes every result on, in the order of the items; 0 threads uses all cores.
/// Few results are in memory at a time, whatever the number of items.
///
/// # Errors
/// If the threads cannot be started, or of `take`; no further item is begun then.
///
/// # Panics
/// If the function does.
pub fn stream_all<T: Sync, R: Send>(
    bar: &ProgressBar,
    items: &[T],
    threads: usize,
    run: impl Fn(&T) -> R + Sync,
    mut take: impl FnMut(R) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let pool = pool(threads)?;
    let (ended, results) = mpsc::channel();
    let run = &run;
    pool.in_place_scope(|scope| {
        let begin = |place: usize| {
            let Some(item) = items.get(place) else { return };
            let ended = ended.clone();
            scope.spawn(move |_| {
                // A panic is passed on to who waits for the result.
                let result = panic::catch_unwind(AssertUnwindSafe(|| run(item)));
                let _is_awaited = ended.send((place, result));
            });
        };
        let held = HELD_PER_THREAD * pool.current_num_threads();
        (0..held).for_each(begin);
        let mut early = BTreeMap::new();
        let mut next = 0;
        for (place, result) in results.iter().take(items.len()) {
            early.insert(place, result);
            bar.inc(1);
            while let Some(result) = early.remove(&next) {
                take(result.unwrap_or_else(|panic| panic::resume_unwind(panic)))?;
                begin(next + held);
                next += 1;
            }
        }
        bar.finish_and_clear();
        Ok(())
    })
}
