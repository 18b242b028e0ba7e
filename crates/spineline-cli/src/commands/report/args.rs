//! The command line of `report`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::options::method::MethodArgs;
use crate::options::uncertainty::UncertaintyArgs;
use crate::options::values::threads;
use crate::run::failure::Failure;
use crate::run::outputs::{OverwriteArgs, is_stdout};

/// Shown below the options.
pub const EXAMPLES: &str = "Examples:
  spineline phantom --scenario rod --subject 1 --films --out demo
  spineline report demo                        one patient as phantom-rod-01.html, for a browser
  spineline report demo --to md                Markdown, with figures in phantom-rod-01-figures
  spineline report demo --out demo.pdf         the same as PDF, to print and archive
  spineline report demo --figures pictures     all figures as SVG and PNG too
  spineline phantom --out patients && spineline report patients
                                               a cohort: table 1, box charts, tests, exclusions

A report contains its analysis as JSON: `spineline rerun` repeats it from the report alone.";

/// The form of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FormName {
    /// One interactive file for a browser, without network access
    Html,
    /// Markdown, with figures as SVG in a folder beside it
    Md,
    /// One typeset file (PDF/A-3b) with the analysis attached; only in a program built with `--features pdf`
    Pdf,
}

impl FormName {
    /// The ending of its files.
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Html => "html",
            Self::Md => "md",
            Self::Pdf => "pdf",
        }
    }

    fn of_ending(ending: &str) -> Option<Self> {
        match ending {
            "pdf" => Some(Self::Pdf),
            "md" | "markdown" => Some(Self::Md),
            "html" | "htm" => Some(Self::Html),
            _ => None,
        }
    }
}

impl ReportArgs {
    /// The format that was chosen, by name or by the extension of the file.
    ///
    /// # Errors
    /// Wrong usage: the two contradict each other.
    pub fn form(&self) -> Result<FormName, Failure> {
        let named = self.ending().and_then(|ending| FormName::of_ending(&ending));
        match (self.to, named) {
            (Some(asked), Some(named)) if asked != named => Err(Failure::usage(format!(
                "--to {} contradicts the extension of --out, which stands for {}: give one of them",
                asked.ending(),
                named.ending()
            ))),
            (asked, named) => Ok(asked.or(named).unwrap_or(FormName::Html)),
        }
    }

    /// Refuses a name that ends like a file of another format, and the standard output for Markdown.
    ///
    /// # Errors
    /// Wrong usage.
    pub fn check_out(&self) -> Result<(), Failure> {
        if self.form()? == FormName::Md && self.out.as_deref().is_some_and(is_stdout) {
            return Err(Failure::usage(
                "name a file with --out: the figures of Markdown go beside it",
            ));
        }
        match self.ending() {
            Some(other) if FormName::of_ending(&other).is_none() => Err(Failure::usage(format!(
                "--out ends in .{other}, and a report is .html, .md or .pdf: name the file so"
            ))),
            _ => Ok(()),
        }
    }

    fn ending(&self) -> Option<String> {
        let ending = self.out.as_deref().and_then(Path::extension)?;
        Some(ending.to_string_lossy().to_lowercase())
    }
}

/// `spineline report`.
#[derive(Args)]
pub struct ReportArgs {
    /// Case files, or folders of them; more than one case makes the report of a cohort
    #[arg(required = true, value_name = "CASE")]
    pub cases: Vec<PathBuf>,
    /// Format of the report [default: by the extension of --out, or html]
    #[arg(long, value_enum)]
    to: Option<FormName>,
    /// File to write [default: the case's identifier, or `cohort`, with the extension of the format]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write every figure as SVG and PNG into this folder too
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
    /// Threads; 0: all cores. The number does not change the report
    #[arg(long, default_value = "0", value_parser = threads)]
    pub threads: usize,
    #[command(flatten)]
    pub overwrite: OverwriteArgs,
    /// For the report of one patient.
    #[command(flatten)]
    pub uncertainty: UncertaintyArgs,
    #[command(flatten)]
    pub method: MethodArgs,
}
