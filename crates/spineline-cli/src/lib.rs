//! The `spineline` program: thin. It reads files, calls the library, and shows what came back.
//!
//! Modules, lowest first; each uses only those before it: `run`, `options`, `analysis`, `commands`. No command uses
//! another one.
//!
//! A library, so that the compiler begins with it before the machine code of the crates below it is written.

mod analysis;
mod commands;
mod options;
mod run;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Arg, CommandFactory, FromArgMatches};
use spineline_report::terminal::{Lines, shown};

use commands::{Cli, Command};
use run::failure::{Ending, Failure, INTERNAL};
use run::messages::{guarded, say};
use run::{interrupt, outputs, provenance, suggestions};

/// Runs the command line.
#[must_use]
pub fn main() -> ExitCode {
    match guarded(run) {
        Some(Ok(ending)) => ending.into(),
        Some(Err(failure)) => {
            say(&failure);
            failure.into()
        }
        None => INTERNAL.into(),
    }
}

/// Reads the command line.
fn parse(words: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> Result<Cli, clap::Error> {
    let mut command = with_negative_numbers(Cli::command());
    let mut matches = command.try_get_matches_from_mut(words)?;
    Cli::from_arg_matches_mut(&mut matches).map_err(|error| error.format(&mut command))
}

/// Lets every option take a negative number, so that it says its own limits, and not that `-1` is an unknown option.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let option = |arg: Arg| {
        let takes = arg.get_action().takes_values() && !arg.is_positional();
        arg.allow_negative_numbers(takes)
    };
    command.mut_args(option).mut_subcommands(with_negative_numbers)
}

fn run() -> Result<Ending, Failure> {
    let command = match parse(std::env::args_os()) {
        Ok(line) => {
            provenance::keep_full_paths(line.full_paths);
            line.command
        }
        // Help and version are results; everything else is a refusal with its own code.
        Err(words) if !words.use_stderr() => return outputs::shown(words.print()),
        Err(words) => refuse(words),
    };
    #[cfg(feature = "weights")]
    spineline::measure::completion::provide_shape(spineline_weights::ERECT_SPINES);
    // The decoder of films is ended by its parent.
    if !matches!(command, Command::DecodeFilm) {
        interrupt::catch()?;
    }
    commands::run(command)
}

/// Says why the command line is refused, and ends the program. If a word has hidden characters, the message shows them as
/// codes.
fn refuse(words: clap::Error) -> ! {
    let given = std::env::args_os().map(|one| one.to_string_lossy().into_owned());
    let (given, plain): (Vec<_>, Vec<_>) = given.map(|one| (shown(&one), one)).unzip();
    if given == plain {
        suggestions::near_only(words).exit();
    }
    match parse(given) {
        Err(words) if words.use_stderr() => suggestions::near_only(words).exit(),
        _ => {
            say(Lines::of_text(&words.render().to_string()));
            std::process::exit(words.exit_code());
        }
    }
}
