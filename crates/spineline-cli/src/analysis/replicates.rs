//! Monte Carlo replicates of one case on several threads.

use indicatif::ProgressBar;
use rayon::prelude::*;
use spineline::analysis::{Analysis, Case};
use spineline::uncertainty::{MonteCarlo, Replicate, Uncertainty};
use spineline_files::Replicates;

use crate::run::failure::Failure;
use crate::run::threads::pool;
use crate::run::{interrupt, progress};

/// Replicates per thread that are computed before they are added in order: few, because Ctrl-C waits for them.
const BLOCK: u64 = 16;

/// Runs the replicates that were asked for. Ctrl-C ends them early, and those that are done count.
///
/// # Errors
/// If the noise cannot be applied to this case.
pub fn run_replicates(
    case: &Case,
    nominal: &Analysis,
    asked: &Replicates,
    threads: usize,
) -> Result<Uncertainty, Failure> {
    let monte_carlo = MonteCarlo::new(case, nominal, asked.noise, asked.seed)
        .map_err(|error| Failure::input(&case.id, &error, error.help()))?;
    let _stops_by_itself = interrupt::defer();
    let pool = pool(threads)?;
    let block_size = BLOCK.saturating_mul(pool.current_num_threads() as u64);
    let asked = asked.count;
    let bar = progress::bar("replicates", usize::try_from(asked).unwrap_or(usize::MAX));
    let mut tally = monte_carlo.tally();
    let mut next = 0;
    while next < asked && !interrupt::is_requested() {
        let end = asked.min(next.saturating_add(block_size));
        let block = pool.install(|| block(&monte_carlo, next..end, &bar));
        // In their order, so that the bytes are the same for any number of threads.
        block.iter().for_each(|replicate| tally.add(replicate));
        next = end;
    }
    bar.finish_and_clear();
    Ok(tally.finish(asked))
}

fn block(
    monte_carlo: &MonteCarlo<'_>,
    indices: std::ops::Range<u64>,
    bar: &ProgressBar,
) -> Vec<Replicate> {
    let one = |index| {
        let replicate = monte_carlo.replicate(index);
        bar.inc(1);
        replicate
    };
    indices.into_par_iter().map(one).collect()
}
