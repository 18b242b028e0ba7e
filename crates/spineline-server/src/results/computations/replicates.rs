//! Intervals of a study's results by landmark noise.

use std::sync::Arc;

use spineline::uncertainty::{LandmarkNoise, MonteCarlo, Replicate};

use crate::jobs::{ComputationJob, Found};
use crate::problem::{Answer, Failure};
use crate::result_cache::{StudyResult, computed};
use crate::results::background::in_turns;
use crate::state::AppState;

/// Seed of the random streams, the same as on the command line.
pub const SEED: u64 = 1;
const MAX_COUNT: u64 = 2000;
/// Replicates between two updates of the progress: a cancel waits for them.
pub const BLOCK: u64 = 4;

/// The number of replicates, if it is allowed.
pub fn checked(count: u64) -> Answer<u64> {
    if (1..=MAX_COUNT).contains(&count) {
        return Ok(count);
    }
    let text = format!("{count} replicates; the limit is 1 to {MAX_COUNT}");
    Err(Failure::refused(text).help("the command line computes more: `analyze --replicates`"))
}

/// All replicates, block by block; `None` where they were cancelled.
pub async fn all(state: &AppState, job: &Arc<ComputationJob>) -> Answer<Option<Found>> {
    let found = in_turns(state, job, BLOCK, |job, places| {
        with_monte_carlo(&job.result, |monte_carlo| -> Vec<Replicate> {
            places.map(|index| monte_carlo.replicate(index)).collect()
        })
    });
    let Some(found) = found.await? else { return Ok(None) };
    let of = Arc::clone(job);
    let uncertainty = computed(move || {
        with_monte_carlo(&of.result, |monte_carlo| {
            let mut tally = monte_carlo.tally();
            found.iter().for_each(|replicate| tally.add(replicate));
            tally.finish(of.asked)
        })
    });
    Ok(Some(Found::Replicates(Box::new(uncertainty.await??))))
}

/// The inputs from which replicates of a result are drawn.
pub fn with_monte_carlo<T>(
    result: &StudyResult,
    work: impl FnOnce(&MonteCarlo<'_>) -> T,
) -> Answer<T> {
    let analysis = result.analysed()?;
    let case = result.current.usable_case();
    let noise = LandmarkNoise::Measured;
    let monte_carlo =
        MonteCarlo::new(&case, analysis, noise, SEED).map_err(|error| Failure::of(&error))?;
    Ok(work(&monte_carlo))
}
