//! Computations that are stored with the study and survive a restart.

use std::sync::Arc;

use spineline::hypothesis::Hypothesis;
use spineline_files::{CaseFile, to_line};
use spineline_store::KeptComputation;

use super::models;
use super::replicates::{SEED, with_monte_carlo};
use crate::PROGRAM;
use crate::api::Computation;
use crate::jobs::{ComputationJob, Found};
use crate::problem::Answer;
use crate::result_cache::StudyResult;
use crate::results::background;
use crate::state::AppState;

/// Identity of the code: results of another build are computed again.
const BUILD: &str = env!("SPINELINE_BUILD");

/// Everything that the result depends on.
fn inputs(name: Computation, result: &StudyResult) -> Answer<String> {
    let fits = || -> Answer<String> {
        let models = result.analysed()?.models.iter();
        let fits = models.map(|model| format!("{:?}", model.fit.log_multipliers));
        Ok(fits.collect::<Vec<_>>().join("\n"))
    };
    let numbers = match name {
        Computation::Replicates => with_monte_carlo(result, |monte_carlo| {
            let nominal = monte_carlo.tally().finish(0).quantities;
            let values = nominal.iter().map(|one| format!("{:?}", one.nominal));
            values.collect::<Vec<_>>().join("\n")
        })?,
        Computation::Identifiability => fits()?,
        Computation::Models => {
            let asked = Hypothesis::compared().into_iter().map(Hypothesis::key);
            format!("{}\n{}", fits()?, asked.collect::<Vec<_>>().join(" "))
        }
    };
    Ok(inputs_with(result, &numbers))
}

/// Reads a stored result; `None` if it belongs to other results.
fn read(name: Computation, result: &StudyResult, kept: &KeptComputation) -> Option<Found> {
    if !inputs(name, result).is_ok_and(|inputs| kept.is_of(&inputs)) {
        return None;
    }
    let text = &kept.found;
    Some(match name {
        Computation::Replicates => Found::Replicates(serde_json::from_str(text).ok()?),
        Computation::Identifiability => Found::Identifiability(serde_json::from_str(text).ok()?),
        Computation::Models => {
            let fits = serde_json::from_str(text).ok()?;
            Found::Models(Box::new(models::compared(result.analysis()?, fits)))
        }
    })
}

/// Program with the identity of its code, case and options, with numbers of the case itself.
pub fn inputs_with(result: &StudyResult, numbers: &str) -> String {
    let case = to_line(&CaseFile::from_case(&result.current.usable_case()));
    let options = to_line(&result.current.options);
    format!("{PROGRAM}\n{BUILD}\n{SEED}\n{case}\n{options}\n{numbers}")
}

/// The result of a computation, as the store keeps it.
pub fn written(job: &ComputationJob, found: &Found) -> Option<KeptComputation> {
    let text = match found {
        Found::Replicates(found) => to_line(found),
        Found::Identifiability(found) => to_line(found),
        Found::Models(found) => to_line(&found.hypotheses),
    };
    let inputs = inputs(job.work, &job.result).ok()?;
    Some(KeptComputation::new(&inputs, job.asked, text))
}

/// Restores stored computations of these results that are not in memory.
pub async fn recall(state: &AppState, result: &Arc<StudyResult>) -> Answer<()> {
    for name in Computation::ALL {
        let read = move |result: &StudyResult, kept: &KeptComputation| {
            Some((name, read(name, result, kept)?))
        };
        background::recall(state, result, name.key(), read).await?;
    }
    Ok(())
}
