//! `spineline report`: one patient or a cohort as HTML, PDF or Markdown.

mod args;
mod cohort;
mod films;
mod patient;
mod write;

use crate::run::failure::{Ending, Failure};
use crate::run::inputs::case_files;
use crate::run::pdf;
use args::FormName;

pub use args::{EXAMPLES, ReportArgs};

pub fn run(args: &ReportArgs) -> Result<Ending, Failure> {
    if args.to == FormName::Pdf {
        pdf::check_is_built()?;
    }
    let paths = case_files(&args.cases)?;
    match &paths[..] {
        [one] => patient::run(one, args),
        many => cohort::run(many, args),
    }
}
