//! Other programs, with their output in the terminal or in the file of a step.

use std::cell::RefCell;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};

thread_local! {
    /// Output of the programs that this thread starts, if not the terminal.
    static OUTPUT: RefCell<Option<File>> = const { RefCell::new(None) };
}

/// Does this work; the programs that it starts write to the file.
pub fn with_output<T>(file: File, work: impl FnOnce() -> T) -> T {
    OUTPUT.set(Some(file));
    let done = work();
    OUTPUT.set(None);
    done
}

pub fn cargo(root: &Path, arguments: &[&str]) -> Result<(), String> {
    run(root, "cargo", arguments, &[])
}

pub fn run(
    root: &Path,
    program: &str,
    arguments: &[&str],
    variables: &[(&str, &str)],
) -> Result<(), String> {
    run_with_codes(root, program, arguments, variables, &[0])
}

/// Runs a program that may end with any of these exit codes.
pub fn run_with_codes(
    root: &Path,
    program: &str,
    arguments: &[&str],
    variables: &[(&str, &str)],
    codes: &[i32],
) -> Result<(), String> {
    println!("» {program} {}", arguments.join(" "));
    let mut command = Command::new(program);
    command.args(arguments).envs(variables.iter().copied()).current_dir(root);
    OUTPUT.with_borrow(|output| {
        let copies =
            output.as_ref().and_then(|file| Some([file.try_clone().ok()?, file.try_clone().ok()?]));
        if let Some([out, err]) = copies {
            command.stdout(Stdio::from(out)).stderr(Stdio::from(err));
        }
    });
    let status =
        command.status().map_err(|error| format!("`{program}` could not be started: {error}"))?;
    if status.code().is_some_and(|code| codes.contains(&code)) {
        Ok(())
    } else {
        Err(format!("`{program} {}` failed", arguments.join(" ")))
    }
}

/// Whether a program can be started and succeeds.
pub fn answers(program: &str, arguments: &[&str]) -> bool {
    let quiet =
        Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    quiet.is_ok_and(|status| status.success())
}
