//! A bar for work that takes longer than a moment; silent where nobody looks.

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use crate::failure::Failure;

/// Runs a function on all items with so many threads (0: all cores), in parallel, and keeps their order.
///
/// # Errors
/// If the threads cannot be started.
pub fn map_all<T: Sync, R: Send>(
    what: &str,
    items: &[T],
    threads: usize,
    run: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::internal(format!("threads could not be started: {error}")))?;
    let bar = ProgressBar::new(items.len() as u64);
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} ({eta})");
    bar.set_style(style.expect("the template is well-formed"));
    bar.set_message(what.to_owned());
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
