//! The verdict on a patient's models as one value, for lists of patients.

use std::fmt;

use super::Analysis;
use super::comparison::Ranking;
use crate::action::LineKind;
use crate::personalize::TestOutcome;

/// The verdict of the films on a patient's models, all lines of action together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelsVerdict {
    /// Some film may not show what it is named after ([`Analysis::film_doubts`]).
    DoubtedFilm,
    /// A bend rejects each of the lines that were not fitted to it ([`Analysis::compatibility`]).
    Rejected,
    /// No line that the bends do not reject predicts films better than a prediction without mechanics.
    NoBetter,
    /// Some line predicts films better than without mechanics, with an error below the limit, and the bends do not reject it.
    Supported,
}

impl fmt::Display for ModelsVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::DoubtedFilm => "a film may not show what it is named after",
            Self::Rejected => "the bends reject every line of action",
            Self::NoBetter => {
                "no line that the bends allow predicts films better than without mechanics"
            }
            Self::Supported => {
                "a line predicts films better than without mechanics, and the bends do not reject it"
            }
        })
    }
}

impl Analysis {
    /// The verdict as one value; `None` without a model. The first that applies, in the order of [`ModelsVerdict`].
    /// [`Analysis::verdict`] has the evidence.
    #[must_use]
    pub fn models_verdict(&self) -> Option<ModelsVerdict> {
        let compared = self.comparison();
        if self.models.is_empty() {
            return None;
        }
        if self.has_doubted_film() {
            return Some(ModelsVerdict::DoubtedFilm);
        }
        let outcomes: Vec<(LineKind, TestOutcome)> = self
            .models
            .iter()
            .map(|model| (model.kind, self.compatibility(model).outcome()))
            .collect();
        let is_rejected = |kind: LineKind| outcomes.contains(&(kind, TestOutcome::Rejected));
        let mut candidates =
            outcomes.iter().map(|(kind, _)| *kind).filter(|kind| *kind != LineKind::Estimated);
        if outcomes.iter().any(|(kind, _)| is_rejected(*kind)) && candidates.all(is_rejected) {
            return Some(ModelsVerdict::Rejected);
        }
        let predicts_better = compared.ranking().is_some_and(|ranking| {
            let limit_mm = ranking.baseline.map(|(_, mm)| mm.min(Ranking::MAX_PREDICTED_MM));
            let mut allowed = ranking.lines.iter().filter(|(kind, _)| !is_rejected(*kind));
            limit_mm.is_some_and(|limit_mm| allowed.any(|&(_, mm)| mm < limit_mm))
        });
        Some(if predicts_better { ModelsVerdict::Supported } else { ModelsVerdict::NoBetter })
    }
}
