//! `spineline stiffness`: the built-in stiffness tables.

use clap::Args;
use spineline::multibody::StiffnessTable;
use spineline_files::{StiffnessFile, to_text};

use crate::options::choice::choice;
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::print_data;

#[derive(Args)]
pub struct StiffnessArgs {
    /// Table
    #[arg(value_parser = choice::<StiffnessTable>(), default_value = "motion-segments")]
    table: StiffnessTable,
}

pub fn run(args: &StiffnessArgs) -> Result<Ending, Failure> {
    print_data(&to_text(&StiffnessFile::from(&args.table.library())))
}
