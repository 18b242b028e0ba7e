//! `spineline report`: one patient or a cohort as HTML, PDF or Markdown.

mod args;
mod cohort;
mod films;
mod patient;
#[cfg(feature = "pdf")]
mod typeset;
mod write;

use crate::analyze::case_files;
use crate::failure::{Ending, Failure};

pub use args::{EXAMPLES, ReportArgs};
#[cfg(feature = "pdf")]
pub use typeset::pdf;

pub fn run(args: &ReportArgs) -> Result<Ending, Failure> {
    let paths = case_files(&args.cases)?;
    match &paths[..] {
        [one] => patient::run(one, args),
        many => cohort::run(many, args),
    }
}
