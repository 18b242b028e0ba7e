//! The `spineline` program: thin. It reads files, calls the library, and shows what came back.
//!
//! Rooms, lowest first; each uses only those before it: `run`, `options`, `analysis`, `commands`. No command uses
//! another one.
//!
//! A library, so that the compiler begins with it before the machine code of the crates below it is written.

mod analysis;
mod commands;
mod options;
mod run;

use std::process::ExitCode;

use clap::Parser;

use commands::{Cli, Command};
use run::failure::{Ending, Failure};
use run::messages::{guarded, say};
use run::{interrupt, outputs, provenance, suggestions};

/// Runs the command line.
#[must_use]
pub fn main() -> ExitCode {
    match guarded(run) {
        Ok(Ok(ending)) => ending.into(),
        Ok(Err(failure)) => {
            say(&format!("{failure}\n"));
            failure.into()
        }
        Err(bug) => bug.into(),
    }
}

fn run() -> Result<Ending, Failure> {
    let command = match Cli::try_parse() {
        Ok(line) => {
            provenance::keep_full_paths(line.full_paths);
            line.command
        }
        // Help and version are results; all else is a refusal, whose code it knows.
        Err(words) if !words.use_stderr() => return outputs::shown(words.print()),
        Err(words) => suggestions::near_only(words).exit(),
    };
    // The decoder of films is ended by its parent.
    if !matches!(command, Command::DecodeFilm) {
        interrupt::catch()?;
    }
    commands::run(command)
}
