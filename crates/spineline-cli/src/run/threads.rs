//! Work on several threads.

use std::collections::BTreeMap;
use std::panic::{self, AssertUnwindSafe};
use std::sync::mpsc;

use indicatif::ProgressBar;
use rayon::prelude::*;
use spineline::cohort::Workers;

use super::failure::Failure;
use super::progress::bar;

pub struct Pool(rayon::ThreadPool);

impl Pool {
    /// A pool of `threads` threads; 0 uses all cores.
    pub fn new(threads: usize) -> Result<Self, Failure> {
        let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let failed = |error| Failure::internal(format!("threads could not be started: {error}"));
        built.map(Self).map_err(failed)
    }
}

impl Workers for Pool {
    fn each(&self, pieces: usize, work: &(dyn Fn(usize) + Sync)) {
        self.0.install(|| (0..pieces).into_par_iter().for_each(work));
    }
}

/// Runs a function on all items in parallel and keeps their order; 0 threads uses all cores.
pub fn map_all<T: Sync, R: Send>(
    what: &str,
    items: &[T],
    threads: usize,
    run: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, Failure> {
    let Pool(pool) = Pool::new(threads)?;
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

/// Results per thread that may wait for an earlier one in [`stream_all`]: few, because Ctrl-C waits for them.
const HELD_PER_THREAD: usize = 16;

/// Runs a function on all numbers in parallel and passes every result on, in their order; 0 threads uses all cores.
/// Few results are in memory at a time, whatever their count. A number is taken when its run begins: where the numbers end early, the
/// results of those that were begun are passed on.
///
/// # Errors
/// If the threads cannot be started, or of `take`; no further number is begun then.
///
/// # Panics
/// If the function does.
pub fn stream_all<R: Send>(
    bar: &ProgressBar,
    numbers: impl Iterator<Item = usize>,
    threads: usize,
    run: impl Fn(usize) -> R + Sync,
    mut take: impl FnMut(R) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let Pool(pool) = Pool::new(threads)?;
    let mut numbers = numbers.fuse();
    let (ended, results) = mpsc::channel();
    let run = &run;
    pool.in_place_scope(|scope| {
        let mut place = 0_usize;
        // Returns the number of those begun.
        let mut begin_next = || {
            if let Some(number) = numbers.next() {
                let (own, ended) = (place, ended.clone());
                scope.spawn(move |_| {
                    // A panic is passed on to who waits for the result.
                    let result = panic::catch_unwind(AssertUnwindSafe(|| run(number)));
                    let _is_awaited = ended.send((own, result));
                });
                place += 1;
            }
            place
        };
        let mut begun = 0;
        for _ in 0..HELD_PER_THREAD * pool.current_num_threads() {
            begun = begin_next();
        }
        let mut early = BTreeMap::new();
        let mut next = 0;
        while next < begun {
            let Ok((place, result)) = results.recv() else { break };
            early.insert(place, result);
            bar.inc(1);
            while let Some(result) = early.remove(&next) {
                take(result.unwrap_or_else(|panic| panic::resume_unwind(panic)))?;
                next += 1;
                begun = begin_next();
            }
        }
        bar.finish_and_clear();
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn results_come_in_order_and_those_that_are_begun_all_come() {
        let bar = ProgressBar::hidden();
        for threads in [1, 2, 5] {
            let mut all = Vec::new();
            let add = |place| {
                all.push(place);
                Ok(())
            };
            stream_all(&bar, 0..100, threads, |place| place, add).expect("threads");
            assert!(all.into_iter().eq(0..100));

            let (begun, mut taken) = (AtomicUsize::new(0), 0);
            let run = |place| {
                begun.fetch_add(1, Ordering::SeqCst);
                place
            };
            let numbers = (0..1_000).take_while(|_| begun.load(Ordering::SeqCst) < 20);
            stream_all(&bar, numbers, threads, run, |place| {
                assert_eq!(place, taken);
                taken += 1;
                Ok(())
            })
            .expect("threads");
            assert!((20..1_000).contains(&taken), "{taken}");
            assert_eq!(taken, begun.into_inner());
        }
    }

    #[test]
    fn no_further_number_is_begun_after_an_error() {
        let begun = AtomicUsize::new(0);
        let run = |_| begun.fetch_add(1, Ordering::SeqCst);
        let refused =
            stream_all(&ProgressBar::hidden(), 0..1_000, 2, run, |_| Err(Failure::usage("enough")));
        assert!(refused.is_err());
        assert!(begun.into_inner() <= 2 * HELD_PER_THREAD);
    }
}
