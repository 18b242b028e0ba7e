//! The program under test.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// The case that [`with_phantom`] makes without other arguments.
pub const CASE: &str = "cases/phantom-rod-01.json";

/// An empty folder.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a place for files")
}

/// A folder with the phantom of subject 1 under `cases`, or with those that the arguments describe.
pub fn with_phantom(arguments: &[&str]) -> TempDir {
    let here = folder();
    add_phantom(here.path(), if arguments.is_empty() { &["--subject", "1"] } else { arguments });
    here
}

/// A folder with the phantoms of these subjects under `cases`.
pub fn with_phantoms(scenario: &str, subjects: &[&str]) -> TempDir {
    let here = folder();
    for subject in subjects {
        add_phantom(here.path(), &["--scenario", scenario, "--subject", subject]);
    }
    here
}

/// Makes phantoms under `cases` in a folder.
pub fn add_phantom(folder: &Path, arguments: &[&str]) {
    done(folder, &[&["phantom", "--out", "cases"], arguments].concat());
}

/// The JSON in a file.
pub fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).expect("it was written")).expect("JSON")
}

/// The program in a folder.
pub fn spineline(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("spineline").expect("the program is built for its tests");
    command.current_dir(folder);
    command
}

/// A text with one blank between words, wherever its lines were broken.
pub fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Runs a command: standard output, standard error and exit code.
pub fn finish(command: &mut Command) -> (String, String, i32) {
    let output = command.output().expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    (text(output.stdout), text(output.stderr), output.status.code().expect("an exit code"))
}

/// Runs the program in a folder: standard output, standard error and exit code.
pub fn run(folder: &Path, arguments: &[&str]) -> (String, String, i32) {
    finish(spineline(folder).args(arguments))
}

/// The standard output of a command that has to succeed.
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    succeeded(run(folder, arguments))
}

/// The standard output, of exit code 0.
pub fn succeeded((output, error, code): (String, String, i32)) -> String {
    assert_eq!(code, 0, "{error}{output}");
    output
}

/// The standard error of a command that has to end with this code.
pub fn refused(folder: &Path, arguments: &[&str], code: i32) -> String {
    let (output, error, found) = run(folder, arguments);
    assert_eq!(found, code, "{arguments:?}: {error}{output}");
    error
}
