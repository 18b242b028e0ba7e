//! What a patient's analysis says in three sentences.

use super::comparison::{FilmRole, LinesCompared};
use super::verdict::listed;
use super::{Analysis, Identification, LineModel};
use crate::action::LineKind;

impl Analysis {
    /// The verdict in at most three sentences: what the bends say of the lines, what predicts best, and what is identified.
    ///
    /// `compared` is what [`Analysis::compare_lines`] gives. [`Analysis::verdict`] has the evidence.
    #[must_use]
    pub fn headline(&self, compared: &LinesCompared) -> Vec<String> {
        if self.models.is_empty() {
            return self.verdict(compared);
        }
        let doubted = self.has_doubted_film().then(|| {
            "Check the films first: some may not show what they are named after.".to_owned()
        });
        let first = doubted.or_else(|| self.lines_headline());
        let best = compared.best_predictor();
        let kind = best.map_or(self.models[0].kind, |(kind, _)| kind);
        let identified = self.models.iter().find(|model| model.kind == kind);
        let last = identified.map(|model| self.identified_headline(model));
        [first, compared.prediction_headline(), last].into_iter().flatten().collect()
    }

    /// Which of the lines that are not fitted to the films the bends contradict.
    fn lines_headline(&self) -> Option<String> {
        let (mut against, mut consistent) = (Vec::new(), Vec::new());
        for model in self.models.iter().filter(|model| model.kind != LineKind::Estimated) {
            let found = self.compatibility(model);
            if found.bends.is_empty() {
                continue;
            }
            let side = if found.rejects() { &mut against } else { &mut consistent };
            side.push(format!("the {}", model.kind));
        }
        let (against_words, consistent_words) = (listed(&against), listed(&consistent));
        let sentence = match (against.is_empty(), consistent.is_empty()) {
            (true, true) => None,
            (true, false) => Some(format!(
                "The bends do not contradict a single force along {consistent_words}; this does not prove such a force."
            )),
            (false, true) => {
                Some(format!("The bends contradict a single force along {against_words}."))
            }
            (false, false) => Some(format!(
                "The bends contradict a single force along {against_words}, and do not contradict one along {consistent_words}."
            )),
        };
        let has_inflections = self.models.iter().any(|model| model.kind == LineKind::Inflection);
        let missing = (!has_inflections).then(|| "There is no inflection line.".to_owned());
        let words: Vec<String> = [missing, sentence].into_iter().flatten().collect();
        (!words.is_empty()).then(|| words.join(" "))
    }

    /// Of how many regions a model's stiffness is identified.
    fn identified_headline(&self, model: &LineModel) -> String {
        let verdicts = model.verdicts(self);
        let is_known = |found: Identification| {
            matches!(found, Identification::Absolute | Identification::RatioOnly)
        };
        let unknown: Vec<String> = model
            .groups
            .names()
            .iter()
            .zip(&verdicts)
            .filter(|(_, verdict)| !is_known(verdict.identification))
            .map(|(name, _)| name.replace('_', " "))
            .collect();
        let (all, kind) = (verdicts.len(), model.kind);
        match unknown.len() {
            0 => format!("With the {kind}, all {all} stiffness values are identified as ratios."),
            n if n == all => format!("With the {kind}, no stiffness value is identified."),
            n => format!(
                "With the {kind}, {} of {all} stiffness values are identified as ratios; not that of {}.",
                all - n,
                listed(&unknown)
            ),
        }
    }
}

impl LinesCompared {
    /// Which line predicts best, beside the best prediction without mechanics.
    fn prediction_headline(&self) -> Option<String> {
        let (kind, role) = self.best_predictor()?;
        let line = self.lines.iter().position(|line| line.kind == kind)?;
        let mm = self.errors(line, role)?.location_mm;
        let films = match role {
            FilmRole::LeftOutBend => "left-out bends",
            FilmRole::Fitted | FilmRole::HeldOut => "neutral and traction films",
        };
        Some(match self.best_baseline(role) {
            None => format!("The {kind} predicts {films} best: {mm:.1} mm."),
            Some((baseline, without_mm)) if mm < without_mm => format!(
                "The {kind} predicts {films} best: {mm:.1} mm; without mechanics {without_mm:.1} mm ({baseline})."
            ),
            Some((baseline, without_mm)) => format!(
                "No line with one parameter per film predicts {films} better than without mechanics: {kind} {mm:.1} mm, {baseline} {without_mm:.1} mm."
            ),
        })
    }
}
