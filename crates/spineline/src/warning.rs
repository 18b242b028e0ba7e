//! Warnings: they do not stop the analysis, and every reader of a result sees them. Each says what was done about it.

mod code;

pub use code::WarningCode;

use crate::action::LineKind;
use crate::anatomy::{Level, Posture, named};

/// A number of things in words: `1 film`, `2 films`. `noun` is in the singular and takes an s.
#[must_use]
pub fn counted<N: std::fmt::Display + PartialEq + From<u8>>(count: N, noun: &str) -> String {
    let ending = if count == N::from(1) { "" } else { "s" };
    format!("{count} {noun}{ending}")
}

/// Most names in a sentence.
pub(crate) const NAMED: usize = 8;

/// The first names, and how many more there are.
#[must_use]
pub fn first_named(names: impl Iterator<Item = String>, count: usize) -> String {
    let mut named: Vec<String> = names.take(NAMED).collect();
    let more = count.saturating_sub(named.len());
    if more > 0 {
        named.push(format!("{more} more"));
    }
    named.join(", ")
}

/// A shift of levels in words: `one level higher` (1), `two levels lower` (−2).
#[must_use]
pub fn levels_apart(shift: isize) -> String {
    let way = if shift > 0 { "higher" } else { "lower" };
    match shift.unsigned_abs() {
        1 => format!("one level {way}"),
        2 => format!("two levels {way}"),
        more => format!("{more} levels {way}"),
    }
}

named! {
    /// A step of the pipeline, in its order.
    pub enum Step {
        /// Landmarks and lengths of the films.
        Measure = "measure",
        /// Curves and inflections.
        Curve = "curve",
        /// Clinical measures.
        Clinical = "clinical",
        /// The chain of segments.
        Chain = "chain",
        /// Movement from film to film.
        Motion = "motion",
        /// Lines of action.
        Action = "action",
        /// Equilibrium of the model.
        Multibody = "multibody",
        /// Stiffness fitted to the bends.
        Personalize = "personalize",
        /// Errors of the models.
        Evaluate = "evaluate",
    }
}

named! {
    /// Severity of a warning.
    pub enum Severity {
        /// Worth knowing: a choice that was made.
        Note = "note",
        /// Something may be wrong.
        Warning = "warning",
        /// The data contradict the model, or a number that is shown is not a result.
        Contradiction = "contradiction",
    }
}

/// One warning, or the reason why a number is absent.
#[derive(Debug, Clone, PartialEq)]
pub struct Warning {
    /// Which warning it is.
    pub code: WarningCode,
    /// The film it is about.
    pub posture: Option<Posture>,
    /// The vertebra it is about.
    pub level: Option<Level>,
    /// The line of action it is about.
    pub line: Option<LineKind>,
    /// What happened and what to do, in words, without the name of the line.
    pub message: String,
}

impl Warning {
    /// The message, with the line that it is about.
    #[must_use]
    pub fn text(&self) -> String {
        match self.line {
            Some(line) => format!("{line}: {}", self.message),
            None => self.message.clone(),
        }
    }

    fn new(code: WarningCode, message: impl Into<String>) -> Self {
        Self { code, posture: None, level: None, line: None, message: message.into() }
    }
}

/// The collector of every step with warnings, so that no caller can overlook them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Warnings {
    all: Vec<Warning>,
    /// Films that a person compared with the patient's records.
    checked: Vec<Posture>,
}

impl Warnings {
    /// From now on, doubts about these films are notes: a person compared them with the patient's records.
    pub(crate) fn check_films(&mut self, checked: impl IntoIterator<Item = Posture>) {
        self.checked.extend(checked);
    }

    /// Adds a problem of a whole case.
    pub fn push(&mut self, code: WarningCode, message: impl Into<String>) {
        self.add(Warning::new(code, message));
    }

    /// Adds a problem of one film.
    pub fn film(&mut self, code: WarningCode, posture: Posture, message: impl Into<String>) {
        self.add(Warning { posture: Some(posture), ..Warning::new(code, message) });
    }

    /// Adds a problem of one vertebra on one film.
    pub fn vertebra(
        &mut self,
        code: WarningCode,
        posture: Posture,
        level: Level,
        message: impl Into<String>,
    ) {
        let warning = Warning::new(code, message);
        self.add(Warning { posture: Some(posture), level: Some(level), ..warning });
    }

    /// Adds a problem of a line of action, on one film where one is given.
    pub fn line(
        &mut self,
        code: WarningCode,
        line: LineKind,
        posture: Option<Posture>,
        message: impl Into<String>,
    ) {
        self.add(Warning { line: Some(line), posture, ..Warning::new(code, message) });
    }

    /// Adds the problems of others that are not there yet.
    pub fn merge(&mut self, others: &Self) {
        others.all.iter().for_each(|warning| self.add(warning.clone()));
    }

    fn add(&mut self, warning: Warning) {
        let is_checked = warning.posture.is_some_and(|posture| self.checked.contains(&posture));
        let warning = if is_checked && warning.code.doubts_film() {
            let message = format!(
                "a person compared this film with the patient's records, so it is not in doubt: {}",
                warning.message
            );
            Warning { code: WarningCode::FilmChecked, message, ..warning }
        } else {
            warning
        };
        if !self.all.contains(&warning) {
            self.all.push(warning);
        }
    }

    /// All problems in the order in which they arose.
    #[must_use]
    pub fn all(&self) -> &[Warning] {
        &self.all
    }

    /// Whether there is a warning of this code.
    #[must_use]
    pub fn has(&self, code: WarningCode) -> bool {
        self.all.iter().any(|warning| warning.code == code)
    }
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_thing_is_singular_and_any_other_number_plural() {
        assert_eq!(counted(0_usize, "film"), "0 films");
        assert_eq!(counted(1_u64, "film"), "1 film");
        assert_eq!(counted(2_u32, "film"), "2 films");
    }
}
