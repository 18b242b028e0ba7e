//! Intervals under loads that are stored with the study and survive a restart: the last ones for any line and loads.

use std::borrow::Cow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use spineline::uncertainty::{LoadedTally, LoadedUncertainty};
use spineline_files::to_line;
use spineline_store::KeptComputation;

use crate::api::LineKindName;
use crate::jobs::{LoadIntervalJob, LoadIntervalWork};
use crate::problem::Answer;
use crate::result_cache::StudyResult;
use crate::results::background;
use crate::results::computations::inputs_with;
use crate::results::computations::replicates::with_monte_carlo;
use crate::results::loads::{simulated_file, tables};
use crate::state::AppState;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored<'a> {
    line: LineKindName,
    /// The load file as it was sent.
    file: String,
    replicates: Cow<'a, LoadedUncertainty>,
}

/// Intervals as the store keeps them.
pub fn written(job: &LoadIntervalJob, found: &LoadedUncertainty) -> Answer<KeptComputation> {
    let work = &job.work;
    let empty = tally(&job.result, work, |tally| tally.finish(job.asked))?;
    let stored =
        Stored { line: work.line, file: work.file.clone(), replicates: Cow::Borrowed(found) };
    let inputs = inputs(&job.result, work, &empty);
    Ok(KeptComputation::new(&inputs, job.asked, to_line(&stored)))
}

/// Restores stored intervals of these results that are not in memory.
pub async fn recall(state: &AppState, result: &Arc<StudyResult>) -> Answer<()> {
    background::recall(state, result, LoadIntervalWork::KEY, read).await
}

/// Reads stored intervals; `None` if they belong to other results.
fn read(
    result: &StudyResult,
    kept: &KeptComputation,
) -> Option<(LoadIntervalWork, LoadedUncertainty)> {
    let Stored { line, file, replicates } = serde_json::from_str(&kept.found).ok()?;
    let simulated = simulated_file(result, line, &file).ok()?;
    let work = LoadIntervalWork { line, file, simulated };
    let empty = tally(result, &work, |tally| tally.finish(kept.asked)).ok()?;
    if !kept.is_of(&inputs(result, &work, &empty)) {
        return None;
    }
    Some((work, replicates.into_owned()))
}

/// Everything that the intervals depend on.
fn inputs(result: &StudyResult, work: &LoadIntervalWork, empty: &LoadedUncertainty) -> String {
    let values = empty.numbers.iter().map(|one| format!("{:?}", one.nominal));
    let values = values.collect::<Vec<_>>().join("\n");
    let numbers = format!("{}\n{}\n{values}", work.line.0.key(), work.file);
    inputs_with(result, &numbers)
}

/// An empty tally of replicates for the results of the case's own model under these loads.
pub fn tally<T>(
    result: &StudyResult,
    work: &LoadIntervalWork,
    use_it: impl FnOnce(LoadedTally<'_>) -> T,
) -> Answer<T> {
    let measures = tables(result.analysed()?, &work.simulated, None).measures();
    with_monte_carlo(result, |monte_carlo| use_it(monte_carlo.loaded_tally(&measures)))
}
