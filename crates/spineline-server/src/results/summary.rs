//! A study in the list.

use std::sync::Arc;

use spineline::analysis::ModelsVerdict;
use spineline_store::{Name, Store, StoreError};

use super::{curves, notices};
use crate::User;
use crate::access::sees_results;
use crate::api::{ResultSummary, Severity, StudyStatus};
use crate::result_cache::{Outcome, ResultCache, StudyResult};
use crate::words::progress;

impl ResultSummary {
    fn bare(status: StudyStatus, status_text: String) -> Self {
        Self { status, status_text, curve: None, warnings: 0, contradictions: 0 }
    }
}

/// A study's row in the list, from its finished readings; computed once per change of the study.
///
/// # Errors
/// Errors of reading the study; contradicting landmarks are a status.
pub fn summary(
    cache: &ResultCache,
    store: &Store,
    user: &User,
    study: &Name,
) -> Result<ResultSummary, StoreError> {
    if !sees_results(store, user, study)? {
        let text =
            "blinded readings: results are shown when all planned readings are finished".to_owned();
        return Ok(ResultSummary::bare(StudyStatus::Blinded, text));
    }
    match known(cache, store, study)? {
        Ok(result) => Ok(of_result(&result)),
        Err(refusal) => Ok(ResultSummary::bare(StudyStatus::Refused, refusal.to_string())),
    }
}

/// Results of a study, or why its films do not form a case.
pub fn known(
    cache: &ResultCache,
    store: &Store,
    study: &Name,
) -> Result<Result<Arc<StudyResult>, StoreError>, StoreError> {
    match cache.result(store, study) {
        Ok(result) => Ok(Ok(result)),
        Err(refusal @ (StoreError::ViewTwice { .. } | StoreError::Case(_))) => Ok(Err(refusal)),
        Err(error) => Err(error),
    }
}

/// The row of a result.
pub fn of_result(result: &StudyResult) -> ResultSummary {
    let notices = notices::with_comparison(result);
    let count = |severity| notices.iter().filter(|notice| notice.severity == severity).count();
    let (status, status_text) = status(result);
    ResultSummary {
        status,
        status_text,
        curve: result.analysis().and_then(curves::summary_of),
        warnings: count(Severity::Warning),
        contradictions: count(Severity::Contradiction),
    }
}

fn status(result: &StudyResult) -> (StudyStatus, String) {
    match &result.outcome {
        Outcome::Refused { text, .. } => (StudyStatus::Refused, text.clone()),
        Outcome::Waiting if result.current.films.values().all(|film| film.readings == 0) => {
            (StudyStatus::ToMark, "no finished reading".to_owned())
        }
        Outcome::Waiting => (StudyStatus::Marking, progress(&result.current)),
        Outcome::Analysed(analysis) if !analysis.is_converged() => {
            (StudyStatus::NotConverged, "a fit or a simulation did not converge".to_owned())
        }
        Outcome::Analysed(_) => match result.models_verdict() {
            Some(verdict @ ModelsVerdict::Supported) => {
                (StudyStatus::Modelled, verdict.to_string())
            }
            Some(verdict) => (StudyStatus::Unsupported, verdict.to_string()),
            None => (StudyStatus::Measured, "curve and angles; no model".to_owned()),
        },
    }
}
