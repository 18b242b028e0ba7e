//! `spineline simulate`: what a personalised model does under loads.

mod args;
mod loads;
mod outcome;
mod path_rows;
mod text;
mod warnings;
mod words;

pub use args::{EXAMPLES, SimulateArgs};

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ProgressBar, ProgressStyle};
use spineline::multibody::{ForceSign, PathPoint};
use spineline_io::{FileError, StoredModel, parse_model, read_text};

use crate::analyze::write_or_print;
use crate::failure::{Ending, Failure};
use crate::print;
use outcome::Outcome;

pub fn run(args: &SimulateArgs) -> Result<Ending, Failure> {
    let to_stdout = |path: &Option<std::path::PathBuf>| {
        path.as_ref().is_some_and(|path| path.as_os_str() == "-")
    };
    let outputs = [&args.json, &args.csv, &args.svg];
    let streams = outputs.into_iter().filter(|path| to_stdout(path)).count();
    if streams > 1 {
        return Err(Failure::usage(
            "only one of --json, --csv and --svg can go to the standard output",
        ));
    }
    let mut model = read_model(&args.model)?;
    if let Some(name) = args.support {
        model.support = name.support();
    }
    let (loads, notes) = loads::of(args, &model)?;
    let outcome = with_progress(|on_point| Outcome::of(args, model, loads, notes, on_point))?;
    outcome.write(args)?;
    if streams == 0 {
        print(&text::report(&outcome))?;
    } else {
        eprint!("{}", text::warnings(&outcome));
    }
    Ok(if outcome.response.ending.is_usable() { Ending::Done } else { Ending::NotConverged })
}

fn read_model(path: &Path) -> Result<StoredModel, Failure> {
    let model = read_text(path).and_then(|text| parse_model(&text));
    let model = model.map_err(|error| match &error {
        FileError::Format { .. } => Failure::input(
            &path.display().to_string(),
            &error,
            "`simulate` loads a model; `spineline analyze CASE --model FILE` writes one",
        ),
        _ => Failure::file(path, &error),
    })?;
    if model.spine.joints.is_empty() {
        let place = path.display().to_string();
        return Err(Failure::input(
            &place,
            &"the model has no joint",
            "give a model from L4 to T2",
        ));
    }
    Ok(model)
}

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Shows how far a search has come, and breaks it off at Ctrl-C; a second Ctrl-C ends the program.
fn with_progress<T>(
    search: impl FnOnce(&mut dyn FnMut(ForceSign, &PathPoint) -> ControlFlow<()>) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let handler = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    });
    handler.map_err(|error| Failure::internal(format!("Ctrl-C cannot be caught: {error}")))?;
    let spinner = ProgressBar::new_spinner();
    let style = ProgressStyle::with_template("{spinner} {msg}");
    spinner.set_style(style.expect("the template is well-formed"));
    let mut points = 0_usize;
    let result = search(&mut |_, point| {
        points += 1;
        spinner.set_message(format!("following: {points} shapes, factor {:.3}", point.factor));
        spinner.tick();
        if STOP.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    spinner.finish_and_clear();
    result
}

impl Outcome {
    fn write(&self, args: &SimulateArgs) -> Result<(), Failure> {
        if let Some(path) = &args.json {
            write_or_print(path, &self.json())?;
        }
        if let Some(path) = &args.csv {
            write_or_print(path, &path_rows::csv_text(self)?)?;
        }
        if let Some(path) = &args.svg {
            write_or_print(path, &self.svg())?;
        }
        Ok(())
    }
}
