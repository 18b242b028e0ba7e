//! The personalised model that stands for a patient if the user names no line.

use super::{Analysis, LineModel, listed};
use crate::action::LineKind;
use crate::number::fixed;

/// The chosen model, and the reason.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelChoice {
    /// Its line.
    pub kind: LineKind,
    /// Why this one, in sentences.
    pub words: String,
}

impl Analysis {
    /// The model with a line of action, where there is one.
    #[must_use]
    pub fn model(&self, kind: LineKind) -> Option<&LineModel> {
        self.models.iter().find(|model| model.kind == kind)
    }

    /// The models of the lines that bends can test: the films do not determine these lines.
    pub(crate) fn testable_models(&self) -> impl Iterator<Item = &LineModel> {
        self.models.iter().filter(|model| model.kind != LineKind::Estimated)
    }

    /// The entry of a line's model in a list with one entry per model.
    #[must_use]
    pub fn entry_of<'a, T>(&self, kind: LineKind, all: &'a [Option<T>]) -> Option<&'a T> {
        let place = self.models.iter().position(|model| model.kind == kind)?;
        all.get(place)?.as_ref()
    }

    /// Whether the bends reject a single force along a model's line. Bends cannot test a line that is fitted to them, and doubted
    /// films test no line.
    pub(super) fn is_rejected(&self, model: &LineModel) -> bool {
        let is_tested = model.kind != LineKind::Estimated && !self.has_doubted_film();
        is_tested && self.compatibility(model).rejects()
    }

    /// The converged model of the line that best predicts films that were not fitted; if no line predicts any, the first converged
    /// model whose line the bends do not reject, or else the first converged model, or else the first model. `None` without any
    /// model. The words say so where the bends reject its line.
    ///
    /// # Definition
    /// Lines are ranked by [`LinesCompared::ranking`](super::LinesCompared::ranking). They are in the order of [`Analysis::models`].
    #[must_use]
    pub fn choose_model(&self) -> Option<ModelChoice> {
        let mut choice = self.first_choice()?;
        if let Some(model) = self.model(choice.kind).filter(|model| self.is_rejected(model)) {
            let (bends, s) = self.tested_by([model]);
            choice.words.push_str(&format!(" The {bends} reject{s} this line."));
        }
        Some(choice)
    }

    fn first_choice(&self) -> Option<ModelChoice> {
        let compared = self.comparison();
        let first = self.models.first()?;
        let converged = |kind: LineKind| self.model(kind).is_some_and(LineModel::is_converged);
        let ranking = compared.ranking();
        let best = ranking.as_ref().and_then(|ranking| {
            let found = ranking.lines.iter().find(|(kind, _)| converged(*kind))?;
            Some((ranking, *found))
        });
        if let Some((ranking, (kind, mm))) = best {
            let lost =
                ranking.lines.iter().map(|(kind, _)| kind).take_while(|other| **other != kind);
            let lost: Vec<String> = lost.map(|kind| format!("the {kind}")).collect();
            let words = if lost.is_empty() {
                compared.choice_words().unwrap_or_default()
            } else {
                let films = ranking.role.films_words();
                format!(
                    "The {kind} has the smallest error on {films}, {} mm, of the lines with a converged model; {} did not converge.",
                    fixed(mm, 1),
                    listed(&lost)
                )
            };
            return Some(ModelChoice { kind, words });
        }
        let usable = || self.models.iter().filter(|model| model.is_converged());
        let allowed = usable().find(|model| !self.is_rejected(model));
        let Some(LineModel { kind, .. }) = allowed.or_else(|| usable().next()) else {
            let words = format!("No model converged; the {} is the first line.", first.kind);
            return Some(ModelChoice { kind: first.kind, words });
        };
        let and = if allowed.is_some() { " and which is not rejected" } else { "" };
        let words = format!(
            "No line has a result on films that it was not fitted to; the {kind} is the first line with a converged model{and}."
        );
        Some(ModelChoice { kind: *kind, words })
    }
}
