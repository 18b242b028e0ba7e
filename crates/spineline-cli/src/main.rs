//! The `spineline` program: thin. It reads files, calls the library, and shows what came back.

mod account;
mod analyze;
mod args;
mod check;
mod cohort;
mod comparison;
mod decode;
mod export;
mod failure;
mod film;
mod identifiability;
mod import;
mod model;
mod models;
mod noise_study;
mod options;
mod phantom;
mod progress;
mod provenance;
mod reliability;
mod report;
mod reports;
mod reproduce;
mod rerun;
mod rows;
mod serve;
mod simulate;
mod stop;
mod study;
mod table;
mod tables;
mod uncertainty;

use std::io::Write;
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Cli, Command, SchemaName};
use failure::{Ending, Failure};

fn main() -> ExitCode {
    let cli = Cli::parse();
    match run(cli.command) {
        Ok(ending) => ending.into(),
        Err(failure) => {
            eprintln!("{failure}");
            failure.into()
        }
    }
}

fn run(command: Command) -> Result<Ending, Failure> {
    match command {
        Command::Reproduce(args) => reproduce::run(&args),
        Command::NoiseStudy(args) => noise_study::run(&args),
        Command::Analyze(args) => analyze::run(&args),
        Command::Report(args) => reports::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Import(args) => import::run(&args),
        Command::Study(args) => study::run(&args),
        Command::Serve(args) => serve::run(&args),
        Command::Account(args) => account::run(&args),
        Command::Rerun(args) => rerun::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Reliability(args) => reliability::run(&args),
        Command::Phantom(args) => phantom::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Film(args) => film::run(&args),
        Command::DecodeFilm => decode::run(),
        Command::Schema { name } => print_schema(name),
        Command::Stiffness => {
            let library = spineline::multibody::StiffnessLibrary::default();
            let file = spineline_files::StiffnessFile::from(&library);
            print(&spineline_files::to_text(&file))
        }
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "spineline", &mut script);
            print(&String::from_utf8_lossy(&script))
        }
    }
}

fn print_schema(name: SchemaName) -> Result<Ending, Failure> {
    let schema = spineline_files::schema(name.key()).expect("every name has a schema");
    print(&spineline_files::to_text(&schema))
}

/// Writes to the standard output; a reader that closed the pipe has seen enough.
fn print(text: &str) -> Result<Ending, Failure> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::write("standard output", &error))
        }
        _ => Ok(Ending::Done),
    }
}
