//! Cache of analyses of studies, valid until their data change.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use axum::http::StatusCode;
use spineline::analysis::{Analysis, ModelsVerdict, analyze};
use spineline::anatomy::Posture;
use spineline_files::method_text::missing_known_force;
use spineline_store::{CaseReadings, CurrentCase, CurrentFilm, Name, Store, StoreError};
use tokio::sync::oneshot;

use crate::problem::{Answer, Failure};
use crate::words;

/// The outcome of the analysis of a study.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The erect film is not complete.
    Waiting,
    /// Landmarks contradict each other.
    Refused {
        /// Stable name of the error.
        code: &'static str,
        /// What is wrong.
        text: String,
        /// What to do about it.
        help: String,
    },
    Analysed(Box<Analysis>),
}

/// Results from the readings of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyResult {
    pub study: Name,
    /// The case from which it is computed.
    pub current: CurrentCase,
    pub outcome: Outcome,
}

impl StudyResult {
    /// Analyses a case with the options of its study.
    pub fn of(study: &Name, current: CurrentCase) -> Self {
        let has_erect = current.films.get(&Posture::Erect).is_some_and(CurrentFilm::is_usable);
        let outcome = if has_erect { analysed(&current) } else { Outcome::Waiting };
        Self { study: study.clone(), current, outcome }
    }

    /// The model options that differ from the defaults, where any does.
    pub fn options_text(&self) -> Option<String> {
        Some(self.current.options.words()).filter(|words| !words.is_empty())
    }

    /// The analysis, if the outcome is one.
    pub fn analysis(&self) -> Option<&Analysis> {
        match &self.outcome {
            Outcome::Analysed(analysis) => Some(analysis),
            Outcome::Waiting | Outcome::Refused { .. } => None,
        }
    }

    /// The verdict on the models, if the study has models.
    pub fn models_verdict(&self) -> Option<ModelsVerdict> {
        self.analysis()?.models_verdict()
    }

    /// The analysis, or the reason for its absence.
    ///
    /// # Errors
    /// A refusal if the films do not allow the analysis.
    pub fn analysed(&self) -> Answer<&Analysis> {
        match &self.outcome {
            Outcome::Analysed(analysis) => Ok(analysis),
            Outcome::Waiting => {
                let text = words::progress(&self.current);
                Err(Failure::new(StatusCode::CONFLICT, "not_ready", text).help(
                    "place the landmarks of all vertebrae from L4 to T2 that are seen on the erect film, L2 to T6 at least, and finish the reading",
                ))
            }
            Outcome::Refused { text, help, .. } => Err(Failure::refused(text).help(help)),
        }
    }
}

/// The analysis of a case with the options of its study.
fn analysed(current: &CurrentCase) -> Outcome {
    let case = current.usable_case();
    let (options, prior) = match current.options.options() {
        Ok(read) => read,
        Err(error) => return refused_options(error.to_string()),
    };
    if let Some(Err(error)) = prior.map(|prior| prior.check_case("", &case.id)) {
        return refused_options(error.to_string());
    }
    if let Some(posture) = missing_known_force(&options, &case) {
        return refused_options(format!(
            "the scale constraint `known-force` names the {posture} film, which is not part of the analysis"
        ));
    }
    match analyze(&case, &options) {
        Ok(analysis) => Outcome::Analysed(Box::new(analysis)),
        Err(error) => Outcome::Refused {
            code: error.code(),
            text: error.to_string(),
            help: error.help().to_owned(),
        },
    }
}

fn refused_options(text: String) -> Outcome {
    let help = "change this model option, or reset it to its default".to_owned();
    Outcome::Refused { code: "option", text, help }
}

/// Results by study, each with its last change; events of unfinished readings do not count.
#[derive(Default)]
pub struct ResultCache(Mutex<BTreeMap<Name, (i64, Arc<StudyResult>)>>);

impl ResultCache {
    /// A cached result that includes this change.
    pub fn get(&self, study: &Name, sequence: i64) -> Option<Arc<StudyResult>> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (of, result) = kept.get(study)?;
        (*of == sequence).then(|| Arc::clone(result))
    }

    /// Keeps a result, unless one of the same or of a newer change is kept. Returns the kept one of the same change: jobs belong to it.
    pub fn keep(&self, sequence: i64, result: StudyResult) -> Arc<StudyResult> {
        let result = Arc::new(result);
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match kept.get(&result.study) {
            Some((of, same)) if *of == sequence => return Arc::clone(same),
            Some((of, _)) if *of > sequence => {}
            _ => drop(kept.insert(result.study.clone(), (sequence, Arc::clone(&result)))),
        }
        result
    }

    /// Results of the finished readings of a study, computed if not cached.
    pub fn result(&self, store: &Store, study: &Name) -> Result<Arc<StudyResult>, StoreError> {
        let sequence = store.last_result_change(study)?.sequence;
        if let Some(result) = self.get(study, sequence) {
            return Ok(result);
        }
        let current = store.current_case(study, CaseReadings::Finished)?;
        Ok(self.keep(sequence, StudyResult::of(study, current)))
    }
}

/// Computes on a separate thread. A request that is dropped before the start computes nothing.
///
/// # Errors
/// A refusal if the computation failed.
pub async fn computed<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Answer<T> {
    let (sender, result) = oneshot::channel();
    // Tasks have one type, so that they are compiled once and not for each work.
    let task: Box<dyn FnOnce() + Send> = Box::new(move || {
        let _ = sender.send(work());
    });
    tokio::task::spawn_blocking(task);
    result.await.map_err(|_| {
        Failure::internal("the computation failed")
            .help("the program has a bug: please report it with the case file")
    })
}

#[cfg(test)]
mod tests {
    use spineline_store::{Signature, Study, Timestamp};

    use super::*;

    #[test]
    fn two_requests_that_compute_one_result_share_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let name = Name::new("S-1").expect("a name");
        let by = Signature::new(name.clone(), Timestamp::from_unix_ms(0).expect("a moment"));
        let mut store = Store::create(&folder.path().join("s"), &by).expect("a store");
        store.add_study(&Study::new(name.clone(), None, true), &by).expect("a study");
        let result = || {
            let current = store.current_case(&name, CaseReadings::Finished).expect("a case");
            StudyResult::of(&name, current)
        };
        let cache = ResultCache::default();
        let first = cache.keep(2, result());
        assert!(Arc::ptr_eq(&first, &cache.keep(2, result())));
        assert!(!Arc::ptr_eq(&first, &cache.keep(1, result())), "an older one is for its request");
        assert!(cache.get(&name, 2).is_some_and(|kept| Arc::ptr_eq(&first, &kept)));
        let newer = cache.keep(3, result());
        assert!(cache.get(&name, 3).is_some_and(|kept| Arc::ptr_eq(&newer, &kept)));
    }

    #[tokio::test]
    async fn a_bug_in_the_work_is_a_refusal_that_says_nothing_of_the_case() {
        let refused = computed::<()>(|| panic!("a patient called Doe^Jane")).await;
        let problem = refused.expect_err("a refusal").into_problem();
        assert_eq!(problem.code, "internal");
        assert!(!format!("{problem:?}").contains("Doe"));
    }
}
