//! The verdict on a patient's models as one value, for lists of patients.

use std::fmt;

use super::Analysis;
use super::comparison::LinesCompared;
use crate::action::LineKind;

/// What the films say of a patient's models, all lines of action together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelsVerdict {
    /// Some film may not show what it is named after ([`Analysis::film_doubts`]).
    DoubtedFilm,
    /// A bend contradicts each of the lines that were not fitted to it ([`Analysis::compatibility`]).
    Contradicted,
    /// No line that the bends do not contradict predicts films better than a prediction without mechanics.
    NoBetter,
    /// Some line predicts films better than without mechanics, and the bends do not contradict it.
    Supported,
}

impl fmt::Display for ModelsVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::DoubtedFilm => "a film may not show what it is named after",
            Self::Contradicted => "the bends contradict every line of action",
            Self::NoBetter => {
                "no line that the bends allow predicts films better than without mechanics"
            }
            Self::Supported => {
                "a line predicts films better than without mechanics, and the bends do not contradict it"
            }
        })
    }
}

impl Analysis {
    /// The verdict as one value; `None` without a model. The first that applies, in the order of [`ModelsVerdict`].
    ///
    /// `compared` is what [`Analysis::compare_lines`] gives. [`Analysis::verdict`] has the evidence.
    #[must_use]
    pub fn models_verdict(&self, compared: &LinesCompared) -> Option<ModelsVerdict> {
        if self.models.is_empty() {
            return None;
        }
        if self.has_doubted_film() {
            return Some(ModelsVerdict::DoubtedFilm);
        }
        let rejected: Vec<LineKind> = self
            .models
            .iter()
            .filter(|model| self.compatibility(model).rejects())
            .map(|model| model.kind)
            .collect();
        let mut tested =
            self.models.iter().map(|model| model.kind).filter(|kind| *kind != LineKind::Estimated);
        if !rejected.is_empty() && tested.all(|kind| rejected.contains(&kind)) {
            return Some(ModelsVerdict::Contradicted);
        }
        let predicts_better = compared.ranked_predictors().is_some_and(|(role, ranked)| {
            let without_mm = compared.best_baseline(role).map(|(_, mm)| mm);
            let mut allowed = ranked.iter().filter(|(kind, _)| !rejected.contains(kind));
            without_mm.is_some_and(|without_mm| allowed.any(|&(_, mm)| mm < without_mm))
        });
        Some(if predicts_better { ModelsVerdict::Supported } else { ModelsVerdict::NoBetter })
    }
}
