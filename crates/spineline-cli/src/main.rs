//! The `spineline` program: thin. It reads files, calls the library, and shows what came back.
//!
//! Rooms, lowest first; each uses only those before it: `run`, `options`, `analysis`, `commands`. No command uses
//! another one.

mod analysis;
mod commands;
mod options;
mod run;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    match commands::run(commands::Cli::parse().command) {
        Ok(ending) => ending.into(),
        Err(failure) => {
            eprintln!("{failure}");
            failure.into()
        }
    }
}
