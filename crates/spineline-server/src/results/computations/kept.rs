//! Replicates that are kept with the study, over a restart of the program.

use std::sync::Arc;

use spineline_files::{CaseFile, parse_uncertainty, to_line, uncertainty_text};
use spineline_store::KeptComputation;

use super::replicates::{SEED, with_monte_carlo};
use crate::computation_jobs::{ComputationJob, Found, JobKind};
use crate::jobs::Ending;
use crate::problem::Answer;
use crate::result_cache::{StudyResult, computed};
use crate::results::exports::PROGRAM;
use crate::state::AppState;

/// Name of the computation in the store.
const KIND: &str = "replicates";

/// Everything that replicates are computed from, with the numbers of the case itself: another version of the program has others.
fn inputs(result: &StudyResult) -> Answer<String> {
    let case = to_line(&CaseFile::from_case(&result.current.usable_case()));
    let options = to_line(&result.current.options);
    with_monte_carlo(result, |monte_carlo| {
        let nominal = monte_carlo.tally().finish(0).quantities;
        let values: Vec<String> = nominal.iter().map(|one| format!("{:?}", one.nominal)).collect();
        format!("{PROGRAM}\n{SEED}\n{case}\n{options}\n{}", values.join("\n"))
    })
}

/// Keeps finished replicates. A store that cannot be written keeps nothing: the page has them all the same.
pub async fn keep(state: &AppState, job: &Arc<ComputationJob>) {
    let of = Arc::clone(job);
    let made = computed(move || {
        let Some(Ending::Done(Found::Replicates(found))) = of.ending.get() else { return None };
        let inputs = inputs(&of.result).ok()?;
        Some(KeptComputation::new(&inputs, of.asked, uncertainty_text(found)))
    });
    let Ok(Some(kept)) = made.await else { return };
    let study = job.result.study.clone();
    let _ = state.store(move |store| store.keep_computation(&study, KIND, &kept)).await;
}

/// Makes kept replicates of these results known, where nothing is known of them yet.
///
/// # Errors
/// Errors of reading the store.
pub async fn recall(state: &AppState, result: &Arc<StudyResult>) -> Answer<()> {
    if state.jobs().of(result, JobKind::Replicates).is_some() {
        return Ok(());
    }
    let study = result.study.clone();
    let Some(kept) = state.store(move |store| store.computation(&study, KIND)).await? else {
        return Ok(());
    };
    let of = Arc::clone(result);
    let asked = kept.asked;
    let found = computed(move || {
        let empty = with_monte_carlo(&of, |one| one.tally().finish(kept.asked)).ok()?;
        let fits = inputs(&of).is_ok_and(|inputs| kept.is_of(&inputs));
        if fits { parse_uncertainty(&kept.found, empty) } else { None }
    });
    if let Some(found) = found.await? {
        let found = Found::Replicates(Box::new(found));
        state.jobs().recall(result, (JobKind::Replicates, ()), asked, found);
    }
    Ok(())
}
