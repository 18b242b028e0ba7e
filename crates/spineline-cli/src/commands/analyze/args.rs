//! The command line of `analyze`.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use spineline::action::LineKind;

use crate::options::method::MethodArgs;
use crate::options::uncertainty::UncertaintyArgs;
use crate::options::values::threads;
use crate::run::outputs::OverwriteArgs;
use crate::run::shard::Shard;

/// The name of [`ModelLine::Auto`].
const AUTO: &str = "auto";

/// Which model is written.
#[derive(Clone, Copy)]
pub enum ModelLine {
    /// The model of the line with the smallest error on predicted films, or else the first one with a result.
    Auto,
    /// The model of this line.
    Kind(LineKind),
}

/// Reads `auto` or the name of a line; help and completion list all of them.
fn model_line() -> impl TypedValueParser<Value = ModelLine> {
    let lines = LineKind::ALL.map(line_name);
    PossibleValuesParser::new(std::iter::once(AUTO).chain(lines)).map(|text| {
        let kind = LineKind::ALL.into_iter().find(|&kind| line_name(kind) == text);
        kind.map_or(ModelLine::Auto, ModelLine::Kind)
    })
}

/// A line in the words of `--model-line`.
pub fn line_name(kind: LineKind) -> &'static str {
    kind.key().trim_end_matches("_line")
}

pub const EXAMPLES: &str = "\
Examples:
  spineline analyze P07/case.json                      which line, how sure, how stiff
  spineline analyze P07/case.json --full               and all tables
  spineline analyze P07/case.json --replicates 1000 --identifiability --threads 0
      with intervals
  spineline analyze P07/case.json --json P07.json --model P07-model.json --figures figures
  spineline analyze cases --tables tables --cohort cohort.json
      a cohort: tables for pandas or R, and statistics over patients";

#[derive(Args)]
pub struct AnalyzeArgs {
    /// Case files, analyses, or folders of them; more than one case is a cohort
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
    /// Write the statistics of the cohort as JSON: lines of action, errors and tests; as CSV, one row per test, where the name
    /// ends in .csv (`-`: JSON to the standard output)
    #[arg(long, value_name = "FILE")]
    pub cohort: Option<PathBuf>,
    /// Write the personalised model of one case as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Line of action of the model that `--model` writes. `auto` takes the line with the smallest error on films that were not fitted,
    /// among the lines that take one number from each film. If no line predicts a film, it takes the first line with a result
    #[arg(long, value_name = "LINE", value_parser = model_line(), default_value = AUTO, requires = "model")]
    pub model_line: ModelLine,
    /// Print all tables after the answers
    #[arg(long)]
    pub full: bool,
    /// Print every warning by itself; the default is one line per kind of warning
    #[arg(long)]
    pub warnings: bool,
    /// Draw figures as SVG into this folder
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
    /// Analyse one part of the cases, such as 3/8 for the third of eight, in a job of a cluster; `spineline merge` joins the tables of
    /// all parts. Outputs have the form of a cohort
    #[arg(long, value_name = "PART/PARTS")]
    pub shard: Option<Shard>,
    /// Threads for a cohort and for replicates; 0: all cores. The number does not change the results
    #[arg(long, default_value = "0", value_parser = threads)]
    pub threads: usize,
    #[command(flatten)]
    pub overwrite: OverwriteArgs,
    #[command(flatten)]
    pub tables: TablesArgs,
    #[command(flatten)]
    pub uncertainty: UncertaintyArgs,
    #[command(flatten)]
    pub method: MethodArgs,
}

/// Tables for pandas, R, Excel and others.
#[derive(Args)]
#[command(next_help_heading = "Tables")]
pub struct TablesArgs {
    /// Write tidy tables into this folder: patients, postures, vertebrae, joints, models, multipliers, springs, lines, predictions, clinical,
    /// reliability and warnings, and other loads and uncertainty where they are asked for; dictionary.csv defines every
    /// column, provenance.json names the inputs
    #[arg(long = "tables", value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// File formats of the tables
    #[arg(
        long = "tables-format",
        value_name = "FORMAT,FORMAT",
        value_enum,
        value_delimiter = ',',
        default_values = ["csv", "parquet"],
        requires = "folder"
    )]
    pub formats: Vec<TableFormat>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub enum TableFormat {
    /// Comma-separated text
    Csv,
    /// Typed columns with units and provenance, for pandas, polars, R and DuckDB
    Parquet,
}
