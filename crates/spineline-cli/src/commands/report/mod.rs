//! `spineline report`: one patient or a cohort as HTML, PDF or Markdown.

mod args;
mod cohort;
mod films;
mod patient;
mod write;

use crate::run::failure::{Ending, Failure};
use crate::run::inputs::case_files;

pub use args::{EXAMPLES, ReportArgs};

pub fn run(args: &ReportArgs) -> Result<Ending, Failure> {
    let paths = case_files(&args.cases)?;
    match &paths[..] {
        [one] => patient::run(one, args),
        many => cohort::run(many, args),
    }
}
