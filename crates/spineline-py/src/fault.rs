//! Errors of the library as `spineline.InputError`.

use std::fmt::Display;
use std::path::Path;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use spineline::anatomy::FilmView;
use spineline::error::Error;
use spineline::fault::{ErrorPlace, Remedy};
use spineline_files::FileError;
use spineline_files::method_text::{OPTIONS, OptionError};
use spineline_landmarks::LandmarkError;
use spineline_report::terminal::shown;

/// What an `InputError` says; on the heap, since a result carries it beside what it is for.
#[derive(Default)]
pub struct Fault(Box<Facts>);

#[derive(Default)]
struct Facts {
    text: String,
    help: String,
    file: Option<String>,
    place: ErrorPlace,
}

impl Fault {
    /// Wrong input, and what to do about it.
    pub fn new(text: impl Display, help: impl Into<String>) -> Self {
        Self(Box::new(Facts { text: text.to_string(), help: help.into(), ..Facts::default() }))
    }

    /// An error of the library.
    pub fn of(error: &impl Remedy) -> Self {
        let mut fault = Self::new(error, error.help());
        fault.0.place = error.place();
        fault
    }

    /// The same, of a file.
    pub fn in_file(mut self, path: &Path) -> Self {
        let name = path.display().to_string();
        // Errors of reading name the path themselves.
        if !self.0.text.starts_with(&name) {
            self.0.text = format!("{name}: {}", self.0.text);
        }
        self.0.file = Some(name);
        self
    }

    /// The same, of a film, where none is known.
    pub fn on_film(mut self, view: Option<FilmView>) -> Self {
        self.0.place.film = self.0.place.film.or(view);
        self
    }

    /// What is wrong.
    pub fn text(&self) -> String {
        self.0.text.clone()
    }

    /// What to do about it.
    pub fn help(&self) -> String {
        self.0.help.clone()
    }

    /// The film.
    pub fn film(&self) -> Option<String> {
        self.0.place.film.map(|film| film.key().to_owned())
    }

    /// The vertebra.
    pub fn level(&self) -> Option<String> {
        self.0.place.level.map(|level| level.to_string())
    }
}

/// The Python exception.
impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        let (film, level) = (fault.film(), fault.level());
        let Facts { text, help, file, place } = *fault.0;
        let made = Python::attach(|py| -> PyResult<Self> {
            let class = py.import("spineline._errors")?.getattr("InputError")?;
            let facts = PyDict::new(py);
            facts.set_item("help", help)?;
            facts.set_item("file", file)?;
            facts.set_item("film", film)?;
            facts.set_item("level", level)?;
            facts.set_item("value", place.value)?;
            facts.set_item("limit", place.limit)?;
            // A traceback goes to a terminal.
            Ok(Self::from_value(class.call((shown(&text),), Some(&facts))?))
        });
        made.unwrap_or_else(|error| error)
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::of(&error)
    }
}

impl From<FileError> for Fault {
    fn from(error: FileError) -> Self {
        Self::of(&error)
    }
}

impl From<LandmarkError> for Fault {
    fn from(error: LandmarkError) -> Self {
        Self::of(&error)
    }
}

impl From<OptionError> for Fault {
    fn from(error: OptionError) -> Self {
        let mut fault = Self::new(&error, error.help());
        match &error {
            OptionError::Unknown { .. } => {
                let names = OPTIONS.map(|option| option.name);
                fault.0.help = format!("give one of {}", names.join(", "));
            }
            OptionError::Value { value, .. } => fault.0.place.value = value.parse().ok(),
            OptionError::File { error, .. } => fault.0.place = error.place(),
            _ => {}
        }
        fault
    }
}
