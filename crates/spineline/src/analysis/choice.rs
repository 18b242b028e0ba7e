//! Which personalised model stands for a patient where nobody names a line.

use super::{Analysis, LineModel};
use crate::action::LineKind;
use crate::number::fixed;

/// A model that was chosen among those of the lines, and why.
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

    /// The model of the line that predicts films which it was not fitted to best, of those that converged; where no line
    /// predicts any, the first one that converged, and where none did, the first one. `None` without any model.
    ///
    /// # Definition
    /// Lines are ranked by [`LinesCompared::ranking`](super::LinesCompared::ranking). Their order is that of [`Analysis::models`].
    #[must_use]
    pub fn choose_model(&self) -> Option<ModelChoice> {
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
                let films = ranking.role.predicted_words();
                format!(
                    "The {kind} has the smallest error on {films}, {} mm, of the lines whose model converged; {} did not converge.",
                    fixed(mm, 1),
                    lost.join(" and ")
                )
            };
            return Some(ModelChoice { kind, words });
        }
        let unpredicted = "No line has a result on films that it was not fitted to";
        Some(match self.models.iter().find(|model| model.is_converged()) {
            Some(LineModel { kind, .. }) => {
                let words =
                    format!("{unpredicted}; the {kind} is the first line whose model converged.");
                ModelChoice { kind: *kind, words }
            }
            None => {
                let kind = first.kind;
                let words = format!("No model converged; the {kind} is the first line.");
                ModelChoice { kind, words }
            }
        })
    }
}
