//! The commands: one module each, with its command line beside it. No command uses another one.

mod account;
mod analyze;
mod check;
mod completions;
mod decode_film;
mod detect;
mod export;
mod film;
mod import;
mod learn_prior;
mod licences;
mod manual;
mod merge;
mod noise_study;
mod phantom;
mod reliability;
mod report;
mod reproduce;
mod rerun;
mod schema;
mod serve;
mod simulate;
mod stiffness;
mod study;

use clap::{CommandFactory, Parser, Subcommand};

use crate::run::failure::{Ending, Failure};

/// How every command ends.
const EXIT_CODES: &str = "\
Exit codes: 0 done; 1 internal error; 2 wrong usage; 3 bad input, or an output that cannot be written; 4 finished, \
results incomplete; 130 interrupted.

Ctrl-C and SIGTERM end a command with 130 and without results. A command that already has replicates or shapes writes these and ends \
with 4. A second Ctrl-C ends the program at once.";

/// Turns frontal radiographs of a scoliotic spine into a personalised multibody model.
///
/// Research software, not a medical device. Start with `spineline reproduce`, or make a synthetic patient with
/// `spineline phantom` and analyse it with `spineline analyze`.
#[derive(Parser)]
#[command(name = "spineline", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
    /// Name files in outputs with their folders, as the command line does; without it, outputs hold base names and SHA-256
    #[arg(long, global = true, help_heading = "Privacy")]
    pub full_paths: bool,
}

#[derive(Subcommand)]
pub enum Command {
    /// Import films from folders and archives as a case
    #[command(after_help = import::EXAMPLES, after_long_help = import::long_help())]
    Import(Box<import::ImportArgs>),
    /// Inspect radiographs: metadata, reliability of spacing and view, preview
    #[command(after_help = film::EXAMPLES)]
    Film(film::FilmArgs),
    /// Find the vertebrae on films of erect spines and write cases for you to check (experimental)
    #[command(after_help = detect::EXAMPLES)]
    Detect(detect::DetectArgs),
    /// Start the browser app on this machine
    #[command(after_help = serve::EXAMPLES)]
    Serve(serve::ServeArgs),
    /// Manage a study: films, blinded readings and a log of every change in one file
    #[command(after_help = study::EXAMPLES)]
    Study(study::StudyArgs),
    /// Manage user accounts and study permissions
    #[command(after_help = account::EXAMPLES)]
    Account(account::AccountArgs),
    /// Validate case files and list warnings
    #[command(after_help = check::EXAMPLES)]
    Check(check::CheckArgs),
    /// Analyse the films of one patient or of a cohort
    #[command(alias = "analyse", after_help = analyze::EXAMPLES)]
    Analyze(Box<analyze::AnalyzeArgs>),
    /// Write a report of one patient or of a cohort with every figure, as HTML, Markdown or PDF
    #[command(after_help = report::EXAMPLES)]
    Report(Box<report::ReportArgs>),
    /// Simulate a personalised model under forces, moments, weight, pads, straps and rods
    #[command(after_help = simulate::EXAMPLES)]
    Simulate(simulate::SimulateArgs),
    /// Export a model for MuJoCo, OpenSim or URDF, or landmarks as CSV, COCO or DICOM SR or for 3D Slicer or labelme
    #[command(after_long_help = export::EXAMPLES)]
    Export(export::ExportArgs),
    /// Repeat analyses from their files or reports and list the differences
    #[command(after_help = rerun::EXAMPLES)]
    Rerun(rerun::RerunArgs),
    /// Measure the reliability of readings: SEM, limits of agreement, ICC and Pearson, within and between observers
    #[command(after_help = reliability::EXAMPLES)]
    Reliability(reliability::ReliabilityArgs),
    /// Merge the tables of parts of a cohort that were analysed separately
    #[command(after_help = merge::EXAMPLES)]
    Merge(merge::MergeArgs),
    /// Learn how the joints of a cohort rotate in bends, for predictions without mechanics
    #[command(after_help = learn_prior::EXAMPLES)]
    LearnPrior(learn_prior::LearnPriorArgs),
    /// Make synthetic patients whose true values are known
    #[command(after_help = phantom::EXAMPLES)]
    Phantom(phantom::PhantomArgs),
    /// Repeat the paper on 54 synthetic patients, or on your cases, and compare every number with the paper's
    #[command(after_help = reproduce::EXAMPLES)]
    Reproduce(reproduce::ReproduceArgs),
    /// Test how robust the paper's claims are to landmark noise, curve order and loading scenario
    NoiseStudy(noise_study::NoiseStudyArgs),
    /// Print a built-in stiffness table, to edit and pass to `analyze --stiffness`
    Stiffness(stiffness::StiffnessArgs),
    /// Print the JSON schema of a file format
    Schema(schema::SchemaArgs),
    /// Print a completion script for your shell
    ///
    /// For bash: spineline completions bash > ~/.local/share/bash-completion/completions/spineline
    Completions(completions::CompletionsArgs),
    /// Print a manual page for `man`
    #[command(after_help = manual::EXAMPLES)]
    Manual(manual::ManualArgs),
    /// Print the licences of the program, of all packages and fonts in it, and of its weights
    #[command(alias = "licenses")]
    Licences,
    /// Decode the film on the standard input, with limits on memory and time
    #[command(hide = true)]
    DecodeFilm,
}

pub fn run(command: Command) -> Result<Ending, Failure> {
    match command {
        Command::Reproduce(args) => reproduce::run(&args),
        Command::NoiseStudy(args) => noise_study::run(&args),
        Command::Analyze(args) => analyze::run(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Import(args) => import::run(&args),
        Command::Study(args) => study::run(&args),
        Command::Serve(args) => serve::run(&args),
        Command::Account(args) => account::run(&args),
        Command::Rerun(args) => rerun::run(&args),
        Command::LearnPrior(args) => learn_prior::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Reliability(args) => reliability::run(&args),
        Command::Phantom(args) => phantom::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Film(args) => film::run(&args),
        Command::Detect(args) => detect::run(&args),
        Command::Licences => licences::run(),
        Command::DecodeFilm => decode_film::run(),
        Command::Schema(args) => schema::run(&args),
        Command::Stiffness(args) => stiffness::run(&args),
        Command::Completions(args) => completions::run(&args, &mut Cli::command()),
        Command::Manual(args) => manual::run(&args, Cli::command()),
    }
}
