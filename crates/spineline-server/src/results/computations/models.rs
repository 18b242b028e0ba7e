//! Other loads and base supports beside the lines of action.

use std::sync::Arc;

use axum::http::StatusCode;
use spineline::analysis::{Analysis, AnalysisOptions, analyze};
use spineline::hypothesis::{Hypothesis, HypothesisFit};

use crate::jobs::{ComputationJob, Found};
use crate::problem::{Answer, Failure};
use crate::result_cache::StudyResult;
use crate::results::background::in_turns;
use crate::state::AppState;

/// One step per load and base.
pub fn steps() -> u64 {
    Hypothesis::compared().len() as u64
}

/// The analysis with all loads and bases, one after another; `None` where it was cancelled.
pub async fn all(state: &AppState, job: &Arc<ComputationJob>) -> Answer<Option<Found>> {
    let found = in_turns(state, job, 1, |job, places| {
        let asked = Hypothesis::compared();
        let chosen = places.filter_map(|place| asked.get(usize::try_from(place).ok()?));
        chosen.map(|&one| with(&job.result, one)).collect()
    });
    let Some(found) = found.await? else { return Ok(None) };
    let fits = found.into_iter().flat_map(|one| one.hypotheses).collect();
    Ok(Some(Found::Models(Box::new(compared(job.result.analysed()?, fits)))))
}

/// An analysis with all loads and bases that are compared.
pub fn compared(analysis: &Analysis, fits: Vec<HypothesisFit>) -> Analysis {
    analysis.with_hypotheses(Hypothesis::compared(), fits)
}

/// The analysis with one load and base.
fn with(result: &StudyResult, hypothesis: Hypothesis) -> Answer<Analysis> {
    let base = &result.analysed()?.options;
    let options = AnalysisOptions { hypotheses: vec![hypothesis], ..base.clone() };
    analyze(&result.current.usable_case(), &options).map_err(|error| {
        Failure::new(StatusCode::UNPROCESSABLE_ENTITY, error.code(), error.to_string())
            .help(error.help())
    })
}
