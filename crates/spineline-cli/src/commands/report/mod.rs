//! `spineline report`: one patient or a cohort as HTML, PDF or Markdown.

mod args;
mod cohort;
mod films;
mod patient;
mod write;

use std::path::PathBuf;

use crate::run::failure::{Ending, Failure};
use crate::run::inputs::case_files;
use crate::run::outputs::Outputs;
use crate::run::pdf;
use args::FormName;

pub use args::{EXAMPLES, ReportArgs};

pub fn run(args: &ReportArgs) -> Result<Ending, Failure> {
    if args.form()? == FormName::Pdf {
        pdf::check_is_built()?;
    }
    let paths = case_files(&args.cases)?;
    let inputs = paths.iter().map(PathBuf::as_path).chain(args.method.files());
    let outputs = Outputs::new(args.overwrite, inputs);
    if let Some(out) = &args.out {
        outputs.file(out)?;
        args.check_out()?;
    }
    if let Some(folder) = &args.figures {
        outputs.folder(folder)?;
    }
    match &paths[..] {
        [one] => patient::run(one, args, outputs),
        many => cohort::run(many, args, outputs),
    }
}
