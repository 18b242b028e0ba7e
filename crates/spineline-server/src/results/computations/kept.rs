//! Computations that are kept with the study, over a restart of the program.

use std::sync::Arc;

use spineline::hypothesis::Hypothesis;
use spineline_files::{
    CaseFile, hypotheses_text, identifiability_text, parse_hypotheses, parse_identifiability,
    parse_uncertainty, to_line, uncertainty_text,
};
use spineline_store::KeptComputation;

use super::models;
use super::replicates::{SEED, with_monte_carlo};
use crate::computation_jobs::{ComputationJob, Found, JobKind};
use crate::problem::Answer;
use crate::result_cache::{StudyResult, computed};
use crate::results::exports::PROGRAM;
use crate::state::AppState;

/// Identity of the code: what another build has found is computed again.
const BUILD: &str = env!("SPINELINE_BUILD");

/// What is kept.
#[derive(Debug, Clone, Copy)]
enum Kept {
    Replicates,
    Identifiability,
    Models,
}

impl Kept {
    const ALL: [Self; 3] = [Self::Replicates, Self::Identifiability, Self::Models];

    /// Its name in the store.
    const fn key(self) -> &'static str {
        match self {
            Self::Replicates => "replicates",
            Self::Identifiability => "identifiability",
            Self::Models => "models",
        }
    }

    const fn job(self) -> JobKind {
        match self {
            Self::Replicates => JobKind::Replicates,
            Self::Identifiability => JobKind::Identifiability,
            Self::Models => JobKind::Models,
        }
    }

    /// Everything that it is computed from.
    fn inputs(self, result: &StudyResult) -> Answer<String> {
        let fits = || -> Answer<String> {
            let models = result.analysed()?.models.iter();
            let fits = models.map(|model| format!("{:?}", model.fit.log_multipliers));
            Ok(fits.collect::<Vec<_>>().join("\n"))
        };
        let numbers = match self {
            Self::Replicates => with_monte_carlo(result, |monte_carlo| {
                let nominal = monte_carlo.tally().finish(0).quantities;
                let values = nominal.iter().map(|one| format!("{:?}", one.nominal));
                values.collect::<Vec<_>>().join("\n")
            })?,
            Self::Identifiability => fits()?,
            Self::Models => {
                let asked = Hypothesis::compared().into_iter().map(Hypothesis::key);
                format!("{}\n{}", fits()?, asked.collect::<Vec<_>>().join(" "))
            }
        };
        Ok(inputs_with(result, &numbers))
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
            Self::Models => {
                let fits = parse_hypotheses(&kept.found)?;
                let compared = models::compared(result.analysis()?, fits);
                Some(Found::Models(Box::new(compared)))
            }
        }
    }
}

/// Program with the identity of its code, case and options, with numbers of the case itself.
pub fn inputs_with(result: &StudyResult, numbers: &str) -> String {
    let case = to_line(&CaseFile::from_case(&result.current.usable_case()));
    let options = to_line(&result.current.options);
    format!("{PROGRAM}\n{BUILD}\n{SEED}\n{case}\n{options}\n{numbers}")
}

/// Keeps what a computation has found, before it is shown. A store that cannot be written keeps nothing: the page has it all the same.
///
/// # Errors
/// A panic of the work.
pub async fn keep(state: &AppState, job: &Arc<ComputationJob>, found: Found) -> Answer<Found> {
    let of = Arc::clone(job);
    let made = computed(move || {
        let (kind, text) = match &found {
            Found::Replicates(found) => (Kept::Replicates, uncertainty_text(found)),
            Found::Identifiability(found) => (Kept::Identifiability, identifiability_text(found)),
            Found::Models(found) => (Kept::Models, hypotheses_text(&found.hypotheses)),
        };
        let inputs = kind.inputs(&of.result).ok();
        let kept = inputs.map(|inputs| KeptComputation::new(&inputs, of.asked, text));
        (found, kind.key(), kept)
    });
    let (found, key, kept) = made.await?;
    if let Some(kept) = kept {
        let study = job.result.study.clone();
        let _ = state.store(move |store| store.keep_computation(&study, key, &kept)).await;
    }
    Ok(found)
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
