//! `spineline schema`: JSON schemas of the file formats.

use clap::{Args, ValueEnum};

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::print;

#[derive(Args)]
pub struct SchemaArgs {
    /// File format
    name: SchemaName,
}

#[derive(Clone, Copy, ValueEnum)]
enum SchemaName {
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
    fn key(self) -> &'static str {
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

pub fn run(args: &SchemaArgs) -> Result<Ending, Failure> {
    let schema = spineline_files::schema(args.name.key()).expect("every name has a schema");
    print(&spineline_files::to_text(&schema))
}
