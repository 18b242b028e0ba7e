//! Computations that are kept with the study, over a restart of the program.

use std::sync::Arc;

use spineline_files::{
    CaseFile, identifiability_text, parse_identifiability, parse_uncertainty, to_line,
    uncertainty_text,
};
use spineline_store::KeptComputation;

use super::replicates::{SEED, with_monte_carlo};
use crate::computation_jobs::{ComputationJob, Found, JobKind};
use crate::jobs::Ending;
use crate::problem::Answer;
use crate::result_cache::{StudyResult, computed};
use crate::results::exports::PROGRAM;
use crate::state::AppState;

/// What is kept.
#[derive(Debug, Clone, Copy)]
enum Kept {
    Replicates,
    Identifiability,
}

impl Kept {
    const ALL: [Self; 2] = [Self::Replicates, Self::Identifiability];

    /// Its name in the store.
    const fn key(self) -> &'static str {
        match self {
            Self::Replicates => "replicates",
            Self::Identifiability => "identifiability",
        }
    }

    const fn job(self) -> JobKind {
        match self {
            Self::Replicates => JobKind::Replicates,
            Self::Identifiability => JobKind::Identifiability,
        }
    }

    /// Everything that it is computed from, with the numbers of the case itself: another version of the program has others.
    fn inputs(self, result: &StudyResult) -> Answer<String> {
        let case = to_line(&CaseFile::from_case(&result.current.usable_case()));
        let options = to_line(&result.current.options);
        let numbers = match self {
            Self::Replicates => with_monte_carlo(result, |monte_carlo| {
                let nominal = monte_carlo.tally().finish(0).quantities;
                let values = nominal.iter().map(|one| format!("{:?}", one.nominal));
                values.collect::<Vec<_>>().join("\n")
            })?,
            Self::Identifiability => {
                let models = result.analysed()?.models.iter();
                let fits = models.map(|model| format!("{:?}", model.fit.log_multipliers));
                fits.collect::<Vec<_>>().join("\n")
            }
        };
        Ok(format!("{PROGRAM}\n{SEED}\n{case}\n{options}\n{numbers}"))
    }

    /// Reads what was kept; `None` where it is not of these results.
    fn read(self, result: &StudyResult, kept: &KeptComputation) -> Option<Found> {
        if !self.inputs(result).is_ok_and(|inputs| kept.is_of(&inputs)) {
            return None;
        }
        match self {
            Self::Replicates => {
                let empty = with_monte_carlo(result, |one| one.tally().finish(kept.asked)).ok()?;
                let found = parse_uncertainty(&kept.found, empty)?;
                Some(Found::Replicates(Box::new(found)))
            }
            Self::Identifiability => parse_identifiability(&kept.found).map(Found::Identifiability),
        }
    }
}

/// Keeps a finished computation. A store that cannot be written keeps nothing: the page has it all the same.
pub async fn keep(state: &AppState, job: &Arc<ComputationJob>) {
    let of = Arc::clone(job);
    let made = computed(move || {
        let Some(Ending::Done(found)) = of.ending.get() else { return None };
        let (kind, text) = match found {
            Found::Replicates(found) => (Kept::Replicates, uncertainty_text(found)),
            Found::Identifiability(found) => (Kept::Identifiability, identifiability_text(found)),
            Found::Models(_) => return None,
        };
        let inputs = kind.inputs(&of.result).ok()?;
        Some((kind.key(), KeptComputation::new(&inputs, of.asked, text)))
    });
    let Ok(Some((key, kept))) = made.await else { return };
    let study = job.result.study.clone();
    let _ = state.store(move |store| store.keep_computation(&study, key, &kept)).await;
}

/// Makes what is kept of these results known, where nothing is known of it yet.
///
/// # Errors
/// Errors of reading the store.
pub async fn recall(state: &AppState, result: &Arc<StudyResult>) -> Answer<()> {
    for kind in Kept::ALL {
        if state.jobs().of(result, kind.job()).is_some() {
            continue;
        }
        let study = result.study.clone();
        let kept = state.store(move |store| store.computation(&study, kind.key())).await?;
        let Some(kept) = kept else { continue };
        let (of, asked) = (Arc::clone(result), kept.asked);
        if let Some(found) = computed(move || kind.read(&of, &kept)).await? {
            state.jobs().recall(result, (kind.job(), ()), asked, found);
        }
    }
    Ok(())
}
