//! The patients that a command has read: none counts twice.

use std::collections::BTreeMap;

use spineline::analysis::{Case, Subject};
use spineline_files::{CaseFile, sha256_hex, to_text};

use crate::run::failure::Failure;

/// Identifiers by their lower-case form, and by the hash of the landmarks.
#[derive(Default)]
pub struct KnownPatients {
    by_id: BTreeMap<String, String>,
    by_films: BTreeMap<String, String>,
}

impl KnownPatients {
    /// Adds the patient of a case.
    ///
    /// # Errors
    /// If the identifier was read before, in any case of its letters, or the same films under another identifier: the patient would
    /// count twice.
    pub fn add(&mut self, place: &str, case: &Case) -> Result<(), Failure> {
        let films = Case { id: String::new(), subject: Subject::default(), ..case.clone() };
        let films = sha256_hex(to_text(&CaseFile::from_case(&films)).as_bytes());
        if let Some(earlier) = self.by_id.insert(case.id.to_lowercase(), case.id.clone()) {
            let text = if earlier == case.id {
                format!("the case {earlier} was given already")
            } else {
                format!("the case {} was given already as {earlier}", case.id)
            };
            return Err(Failure::input(place, &text, "give every case its own `case_id`"));
        }
        if let Some(earlier) = self.by_films.insert(films, case.id.clone()) {
            let text = format!("the case {} has the films of the case {earlier}", case.id);
            let help = "a patient counts once: leave one of the two files out";
            return Err(Failure::input(place, &text, help));
        }
        Ok(())
    }
}
