//! Requests for a case, and the provenance of its numbers.

use pyo3::prelude::*;
use spineline::anatomy::FilmView;
use spineline::error::Error;
use spineline::warning::Warning;
use spineline_files::ProgramRun;
use spineline_files::method_text::{OPTIONS, OptionFile, option_file};

use spineline_report::document::NoticeKind;

use crate::fault::Fault;

/// The program and its version, as in the provenance of files.
pub fn generator() -> String {
    format!("spineline {}", env!("CARGO_PKG_VERSION"))
}

/// A call from Python as the run of a program.
pub fn run(command: Vec<String>, date_utc: String) -> ProgramRun {
    ProgramRun { program: generator(), command, date_utc }
}

/// Names and values of options.
pub fn words(given: &[(String, String)]) -> impl Iterator<Item = (&str, &str)> {
    given.iter().map(|(name, value)| (name.as_str(), value.as_str()))
}

/// Refuses a case from which the distribution of joint rotations was learned.
///
/// # Errors
/// For such a case.
pub fn check_case(files: &[OptionFile], sha256: &str, case_id: &str) -> Result<(), Fault> {
    let mut priors = files.iter().filter_map(|file| file.rotation_prior.as_ref());
    Ok(priors.try_for_each(|prior| prior.check_case(sha256, case_id))?)
}

/// Whether the value of an option is the name of a file.
#[pyfunction]
pub fn names_a_file(name: &str, value: &str) -> bool {
    option_file(name, value).is_some()
}

/// The names of all options of an analysis.
#[pyfunction]
pub fn option_names() -> Vec<&'static str> {
    OPTIONS.map(|option| option.name).to_vec()
}

/// A warning, or the error that stops an analysis: a dictionary in Python.
#[derive(IntoPyObject)]
pub struct Finding {
    severity: &'static str,
    code: &'static str,
    step: &'static str,
    film: Option<&'static str>,
    level: Option<String>,
    text: String,
}

impl From<&Warning> for Finding {
    fn from(warning: &Warning) -> Self {
        Self {
            severity: NoticeKind::from(warning.code.severity()).key(),
            code: warning.code.key(),
            step: warning.code.step().key(),
            film: warning.posture.map(|posture| posture.key()),
            level: warning.level.map(|level| level.to_string()),
            text: warning.text(),
        }
    }
}

impl From<&Error> for Finding {
    fn from(error: &Error) -> Self {
        let place = error.place();
        Self {
            severity: "error",
            code: error.code(),
            step: error.step().key(),
            film: place.film.map(FilmView::key),
            level: place.level.map(|level| level.to_string()),
            text: format!("{error}: {}", error.help()),
        }
    }
}

/// `; did you mean `X`?` for the key that was probably meant; empty without a similar one.
#[pyfunction]
pub fn did_you_mean(word: &str, candidates: Vec<String>) -> String {
    let candidates: Vec<&str> = candidates.iter().map(String::as_str).collect();
    let meant = spineline_files::nearest(word, &candidates);
    meant.map(|word| format!("; did you mean `{word}`?")).unwrap_or_default()
}
