//! How a command ends, and why it stopped.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use spineline_films::intake::IntakeError;
use spineline_landmarks::LandmarkError;
use spineline_store::StoreError;
use spineline_tables::TableError;

/// How a finished command ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// Everything is a result.
    Done,
    /// Some files could not be used; the others were.
    BadInput,
    /// Finished, but something did not converge.
    NotConverged,
    /// A repeated analysis differs.
    Differs,
}

impl From<Ending> for ExitCode {
    fn from(ending: Ending) -> Self {
        Self::from(match ending {
            Ending::Done => 0,
            Ending::BadInput => 3,
            Ending::NotConverged | Ending::Differs => 4,
        })
    }
}

/// Why a command stopped.
#[derive(Debug)]
pub struct Failure {
    code: u8,
    what: String,
    help: Option<String>,
}

impl Failure {
    /// The command line is wrong.
    pub fn usage(what: impl Into<String>) -> Self {
        Self { code: 2, what: what.into(), help: None }
    }

    /// A file or its content cannot be used.
    pub fn input(place: &str, error: &dyn fmt::Display, help: &str) -> Self {
        Self { code: 3, what: format!("{place}: {error}"), help: Some(help.to_owned()) }
    }

    /// An output could not be written.
    pub fn write(place: &str, error: &dyn fmt::Display) -> Self {
        Self { code: 1, what: format!("{place} could not be written: {error}"), help: None }
    }

    /// A file that cannot be read as its format.
    pub fn file(path: &Path, error: &spineline_files::FileError) -> Self {
        // Reading errors name the path themselves.
        let what = match error {
            spineline_files::FileError::Read { .. }
            | spineline_files::FileError::TooLarge { .. } => error.to_string(),
            _ => format!("{}: {error}", path.display()),
        };
        Self { code: 3, what, help: Some(error.help().to_owned()) }
    }

    /// Landmarks of another program that cannot be read.
    pub fn landmarks(path: &Path, error: &LandmarkError) -> Self {
        match error {
            LandmarkError::File(error) => Self::file(path, error),
            _ => Self::input(&path.display().to_string(), error, error.help()),
        }
    }

    /// A store that refused.
    pub fn store(path: &Path, error: &StoreError) -> Self {
        let code = if matches!(error, StoreError::Full | StoreError::Disk { .. }) { 1 } else { 3 };
        let what = format!("{}: {error}", path.display());
        Self { code, what, help: Some(error.help().to_owned()) }
    }

    /// Films that could not be found or read.
    pub fn intake(error: &IntakeError) -> Self {
        Self { code: 3, what: error.to_string(), help: Some(error.help().to_owned()) }
    }

    /// What went wrong, without what to do.
    pub fn what(&self) -> &str {
        &self.what
    }

    /// Something that should not happen.
    pub fn internal(what: impl Into<String>) -> Self {
        Self { code: 1, what: what.into(), help: None }
    }
}

impl From<TableError> for Failure {
    fn from(error: TableError) -> Self {
        Self::internal(error.to_string())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.what)?;
        match &self.help {
            Some(help) => write!(f, "\n  help: {help}"),
            None => Ok(()),
        }
    }
}

impl From<Failure> for ExitCode {
    fn from(failure: Failure) -> Self {
        Self::from(failure.code)
    }
}
