//! The analysis of a patient in three sentences.

use super::comparison::{FilmPredictor, FilmRole, LinesCompared};
use super::verdict::{line_with_numbers, listed, mirrored_words};
use super::{Analysis, LineModel, MultiplierVerdict};
use crate::action::LineKind;
use crate::number::fixed;
use crate::personalize::{Identifiability, IntervalVerdict, TestOutcome};

/// An analysis in short; [`Analysis::verdict`] has the evidence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Headline {
    /// How the bends test the lines; instead of this, what has to be checked first, or why the model is missing.
    pub line: String,
    /// Which line predicts best, beside the best prediction without mechanics; `None` without a model.
    pub prediction: Option<String>,
    /// How many stiffness values the fit finds, and the films identify where this was tested; `None` without a model.
    pub stiffness: Option<String>,
    /// The line of the model that these sentences are about ([`Analysis::choose_model`]).
    pub kind: Option<LineKind>,
}

impl Analysis {
    /// The verdict in short; `identifiability` has one entry per model, where it was computed.
    #[must_use]
    pub fn headline(&self, identifiability: Option<&[Option<Identifiability>]>) -> Headline {
        let compared = self.comparison();
        let chosen = self.choose_model();
        let Some(model) = chosen.and_then(|chosen| self.model(chosen.kind)) else {
            let line = self.verdict().join(" ");
            return Headline { line, prediction: None, stiffness: None, kind: None };
        };
        let tested = identifiability.and_then(|all| self.entry_of(model.kind, all));
        let doubted = self.has_doubted_film().then(|| {
            "Check the films first: some may not show what they are named after.".to_owned()
        });
        Headline {
            line: doubted.or_else(|| self.lines_headline()).unwrap_or_default(),
            prediction: Some(compared.prediction_headline()),
            stiffness: Some(self.stiffness_headline(model, tested)),
            kind: Some(model.kind),
        }
    }

    /// Which of the lines that are not fitted to the films the bends reject and keep, and which they do not test.
    fn lines_headline(&self) -> Option<String> {
        let outcome = |model| (self.compatibility(model).outcome(), model);
        let found: Vec<(TestOutcome, &LineModel)> = self.testable_models().map(outcome).collect();
        let (bends, s) = self.tested_by(found.iter().map(|(_, model)| *model));
        // A line that fewer bends have is named with its bend.
        let name = |model: &LineModel| match self.tested_by([model]) {
            (own, _) if own != bends => format!("the {} of the {own}", model.kind),
            _ => format!("the {}", model.kind),
        };
        let of = |outcome| {
            let lines = found.iter().filter(|(one, _)| *one == outcome);
            listed(&lines.map(|(_, model)| name(model)).collect::<Vec<_>>())
        };
        let (rejected, kept) = (of(TestOutcome::Rejected), of(TestOutcome::Kept));
        let sentence = match (rejected.is_empty(), kept.is_empty()) {
            (true, true) => None,
            (true, false) => Some(format!(
                "The {bends} keep{s} a single force along {kept}; this does not prove such a force."
            )),
            (false, true) => {
                Some(format!("The {bends} reject{s} a single force along {rejected}."))
            }
            (false, false) => Some(format!(
                "The {bends} reject{s} a single force along {rejected}, and keep{s} one along {kept}."
            )),
        };
        let untested = found.iter().filter(|(one, _)| *one == TestOutcome::NotTested);
        let untested = untested.map(|(_, model)| {
            format!("The {} is not tested: {}.", model.kind, self.not_tested_words(model))
        });
        let has_inflections = self.models.iter().any(|model| model.kind == LineKind::Inflection);
        let missing = (!has_inflections).then(|| "The inflection line is missing.".to_owned());
        let words: Vec<String> = missing.into_iter().chain(sentence).chain(untested).collect();
        (!words.is_empty()).then(|| words.join(" "))
    }

    /// How many stiffness values a model's fit finds and, where this was tested, the films identify.
    fn stiffness_headline(&self, model: &LineModel, tested: Option<&Identifiability>) -> String {
        let verdicts = model.verdicts(self);
        let is_found = |(group, verdict): (usize, &MultiplierVerdict)| {
            let identified = tested.map(|tested| tested.multipliers[group].verdict());
            verdict.has_value() && identified.is_none_or(|one| one == IntervalVerdict::Interval)
        };
        let found: Vec<bool> = verdicts.iter().enumerate().map(is_found).collect();
        let missing = model.groups.titles().zip(&found).filter(|(_, found)| !**found);
        let missing: Vec<String> = missing.map(|(name, _)| name).collect();
        let (all, (bends, s)) = (found.len(), self.tested_by([model]));
        let line = if self.is_rejected(model) {
            format!("{}, which the {bends} reject{s}", model.kind)
        } else {
            model.kind.to_string()
        };
        let (who, lack, open) = match tested {
            Some(_) => ("the films identify", "not identified", ""),
            None => ("the fit finds", "without a value", " (not tested)"),
        };
        let count = all - missing.len();
        if count == 0 {
            return format!("With the {line}, {who} no stiffness value.");
        }
        let missing = if missing.is_empty() {
            String::new()
        } else {
            format!("; {lack}: {}", listed(&missing))
        };
        format!("With the {line}, {who} {count} of {all} stiffness values{open}{missing}.")
    }
}

impl LinesCompared {
    /// Which line predicts best, beside the best prediction without mechanics.
    fn prediction_headline(&self) -> String {
        let Some(ranking) = self.ranking() else {
            let has_films = FilmRole::PREDICTED.into_iter().any(|role| self.count(role) > 0);
            return if has_films {
                "No line has a result on a film that it was not fitted to.".to_owned()
            } else {
                "No film was left to test a prediction.".to_owned()
            };
        };
        let films = self.ranked_films_words(&ranking);
        let (kind, mm) = ranking.best();
        if !ranking.is_prediction() {
            return self.no_prediction_words(&ranking);
        }
        // Several lines are ranked only where each takes one number from a film.
        let line = if ranking.lines.len() > 1 {
            format!(
                "Of the lines with one number per film, the {kind} has the smallest error on {films}: {} mm (not tested)",
                fixed(mm, 1)
            )
        } else {
            format!("The {kind} predicts {films} with an error of {} mm", fixed(mm, 1))
        };
        match ranking.baseline {
            None => format!("{line}."),
            Some((baseline, without_mm)) if mm < without_mm => {
                format!("{line}; without mechanics {} mm ({baseline}).", fixed(without_mm, 1))
            }
            Some((baseline, without_mm)) => format!(
                "No {} predicts {films} better than without mechanics: {kind} {} mm, {baseline} {} mm.{}",
                line_with_numbers(self.per_predicted_film(FilmPredictor::Line(kind))),
                fixed(mm, 1),
                fixed(without_mm, 1),
                mirrored_words(baseline)
            ),
        }
    }
}
