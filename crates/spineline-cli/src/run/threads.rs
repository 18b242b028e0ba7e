//! Work on several threads.

use indicatif::ProgressBar;
use rayon::prelude::*;

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

/// Items per thread whose results are held at once by [`stream_all`].
const HELD_PER_THREAD: usize = 16;

/// Runs a function on all items in parallel and passes every result on, in the order of the items; 0 threads uses all cores.
/// Few results are in memory at a time, whatever the number of items.
///
/// # Errors
/// If the threads cannot be started, or of `take`; no further item is begun then.
pub fn stream_all<T: Sync, R: Send>(
    bar: &ProgressBar,
    items: &[T],
    threads: usize,
    run: impl Fn(&T) -> R + Sync,
    mut take: impl FnMut(R) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let pool = pool(threads)?;
    for held in items.chunks(HELD_PER_THREAD * pool.current_num_threads()) {
        let results: Vec<R> = pool.install(|| {
            held.par_iter()
                .map(|item| {
                    let result = run(item);
                    bar.inc(1);
                    result
                })
                .collect()
        });
        results.into_iter().try_for_each(&mut take)?;
    }
    bar.finish_and_clear();
    Ok(())
}
