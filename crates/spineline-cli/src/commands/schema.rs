//! `spineline schema`: JSON schemas of the file formats.

use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::print_data;

#[derive(Args)]
pub struct SchemaArgs {
    /// File format
    #[arg(value_parser = PossibleValuesParser::new(spineline_files::schema_names()))]
    name: String,
}

pub fn run(args: &SchemaArgs) -> Result<Ending, Failure> {
    match spineline_files::schema(&args.name) {
        Some(schema) => print_data(schema),
        None => Err(Failure::usage(format!("unknown file format {}", args.name))),
    }
}
