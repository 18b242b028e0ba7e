//! How a command ends, and why it stopped.

use std::fmt;
use std::io::{self, ErrorKind};
use std::path::Path;
use std::process::ExitCode;

use spineline::fault::Remedy;
use spineline_films::intake::IntakeError;
use spineline_landmarks::LandmarkError;
use spineline_report::terminal::Lines;
use spineline_tables::TableError;

/// Exit code of a fault of the program.
pub const INTERNAL: u8 = 1;
/// Exit code of a wrong command line.
const USAGE: u8 = 2;
/// Exit code of an input that cannot be used, or an output that cannot be written.
const FILES: u8 = 3;
/// Exit code of a finished command whose results are incomplete.
const LESS: u8 = 4;

/// Exit code of a command that Ctrl-C or SIGTERM ended without results, as shells have it.
pub const INTERRUPTED: u8 = 130;

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
    /// Ctrl-C ended it early; the results so far were written.
    Interrupted,
}

impl From<Ending> for ExitCode {
    fn from(ending: Ending) -> Self {
        Self::from(match ending {
            Ending::Done => 0,
            Ending::BadInput => FILES,
            Ending::NotConverged | Ending::Differs | Ending::Interrupted => LESS,
        })
    }
}

/// Why a command stopped.
#[derive(Debug)]
pub struct Failure {
    code: u8,
    what: String,
    /// Lines between what went wrong and what to do.
    details: Vec<String>,
    help: Option<String>,
    /// Other results of the same command that could not be made either.
    others: Vec<Self>,
}

/// Failures of one command that are shown; the others are counted.
const SHOWN: usize = 20;

impl Failure {
    fn new(code: u8, what: String, help: Option<String>) -> Self {
        Self { code, what, details: Vec::new(), help, others: Vec::new() }
    }

    /// All failures of a command as one, which has the code of the first; `None` without failures.
    pub fn together(failures: Vec<Self>) -> Option<Self> {
        let mut failures = failures.into_iter();
        let first = failures.next()?;
        Some(Self { others: failures.collect(), ..first })
    }

    /// The same with the name of its file at the beginning, where it is missing.
    pub fn naming(mut self, file: &Path) -> Self {
        let name = file.display().to_string();
        if !self.what.starts_with(&name) {
            self.what = format!("{name}: {}", self.what);
        }
        self
    }

    /// The command line is wrong.
    pub fn usage(what: impl Into<String>) -> Self {
        Self::new(USAGE, what.into(), None)
    }

    /// A file or its content cannot be used.
    pub fn input(
        place: impl fmt::Display,
        error: impl fmt::Display,
        help: impl Into<String>,
    ) -> Self {
        Self::files(format!("{place}: {error}"), help)
    }

    /// The same, by an error with its remedy.
    pub fn of(place: impl fmt::Display, error: &impl Remedy) -> Self {
        Self::input(place, error, error.help())
    }

    /// An output could not be written.
    pub fn write(place: &str, error: &io::Error) -> Self {
        let what = format!("{place} could not be written: {error}");
        Self::files(what, write_help(error.kind()))
    }

    /// An output that must not be written.
    pub fn target(path: &Path, why: &str, help: &str) -> Self {
        let what = format!("{} is not written: {why}", path.display());
        Self::files(what, help)
    }

    /// Ctrl-C or SIGTERM came before there was any result.
    pub fn interrupted() -> Self {
        let what = "interrupted before a result was written".to_owned();
        Self::new(INTERRUPTED, what, None)
    }

    /// A file that cannot be read as its format, or a store that refused; the message begins with its name.
    pub fn file(path: &Path, error: &impl Remedy) -> Self {
        Self::files(error.to_string(), error.help()).naming(path)
    }

    /// Landmarks of another program that cannot be read.
    pub fn landmarks(path: &Path, error: &LandmarkError) -> Self {
        match error {
            LandmarkError::File(error) => Self::file(path, error),
            _ => Self::of(path.display(), error),
        }
    }

    fn files(what: String, help: impl Into<String>) -> Self {
        Self::new(FILES, what, Some(help.into()))
    }

    /// With one more line on what went wrong.
    #[must_use]
    pub fn with_line(mut self, line: impl Into<String>) -> Self {
        self.details.push(line.into());
        self
    }

    /// What went wrong, without what to do.
    pub fn what(&self) -> &str {
        &self.what
    }

    /// Something that should not happen.
    pub fn internal(what: impl Into<String>) -> Self {
        Self::new(INTERNAL, what.into(), None)
    }
}

/// What to do about an output that could not be written.
const fn write_help(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::PermissionDenied => {
            "you may not write there: change the permissions, or name another folder"
        }
        ErrorKind::ReadOnlyFilesystem => "the disk is read-only: name a folder on another disk",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "too little space: free some, or name a folder on another disk"
        }
        ErrorKind::NotFound => "the folder is missing and could not be made: check the path",
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists => {
            "a part of this path is a file where a folder is needed: name another path"
        }
        ErrorKind::IsADirectory => "this is a folder: name a file",
        ErrorKind::InvalidFilename => {
            "the name is too long, or has characters that are not allowed here"
        }
        _ => "check the path and the disk, or name another folder",
    }
}

impl From<TableError> for Failure {
    fn from(error: TableError) -> Self {
        Self::internal(error.to_string())
    }
}

/// Films that could not be found or read.
impl From<IntakeError> for Failure {
    fn from(error: IntakeError) -> Self {
        Self::files(error.to_string(), error.help())
    }
}

impl From<&Failure> for Lines {
    fn from(failure: &Failure) -> Self {
        let mut lines = Self::of(format!("error: {}", failure.what));
        for line in &failure.details {
            lines.line(line);
        }
        if let Some(help) = &failure.help {
            lines.line(format!("  help: {help}"));
        }
        for other in failure.others.iter().take(SHOWN) {
            lines.text(Self::from(other).as_str());
        }
        let more = failure.others.len().saturating_sub(SHOWN);
        if more > 0 {
            lines.line(format!("error: {more} more results could not be written"));
        }
        lines
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(Lines::from(self).as_str().trim_end())
    }
}

impl From<Failure> for ExitCode {
    fn from(failure: Failure) -> Self {
        Self::from(failure.code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_advice_on_an_output_fits_its_fault() {
        for (kind, word) in [
            (ErrorKind::PermissionDenied, "permissions"),
            (ErrorKind::StorageFull, "space"),
            (ErrorKind::NotFound, "missing"),
            (ErrorKind::IsADirectory, "name a file"),
        ] {
            let failure = Failure::write("out.json", &io::Error::from(kind));
            assert_eq!(failure.code, FILES);
            let lines = Lines::from(&failure);
            let text = lines.as_str();
            assert!(text.starts_with("error: out.json could not be written"), "{text}");
            assert!(text.contains(&format!("help: {}", write_help(kind))), "{text}");
            assert!(text.contains(word), "{text}");
        }
    }
}
