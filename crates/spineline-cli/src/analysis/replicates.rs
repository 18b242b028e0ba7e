//! Monte Carlo replicates of one case on several threads.

use spineline::analysis::{Analysis, Case};
use spineline::response::LoadedMeasure;
use spineline::uncertainty::{AppliedLoads, LoadedUncertainty, MonteCarlo, Uncertainty};
use spineline::warning::counted;
use spineline_files::Replicates;

use crate::run::failure::Failure;
use crate::run::threads::stream_all;
use crate::run::{interrupt, progress};

/// Runs the requested replicates. Ctrl-C ends them early, and the finished ones count.
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

/// Runs these replicates of a model under loads; `measures` are the nominal results.
pub fn run_loaded_replicates(
    monte_carlo: &MonteCarlo<'_>,
    loads: &AppliedLoads<'_>,
    measures: &[LoadedMeasure],
    count: u64,
    threads: usize,
) -> Result<LoadedUncertainty, Failure> {
    let mut tally = monte_carlo.loaded_tally(measures);
    let one = |index| monte_carlo.loaded_replicate(index, loads);
    in_order(count, threads, one, |replicate| tally.add(replicate))?;
    Ok(tally.finish(count))
}

/// How many replicates count after Ctrl-C has ended them early.
pub fn interruption_text(done: u64, asked: u64) -> String {
    format!("interrupted: {done} of {} finished, which count", counted(asked, "replicate"))
}

/// Prepares the requested replicates.
pub fn monte_carlo<'a>(
    case: &Case,
    nominal: &'a Analysis,
    asked: &Replicates,
) -> Result<MonteCarlo<'a>, Failure> {
    MonteCarlo::new(case, nominal, asked.noise, asked.seed)
        .map_err(|error| Failure::of(&case.id, &error))
}

/// Computes replicates on all threads and adds them in their order, so that the bytes are the same for any number of threads.
fn in_order<R: Send>(
    asked: u64,
    threads: usize,
    one: impl Fn(u64) -> R + Sync,
    mut add: impl FnMut(&R),
) -> Result<(), Failure> {
    let _stops_by_itself = interrupt::defer();
    let count = usize::try_from(asked).unwrap_or(usize::MAX);
    let bar = progress::bar("replicates", count);
    let run = |index| one(index as u64);
    let numbers = (0..count).take_while(|_| !interrupt::is_requested());
    stream_all(&bar, numbers, threads, run, |replicate| {
        add(&replicate);
        Ok(())
    })
}
