//! The program under test, in a folder.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// The case that [`with_phantom`] makes without other arguments.
pub const CASE: &str = "cases/phantom-rod-01.json";

/// A folder in which the program runs, removed at the end of a test.
pub struct Here(TempDir);

impl Here {
    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.folder().join(name)
    }

    /// Runs the program: standard output, standard error and exit code.
    pub fn run(&self, arguments: &[&str]) -> (String, String, i32) {
        finish(spineline(self.folder()).args(arguments))
    }

    /// The program in this folder as a process of the standard library. Its configuration is in the folder.
    pub fn process(&self) -> std::process::Command {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("spineline"));
        command.current_dir(self.folder()).env("XDG_CONFIG_HOME", self.path("configuration"));
        command
    }

    /// The standard output of a command that has to succeed.
    #[track_caller]
    pub fn done(&self, arguments: &[&str]) -> String {
        let (output, error, code) = self.run(arguments);
        assert_eq!(code, 0, "{arguments:?}: {error}{output}");
        output
    }

    /// The standard output of a command that ends with 0, or with 4 where a line has no result.
    #[track_caller]
    pub fn wrote(&self, arguments: &[&str]) -> String {
        let (output, error, code) = self.run(arguments);
        assert!(code == 0 || code == 4, "{arguments:?}: {code} {error}{output}");
        output
    }

    /// The standard error of a command that has to end with this code.
    #[track_caller]
    pub fn refused(&self, arguments: &[&str], code: i32) -> String {
        let (output, error, found) = self.run(arguments);
        assert_eq!(found, code, "{arguments:?}: {error}{output}");
        error
    }

    /// Runs `spineline import`; standard output, standard error and exit code.
    pub fn import(&self, arguments: &[&str]) -> (String, String, i32) {
        self.run(&[&["import"], arguments].concat())
    }

    /// The standard output of an import that has to succeed.
    #[track_caller]
    pub fn imported(&self, arguments: &[&str]) -> String {
        self.done(&[&["import"], arguments].concat())
    }

    /// The standard error of an import that has to end with this code.
    #[track_caller]
    pub fn import_refused(&self, arguments: &[&str], code: i32) -> String {
        self.refused(&[&["import"], arguments].concat(), code)
    }

    /// Makes phantoms under `cases`.
    #[track_caller]
    pub fn add_phantom(&self, arguments: &[&str]) {
        self.done(&[&["phantom", "--out", "cases"], arguments].concat());
    }

    /// The text in a file.
    #[track_caller]
    pub fn text(&self, name: impl AsRef<Path>) -> String {
        let path = self.path(name);
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    /// The JSON in a file.
    #[track_caller]
    pub fn json(&self, name: impl AsRef<Path>) -> Value {
        json(&self.text(name))
    }

    #[track_caller]
    pub fn write(&self, name: impl AsRef<Path>, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).expect("a place for a file");
    }

    /// Changes the JSON in a file.
    #[track_caller]
    pub fn change(&self, name: &str, change: impl FnOnce(&mut Value)) {
        let mut value = self.json(name);
        change(&mut value);
        self.write(name, value.to_string());
    }
}

/// An empty folder.
pub fn folder() -> Here {
    Here(tempfile::tempdir().expect("a place for files"))
}

/// A folder with the phantom of subject 1 under `cases`, or with those that the arguments describe.
pub fn with_phantom(arguments: &[&str]) -> Here {
    let here = folder();
    here.add_phantom(if arguments.is_empty() { &["--subject", "1"] } else { arguments });
    here
}

/// A folder with the phantoms of these subjects under `cases`.
pub fn with_phantoms(scenario: &str, subjects: &[&str]) -> Here {
    let here = folder();
    for subject in subjects {
        here.add_phantom(&["--scenario", scenario, "--subject", subject]);
    }
    here
}

/// The JSON of a text, and nothing else.
#[track_caller]
pub fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error} in {text}"))
}

/// The program in a folder, which keeps its configuration there, on the second of January 2026 at 03:04:05 UTC.
pub fn spineline(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("spineline").expect("the program is built for its tests");
    command.current_dir(folder).env("XDG_CONFIG_HOME", folder.join("configuration"));
    command.env("SOURCE_DATE_EPOCH", "1767323045");
    command
}

/// The words of a command line.
pub fn split(text: &str) -> Vec<&str> {
    text.split_whitespace().collect()
}

/// A text without line breaks, with one blank between words.
pub fn unwrapped(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Checks that each of these words is in a text.
#[track_caller]
pub fn assert_says(text: &str, words: &[&str]) {
    for word in words {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
}

/// Runs a command: standard output, standard error and exit code.
pub fn finish(command: &mut Command) -> (String, String, i32) {
    let output = command.output().expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    (text(output.stdout), text(output.stderr), output.status.code().expect("an exit code"))
}

/// The standard output, of exit code 0.
#[track_caller]
pub fn succeeded((output, error, code): (String, String, i32)) -> String {
    assert_eq!(code, 0, "{error}{output}");
    output
}
