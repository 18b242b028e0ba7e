//! The verdict on a patient's models as one value, for lists of patients.

use super::Analysis;
use super::comparison::Ranking;
use crate::action::LineKind;
use crate::anatomy::named;
use crate::personalize::TestOutcome;

named! {
    /// The verdict of the films on a patient's models, all lines of action together.
    pub enum ModelsVerdict {
        /// Some film may not show what it is named after ([`Analysis::film_doubts`]).
        DoubtedFilm = "doubted_film" as "a film may not show what it is named after",
        /// A bend rejects each of the lines that were not fitted to it ([`Analysis::compatibility`]).
        Rejected = "rejected" as "the bends reject every line of action",
        /// No line that the bends do not reject predicts films better than a prediction without mechanics.
        NoBetter = "no_better" as "no line that the bends allow predicts films better than without mechanics",
        /// Some line predicts films better than without mechanics, with an error below the limit, and the bends do not reject it.
        Supported = "supported" as "a line predicts films better than without mechanics, and the bends do not reject it",
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
        let mut testable = self.testable_models().map(|model| model.kind);
        if outcomes.iter().any(|(kind, _)| is_rejected(*kind)) && testable.all(is_rejected) {
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
