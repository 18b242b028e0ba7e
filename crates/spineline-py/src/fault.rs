//! Errors of the library as `spineline.InputError`.

use std::fmt::Display;
use std::path::Path;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use spineline::anatomy::{FilmView, Level, Posture};
use spineline::error::Error;
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
    film: Option<String>,
    level: Option<Level>,
    value: Option<f64>,
    limit: Option<f64>,
}

impl Fault {
    /// Wrong input, and what to do about it.
    pub fn new(text: impl Display, help: impl Into<String>) -> Self {
        Self(Box::new(Facts { text: text.to_string(), help: help.into(), ..Facts::default() }))
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
    pub fn on_view(mut self, view: Option<FilmView>) -> Self {
        self.0.film = self.0.film.take().or_else(|| view.map(|view| view.key().to_owned()));
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
        self.0.film.clone()
    }

    /// The vertebra.
    pub fn level(&self) -> Option<String> {
        self.0.level.map(|level| level.to_string())
    }

    /// The same, of a film.
    pub fn on_film(mut self, posture: Option<Posture>) -> Self {
        self.0.film = posture.map(|posture| posture.key().to_owned());
        self
    }
}

/// The Python exception.
impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        let Facts { text, help, file, film, level, value, limit } = *fault.0;
        let made = Python::attach(|py| -> PyResult<Self> {
            let class = py.import("spineline._errors")?.getattr("InputError")?;
            let facts = PyDict::new(py);
            facts.set_item("help", help)?;
            facts.set_item("file", file)?;
            facts.set_item("film", film)?;
            facts.set_item("level", level.map(|level| level.to_string()))?;
            facts.set_item("value", value)?;
            facts.set_item("limit", limit)?;
            // A traceback goes to a terminal.
            Ok(Self::from_value(class.call((shown(&text),), Some(&facts))?))
        });
        made.unwrap_or_else(|error| error)
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        let place = error.place();
        Self(Box::new(Facts {
            text: error.to_string(),
            help: error.help().into(),
            film: place.film.map(|film| film.key().to_owned()),
            level: place.level,
            value: place.value,
            limit: place.limit,
            file: None,
        }))
    }
}

impl From<FileError> for Fault {
    fn from(error: FileError) -> Self {
        let film = match &error {
            FileError::MixedKinds { posture }
            | FileError::NoImage { posture }
            | FileError::SourceOfCorners { posture }
            | FileError::LengthsOfPixels { posture }
            | FileError::SpacingIncomplete { posture }
            | FileError::SpacingOfPixels { posture } => Some(*posture),
            _ => None,
        };
        let level = match &error {
            FileError::ModelAxes { level, .. } | FileError::Region { level, .. } => Some(*level),
            FileError::ModelPlace { above, .. } => Some(*above),
            _ => None,
        };
        let mut fault = Self::new(&error, error.help()).on_film(film);
        fault.0.level = level;
        fault
    }
}

impl From<OptionError> for Fault {
    fn from(error: OptionError) -> Self {
        match &error {
            OptionError::Unknown { .. } => {
                let names = OPTIONS.map(|option| option.name);
                Self::new(&error, format!("give one of {}", names.join(", ")))
            }
            _ => Self::new(&error, error.help()),
        }
    }
}

impl From<LandmarkError> for Fault {
    fn from(error: LandmarkError) -> Self {
        match error {
            LandmarkError::Marks(error) => Error::from(error).into(),
            LandmarkError::File(error) => error.into(),
            other => {
                let (posture, level) = other.place();
                let mut fault = Self::new(&other, other.help()).on_film(posture);
                fault.0.level = level;
                fault.0.value = other.value();
                fault
            }
        }
    }
}
