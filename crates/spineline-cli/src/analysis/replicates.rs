//! Monte Carlo replicates of one case on several threads.

use rayon::prelude::*;
use spineline::analysis::{Analysis, Case};
use spineline::response::LoadedMeasure;
use spineline::uncertainty::{AppliedLoads, LoadedUncertainty, MonteCarlo, Uncertainty};
use spineline::warning::counted;
use spineline_files::Replicates;
use spineline_report::document::{Notice, NoticeKind};

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
    let monte_carlo = monte_carlo(case, nominal, asked)?;
    let mut tally = monte_carlo.tally();
    let one = |index| monte_carlo.replicate(index);
    in_order(asked.count, threads, one, |replicate| tally.add(replicate))?;
    Ok(tally.finish(asked.count))
}

/// The same of a model under loads, for what the case's own model shows under them.
///
/// # Errors
/// As [`run_replicates`].
pub fn run_loaded_replicates(
    (case, nominal): (&Case, &Analysis),
    (loads, measures): (&AppliedLoads<'_>, &[LoadedMeasure]),
    asked: &Replicates,
    threads: usize,
) -> Result<LoadedUncertainty, Failure> {
    let monte_carlo = monte_carlo(case, nominal, asked)?;
    let mut tally = monte_carlo.loaded_tally(measures);
    let one = |index| monte_carlo.loaded_replicate(index, loads);
    in_order(asked.count, threads, one, |replicate| tally.add(replicate))?;
    Ok(tally.finish(asked.count))
}

/// How many replicates count, where Ctrl-C has ended them early.
pub fn interruption(case_id: &str, done: u64, asked: u64) -> Notice {
    Notice {
        kind: NoticeKind::Warning,
        place: case_id.to_owned(),
        text: format!(
            "interrupted: {done} of {} finished, which count",
            counted(asked, "replicate")
        ),
        code: "interrupted".to_owned(),
    }
}

fn monte_carlo<'a>(
    case: &Case,
    nominal: &'a Analysis,
    asked: &Replicates,
) -> Result<MonteCarlo<'a>, Failure> {
    MonteCarlo::new(case, nominal, asked.noise, asked.seed)
        .map_err(|error| Failure::input(&case.id, &error, error.help()))
}

/// Computes replicates on all threads and adds them in their order, so that the bytes are the same for any number of threads.
fn in_order<R: Send>(
    asked: u64,
    threads: usize,
    one: impl Fn(u64) -> R + Sync,
    mut add: impl FnMut(&R),
) -> Result<(), Failure> {
    let _stops_by_itself = interrupt::defer();
    let pool = pool(threads)?;
    let block_size = BLOCK.saturating_mul(pool.current_num_threads() as u64);
    let bar = progress::bar("replicates", usize::try_from(asked).unwrap_or(usize::MAX));
    let counted = |index| {
        let replicate = one(index);
        bar.inc(1);
        replicate
    };
    let mut next = 0;
    while next < asked && !interrupt::is_requested() {
        let end = asked.min(next.saturating_add(block_size));
        let block: Vec<R> = pool.install(|| (next..end).into_par_iter().map(counted).collect());
        block.iter().for_each(&mut add);
        next = end;
    }
    bar.finish_and_clear();
    Ok(())
}
