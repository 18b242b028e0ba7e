//! The command line.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand, ValueEnum};
use spineline::action::{LineKind, LineOfAction};
use spineline::analysis::{AnalysisOptions, Grouping};
use spineline::anatomy::{Level, Posture};
use spineline::curve::{InflectionChoice, OrderRule, Site};
use spineline::multibody::Support;
use spineline::personalize::{FitTarget, Gauge, LogNormalPrior};
use spineline::spatial::{Angle, Frontal};

use crate::account::{self, AccountArgs};
use crate::export::{EXAMPLES, ExportArgs};
use crate::failure::Failure;
use crate::film::FilmArgs;
use crate::import::{self, ImportArgs};
use crate::models::{self, Chosen};
use crate::noise_study::NoiseStudyArgs;
use crate::phantom::TruthName;
use crate::reliability::{self, ReliabilityArgs};
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
    Analyze(AnalyzeArgs),
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
    #[arg(long, value_enum, default_value_t = TruthName::Rod)]
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

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum FitName {
    /// Locations and tilts of all vertebrae
    Shape,
    /// Three Ferguson angles per bend, amplitude held (the paper)
    Ferguson,
}

impl FitName {
    pub fn target(self) -> FitTarget {
        match self {
            Self::Shape => FitTarget::Shape,
            Self::Ferguson => FitTarget::Ferguson,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
pub enum SupportName {
    /// Every joint turns about three axes (the paper)
    Free,
    /// The patient lies on a table: flexion and axial hinges are locked
    Frontal,
}

impl SupportName {
    pub fn support(self) -> Support {
        match self {
            Self::Free => Support::Free,
            Self::Frontal => Support::Frontal,
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum GroupingName {
    /// One multiplier per region (the paper)
    Regional,
    /// One per joint, fitted to the whole shape
    PerJoint,
}

/// Choices of the method.
#[derive(Args)]
#[command(next_help_heading = "Method")]
pub struct OptionArgs {
    /// Order of the curves: `leave-one-out`, `paper`, or a number from 4 to 12
    #[arg(long, value_name = "RULE", default_value = "leave-one-out", value_parser = order_rule)]
    order_rule: OrderRule,
    /// What fixes the level of stiffness and force: `geometric-mean`, `frozen-force`, or `known-force:POSTURE=NEWTON`
    /// such as known-force:traction=120
    #[arg(long, value_name = "GAUGE", default_value = "geometric-mean", value_parser = gauge)]
    gauge: Gauge,
    /// What holds the patient
    #[arg(long, value_enum, default_value_t = SupportName::Free)]
    support: SupportName,
    /// What the stiffness is fitted to
    #[arg(long, value_enum, default_value_t = FitName::Shape)]
    fit: FitName,
    /// Which joints share a stiffness multiplier
    #[arg(long, value_enum, default_value_t = GroupingName::Regional)]
    multipliers: GroupingName,
    /// What is known of multipliers before the films, as a log-normal spread about their mean: `none`, `in-vivo` (0.5, the
    /// spread of segments of living scoliotic spines), or a standard deviation of ln such as 0.3
    #[arg(long, value_name = "none|in-vivo|SD", default_value = "none", value_parser = prior)]
    prior: Prior,
    /// Stiffness table to start from (`spineline stiffness` prints the built-in one)
    #[arg(long, value_name = "FILE")]
    pub stiffness: Option<PathBuf>,
    /// Inflections picked by hand, caudal first, each a vertebra or a disc: L1/T12,T6
    #[arg(long, value_name = "SITE,SITE", value_parser = inflection_sites)]
    inflections: Option<[Site; 2]>,
    /// A stretch of the erect curve counts as a lobe, bounded by inflections, when it turns at least so many degrees
    #[arg(long, value_name = "DEG", default_value = "5", value_parser = lobe)]
    min_lobe: Angle,
    /// A line of action of your own: POSTURE=Y,Z,LEAN with a point in mm and its lean from cranial in degrees, right
    /// positive; may be repeated
    #[arg(long, value_name = "LINE", value_parser = given_line)]
    given_line: Vec<(Posture, LineOfAction)>,
    /// Compare other loads and bases with the paper's line, fitted and left out: `all`, or names such as
    /// couple,weight,inflection-line+free-base (see docs/models.md)
    #[arg(long, value_name = "all|NAME,NAME", value_parser = models::chosen)]
    compare_models: Option<Chosen>,
}

impl OptionArgs {
    /// The library's options.
    ///
    /// # Errors
    /// If the stiffness table cannot be read.
    pub fn options(&self) -> Result<AnalysisOptions, Failure> {
        let mut options = AnalysisOptions {
            order_rule: self.order_rule,
            gauge: self.gauge,
            support: self.support.support(),
            target: self.fit.target(),
            grouping: match self.multipliers {
                GroupingName::Regional => Grouping::Regional,
                GroupingName::PerJoint => Grouping::PerJoint,
            },
            prior: self.prior.0,
            inflections: self
                .inflections
                .map_or(InflectionChoice::Automatic, InflectionChoice::ByHand),
            min_lobe: self.min_lobe,
            given_lines: self.given_line.clone(),
            hypotheses: self.compare_models.clone().map(|chosen| chosen.0).unwrap_or_default(),
            ..AnalysisOptions::default()
        };
        if let Some(path) = &self.stiffness {
            let read =
                spineline_io::read_text(path).and_then(|text| spineline_io::parse_stiffness(&text));
            options.library = read.map_err(|error| Failure::file(path, &error))?;
        }
        Ok(options)
    }
}

/// A prior, or none.
#[derive(Clone, Copy)]
struct Prior(Option<LogNormalPrior>);

fn prior(text: &str) -> Result<Prior, String> {
    match text {
        "none" => Ok(Prior(None)),
        "in-vivo" => Ok(Prior(Some(LogNormalPrior::IN_VIVO))),
        other => match number(other) {
            Ok(log_sd @ 0.01..=5.0) => Ok(Prior(Some(LogNormalPrior { log_sd }))),
            _ => Err("expected `none`, `in-vivo`, or a deviation of 0.01 to 5".to_owned()),
        },
    }
}

fn order_rule(text: &str) -> Result<OrderRule, String> {
    match text {
        "leave-one-out" => Ok(OrderRule::LeaveOneOut),
        "paper" => Ok(OrderRule::Paper),
        number => match usize::from_str(number) {
            Ok(order @ 4..=12) => Ok(OrderRule::Fixed(order)),
            _ => Err("expected `leave-one-out`, `paper`, or an order from 4 to 12".to_owned()),
        },
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

fn gauge(text: &str) -> Result<Gauge, String> {
    match text {
        "geometric-mean" => return Ok(Gauge::GeometricMean),
        "frozen-force" => return Ok(Gauge::FrozenForce),
        _ => {}
    }
    let expected = "expected `geometric-mean`, `frozen-force`, or `known-force:POSTURE=NEWTON`";
    let (name, force) = text
        .strip_prefix("known-force:")
        .and_then(|rest| rest.split_once('='))
        .ok_or_else(|| expected.to_owned())?;
    let force_n = number(force)?;
    if force_n == 0.0 {
        return Err("a known force must not be zero".to_owned());
    }
    Ok(Gauge::KnownForce { posture: posture(name)?, force_n })
}

pub fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(number @ 0..=1024) => Ok(number),
        _ => Err("expected 0 (all cores) to 1024".to_owned()),
    }
}

fn lobe(text: &str) -> Result<Angle, String> {
    match number(text)? {
        degrees @ 0.0..=90.0 => Ok(Angle::from_deg(degrees)),
        _ => Err("expected 0 to 90 degrees".to_owned()),
    }
}

fn inflection_sites(text: &str) -> Result<[Site; 2], String> {
    let site = |text: &str| -> Result<Site, String> {
        let level = |name: &str| {
            let level = Level::from_str(name.trim()).map_err(|error| error.to_string())?;
            level
                .model_index()
                .map(|_| level)
                .ok_or_else(|| format!("{level} is not between L4 and T2"))
        };
        let (a, b) = text.split_once('/').unwrap_or((text, text));
        let (a, b) = (level(a)?, level(b)?);
        Ok(Site { inferior: a.min(b), superior: a.max(b) })
    };
    let (caudal, cranial) =
        text.split_once(',').ok_or_else(|| "expected two sites, such as L1/T12,T6".to_owned())?;
    let sites = [site(caudal)?, site(cranial)?];
    if sites[0].inferior > sites[1].inferior {
        Err("the caudal site comes first".to_owned())
    } else {
        Ok(sites)
    }
}

fn given_line(text: &str) -> Result<(Posture, LineOfAction), String> {
    let expected = || "expected POSTURE=Y,Z,LEAN, such as left_bending=20,150,-5".to_owned();
    let (name, rest) = text.split_once('=').ok_or_else(expected)?;
    let numbers: Vec<f64> = rest.split(',').map(number).collect::<Result<_, _>>()?;
    let [y, z, lean] = numbers[..] else { return Err(expected()) };
    Ok((posture(name)?, LineOfAction::leaning(Frontal::new(y, z), Angle::from_deg(lean))))
}
