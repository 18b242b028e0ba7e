//! A bar for work that takes longer than a moment; silent where nobody looks.

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use crate::failure::Failure;

/// A bar of so many steps.
pub fn bar(what: &str, steps: usize) -> ProgressBar {
    styled(ProgressBar::new(steps as u64), "{msg} {wide_bar} {pos}/{len} ({eta})", what)
}

/// A count of what has been seen, where nobody knows how much there is.
pub fn spinner(what: &str) -> ProgressBar {
    styled(ProgressBar::no_length(), "{msg} {spinner} {pos}", what)
}

fn styled(bar: ProgressBar, template: &str, what: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(template);
    bar.set_style(style.expect("the template is well-formed"));
    bar.set_message(what.to_owned());
    bar
}

/// So many threads (0: all cores).
///
/// # Errors
/// If they cannot be started.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::internal(format!("threads could not be started: {error}")))
}

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
