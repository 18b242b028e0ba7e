//! The program under test.

use std::path::Path;

use assert_cmd::Command;

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
