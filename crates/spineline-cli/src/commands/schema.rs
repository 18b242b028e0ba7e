//! `spineline schema`: JSON schemas of the file formats, and the dictionary of tables and warnings.

use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::print_data;

const DICTIONARY: &str = "dictionary";

#[derive(Args)]
pub struct SchemaArgs {
    /// File format, or `dictionary`: every column of the tables and every code of a warning, as Markdown
    #[arg(value_parser = PossibleValuesParser::new(spineline_files::schema_names().into_iter().chain([DICTIONARY])))]
    name: String,
}

pub fn run(args: &SchemaArgs) -> Result<Ending, Failure> {
    if args.name == DICTIONARY {
        return print_data(&spineline_tables::dictionary_markdown());
    }
    match spineline_files::schema(&args.name) {
        Some(schema) => print_data(schema),
        None => Err(Failure::usage(format!("unknown file format {}", args.name))),
    }
}
