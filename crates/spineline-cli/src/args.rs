//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use spineline::action::LineKind;
use spineline::anatomy::Posture;
use spineline_phantom::Truth;

use crate::account::{self, AccountArgs};
use crate::export::{EXAMPLES, ExportArgs};
use crate::film::FilmArgs;
use crate::import::{self, ImportArgs};
use crate::noise_study::NoiseStudyArgs;
use crate::options::{FitName, OptionArgs};
use crate::phantom::TruthName;
use crate::reliability::{self, ReliabilityArgs};
use crate::reports;
use crate::simulate;
use crate::study::{self, StudyArgs};
use crate::tables::TablesArgs;
use crate::uncertainty::UncertaintyArgs;

/// Turns frontal radiographs of a scoliotic spine into a personalised multibody model.
///
/// Research software, not a medical device. Start with `spineline reproduce`, or make a patient of your own with
/// `spineline phantom` and look at it with `spineline analyze`.
#[derive(Parser)]
#[command(name = "spineline", version, arg_required_else_help = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Run the paper on 54 synthetic patients and lay every number beside the paper's
    Reproduce(ReproduceArgs),
    /// Tell over which landmark noise, for which curves and for which truth the paper's claims hold, on synthetic patients
    NoiseStudy(NoiseStudyArgs),
    /// Analyse the films of one patient, or of a cohort
    Analyze(Box<AnalyzeArgs>),
    /// Write what was found of a patient or of a cohort as one HTML file or as Markdown, with every figure
    #[command(after_help = reports::EXAMPLES)]
    Report(Box<reports::ReportArgs>),
    /// Tell what case files hold, what is odd about them, and what can be made of them
    Check(CheckArgs),
    /// Tell how well readings repeat: errors, limits of agreement, ICC and Pearson, within and between observers
    #[command(after_help = reliability::EXAMPLES)]
    Reliability(ReliabilityArgs),
    /// Load a personalised model: forces, moments, weight, pads, straps and rods, or a force for a wanted lean
    #[command(after_help = simulate::EXAMPLES)]
    Simulate(simulate::SimulateArgs),
    /// Find films in folders and archives, and make a case of them
    #[command(after_help = import::EXAMPLES, after_long_help = import::long_help())]
    Import(Box<ImportArgs>),
    /// Keep films, blinded readings and every click in one file that proves its own history
    #[command(after_help = study::EXAMPLES)]
    Study(StudyArgs),
    /// Repeat analyses from their files or reports, and say what differs
    #[command(after_help = crate::rerun::EXAMPLES)]
    Rerun(crate::rerun::RerunArgs),
    /// Open the browser app: from films to a model, on this machine
    #[command(after_help = crate::serve::EXAMPLES)]
    Serve(crate::serve::ServeArgs),
    /// Say who may sign in to the browser app, and see which study
    #[command(after_help = account::EXAMPLES)]
    Account(AccountArgs),
    /// Make synthetic patients with known truth
    Phantom(PhantomArgs),
    /// Write a model as MuJoCo, OpenSim or URDF programs read it, or landmarks as CSV, for 3D Slicer or as DICOM SR
    #[command(after_long_help = EXAMPLES)]
    Export(ExportArgs),
    /// Tell what radiographs are, what their spacing and view are worth, and show them
    Film(FilmArgs),
    /// Decode the film on the standard input, with caps on memory and time
    #[command(hide = true)]
    DecodeFilm,
    /// Print the JSON schema of a file format
    Schema {
        /// Which format
        name: SchemaName,
    },
    /// Print the built-in stiffness table, as a start for one of your own (see `analyze --stiffness`)
    Stiffness,
    /// Print a script that completes this program's words in your shell
    ///
    /// For bash: spineline completions bash > ~/.local/share/bash-completion/completions/spineline
    Completions {
        /// Your shell
        shell: clap_complete::Shell,
    },
}

#[derive(Clone, Copy, ValueEnum)]
pub enum SchemaName {
    Case,
    Analysis,
    Cohort,
    Model,
    Load,
    Provenance,
    Reliability,
    Simulation,
    Stiffness,
}

impl SchemaName {
    pub fn key(self) -> &'static str {
        match self {
            Self::Case => "case",
            Self::Analysis => "analysis",
            Self::Cohort => "cohort",
            Self::Model => "model",
            Self::Load => "load",
            Self::Provenance => "provenance",
            Self::Reliability => "reliability",
            Self::Simulation => "simulation",
            Self::Stiffness => "stiffness",
        }
    }
}

#[derive(Args)]
pub struct ReproduceArgs {
    /// Folder for tables and figures
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    pub out: PathBuf,
    /// Seed of the phantoms and of the bootstrap
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; 0 uses all cores. The results do not depend on it
    #[arg(long, default_value = "0", value_parser = threads)]
    pub threads: usize,
    /// Factor on the deviations of the virtual readers; 0 lets one reader see the truth
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub noise: f64,
    /// What the stiffness is fitted to; the paper fitted Ferguson angles
    #[arg(long, value_enum, default_value_t = FitName::Ferguson)]
    pub fit: FitName,
}

#[derive(Args)]
pub struct CheckArgs {
    /// Case files, or folders of them
    #[arg(required = true, value_name = "CASE")]
    pub cases: Vec<PathBuf>,
}

#[derive(Args)]
pub struct PhantomArgs {
    /// What moved the spine
    #[arg(long, value_enum, default_value_t = TruthName(Truth::Rod))]
    pub truth: TruthName,
    /// Subject of the paper's Table 1, 1 to 18; all of them if not given
    #[arg(long, value_name = "N")]
    pub subject: Option<usize>,
    /// Folder for the case files
    #[arg(long, value_name = "DIR", default_value = "out/phantoms")]
    pub out: PathBuf,
    /// Seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Factor on the deviations of the virtual readers (two observers, three repeats); 0 lets one reader see the truth
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub noise: f64,
    /// Draw the radiographs too: one DICOM file per posture beside each case, which then names them; about 10 MB each
    #[arg(long)]
    pub films: bool,
    /// How `--films` stores pixels; no way loses anything
    #[arg(long, value_enum, default_value_t = EncodingName::Mixed, requires = "films")]
    pub film_encoding: EncodingName,
    /// Threads for `--films`; 0 uses all cores. The files do not depend on it
    #[arg(long, default_value = "0", value_parser = threads, requires = "films")]
    pub threads: usize,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum EncodingName {
    /// JPEG-LS, and RLE for every fifth film, as archives mix them
    Mixed,
    /// JPEG-LS Lossless, the smallest
    JpegLs,
    /// RLE Lossless
    Rle,
    /// Not compressed, about 30 MB each
    Plain,
}

#[derive(Args)]
pub struct AnalyzeArgs {
    /// Case files or analyses, or folders of them; more than one case is a cohort
    #[arg(required = true, value_name = "CASE")]
    pub cases: Vec<PathBuf>,
    /// Write the analysis as JSON (`-`: standard output); a list for a cohort
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write one row per patient, posture, line and vertebra as CSV (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write the chain of every posture as a Denavit-Hartenberg table, one row per segment, as CSV (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    pub chain: Option<PathBuf>,
    /// Write what the cases say together of the lines of action, errors and every test, as JSON; as CSV, one row per test,
    /// where the name ends in .csv (`-`: JSON to the standard output)
    #[arg(long, value_name = "FILE")]
    pub cohort: Option<PathBuf>,
    /// Write the personalised model of one case
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Line of action of the model that `--model` writes
    #[arg(long, value_enum, default_value_t = LineName::Inflection)]
    pub model_line: LineName,
    /// Draw figures as SVG into this folder
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
    /// Threads for a cohort and for replicates; 0 uses all cores. The results do not depend on it
    #[arg(long, default_value = "0", value_parser = threads)]
    pub threads: usize,
    #[command(flatten)]
    pub tables: TablesArgs,
    #[command(flatten)]
    pub uncertainty: UncertaintyArgs,
    #[command(flatten)]
    pub options: OptionArgs,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum LineName {
    Inflection,
    Iliac,
    Estimated,
    Given,
}

impl LineName {
    pub fn kind(self) -> LineKind {
        match self {
            Self::Inflection => LineKind::Inflection,
            Self::Iliac => LineKind::Iliac,
            Self::Estimated => LineKind::Estimated,
            Self::Given => LineKind::Given,
        }
    }
}

pub fn posture(text: &str) -> Result<Posture, String> {
    let wanted = text.replace('-', "_");
    Posture::ALL.into_iter().find(|posture| posture.key() == wanted).ok_or_else(|| {
        format!(
            "`{text}` is no posture; expected one of {}",
            Posture::ALL.map(Posture::key).join(", ")
        )
    })
}

pub fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a number")),
    }
}

pub fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(number @ 0..=1024) => Ok(number),
        _ => Err("expected 0 (all cores) to 1024".to_owned()),
    }
}
