//! `spineline simulate`: a personalised model under loads.

mod args;
mod loads;
mod outcome;
mod replicates;
mod text;

pub use args::{EXAMPLES, SimulateArgs};

use std::ops::ControlFlow;
use std::path::PathBuf;

use spineline::multibody::{ForceSign, PathPoint};
use spineline::number::fixed;
use spineline_files::{FilmOrigin, InputFile, Provenance, results_text};
use spineline_tables::Table;

use crate::run::failure::{Ending, Failure};
use crate::run::inputs::{read_input, read_model};
use crate::run::outputs::{Outputs, is_stdout, print_document, print_notices};
use crate::run::provenance::{in_svg, this_run};
use crate::run::{interrupt, progress};
use outcome::Outcome;
use replicates::Source;

pub fn run(args: &SimulateArgs) -> Result<Ending, Failure> {
    let paths = [&args.json, &args.csv, &args.measures, &args.svg].into_iter().flatten();
    let streams = paths.filter(|path| is_stdout(path)).count();
    if streams > 1 {
        return Err(Failure::usage(
            "only one of --json, --csv, --measures and --svg can go to the standard output",
        ));
    }
    let outputs = check_outputs(args)?;
    let mut stored = read_model(&args.model)?;
    if let Some(support) = args.support {
        stored.model.support = support;
    }
    let (loads, notes) = loads::of(args, &stored.model)?;
    let source = Source::of(args, &stored)?;
    let outcome =
        with_progress(|on_point| Outcome::of(args, stored.model, loads, notes, on_point))?;
    let outcome = outcome.with_replicates(args, source)?;
    // Results are shown although they cannot be written.
    let written = outcome.write(args, &outputs).and_then(|()| outputs.commit_and_say());
    if streams == 0 {
        print_document(&text::report(&outcome))?;
    } else {
        print_notices(&text::notices(&outcome));
    }
    written?;
    Ok(if !outcome.response.ending.is_usable() {
        Ending::NotConverged
    } else if outcome.has_interrupted_replicates() {
        Ending::Interrupted
    } else {
        Ending::Done
    })
}

/// Checks every output before any work.
fn check_outputs(args: &SimulateArgs) -> Result<Outputs, Failure> {
    let inputs = [&args.load, &args.case].into_iter().flatten();
    let inputs = std::iter::once(&args.model).chain(inputs).map(PathBuf::as_path);
    let outputs = Outputs::new(args.overwrite, inputs);
    for path in [&args.json, &args.svg].into_iter().flatten() {
        outputs.file(path)?;
    }
    for path in [&args.csv, &args.measures].into_iter().flatten() {
        outputs.table(path)?;
    }
    Ok(outputs)
}

/// Shows the progress of a search, and interrupts it at Ctrl-C; the path so far is kept.
fn with_progress<T>(
    search: impl FnOnce(&mut dyn FnMut(ForceSign, &PathPoint) -> ControlFlow<()>) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let _stops_by_itself = interrupt::defer();
    let spinner = progress::status();
    let mut points = 0_usize;
    let result = search(&mut |_, point| {
        points += 1;
        spinner
            .set_message(format!("following: {points} shapes, factor {}", fixed(point.factor, 3)));
        spinner.tick();
        if interrupt::is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    spinner.finish_and_clear();
    result
}

impl Outcome {
    fn write(&self, args: &SimulateArgs, outputs: &Outputs) -> Result<(), Failure> {
        let inputs = std::iter::once(&args.model).chain(&args.load);
        let mut inputs: Vec<InputFile> =
            inputs.map(|path| read_input(path)).collect::<Result<_, _>>()?;
        inputs.extend(self.source.as_ref().map(|source| source.case.input.clone()));
        let films = FilmOrigin::of([self.model.synthetic]);
        let case_id = self.model.case_id.clone();
        outputs.of_case(&case_id);
        let mut provenance = Provenance::new(this_run()?, films, inputs)
            .with_published_numbers()
            .of_cases([case_id]);
        if let Some(source) = &self.source {
            provenance = provenance.asking(&source.request());
        }
        if let Some(path) = &args.json {
            let file = || self.file().with_provenance(provenance.clone());
            outputs.attempt(path, || outputs.write(path, results_text(&file())));
        }
        let table = |path: &PathBuf, table: Table| {
            let write = || outputs.write_table(path, table.to_csv()?, &provenance);
            outputs.attempt(path, write);
        };
        if let Some(path) = &args.csv {
            table(path, self.path());
        }
        if let Some(path) = &args.measures {
            table(path, self.measures());
        }
        if let Some(path) = &args.svg {
            outputs.attempt(path, || outputs.write(path, in_svg(&self.svg(), &provenance)));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use spineline::analysis::{AnalysisOptions, analyze};
    use spineline::multibody::PathEnding;
    use spineline_phantom::{Readers, Scenario, generate};
    use spineline_report::terminal;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: SimulateArgs,
    }

    /// A search that is interrupted at the shape of this number.
    fn interrupted(arguments: &[&str], at: usize) -> Outcome {
        let phantom = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists");
        let analysis = analyze(&phantom.case, &AnalysisOptions::default()).expect("a phantom");
        let model = analysis.personalised_model(&analysis.models[0]);
        let line = ["simulate", "model.json"].iter().chain(arguments);
        let args = Line::parse_from(line).args;
        let (loads, notes) = loads::of(&args, &model).expect("sound loads");
        let mut seen = 0;
        Outcome::of(&args, model, loads, notes, &mut |_, _| {
            seen += 1;
            if seen == at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .expect("sound")
    }

    #[test]
    fn an_interrupted_search_leaves_whole_files_without_a_result() {
        for arguments in [
            &["--push", "left", "--force", "50"][..],
            &["--push", "left", "--amplitude", "20", "--towards", "left"],
        ] {
            let outcome = interrupted(arguments, 3);
            assert_eq!(outcome.response.ending, PathEnding::Interrupted);
            let json: serde_json::Value =
                serde_json::from_str(&results_text(&outcome.file())).expect("whole");
            assert_eq!(json["status"], "interrupted");
            assert_eq!(json["path"].as_array().expect("a list").len(), 3);
            assert!(outcome.svg().contains("not a result (interrupted)"));
            let rows = outcome.path().to_csv().expect("a table");
            assert_eq!(rows.lines().count(), 1 + 3);
            let text = terminal::terminal(&text::report(&outcome), terminal::WIDTH);
            assert!(text.contains("INTERRUPTED · NO RESULT") && !text.contains("Cobb"), "{text}");
        }
    }

    #[test]
    fn a_search_interrupted_after_its_goal_has_no_result_either() {
        // Whether a smaller factor of the other sign exists is not known then.
        let whole = interrupted(&["--push", "left", "--amplitude", "5", "--towards", "left"], 0);
        let first = whole.response.paths[0].path.points.len();
        let cut =
            interrupted(&["--push", "left", "--amplitude", "5", "--towards", "left"], first + 1);
        assert!(whole.response.result().is_some());
        assert!(!cut.response.equilibria.is_empty() && cut.response.result().is_none());
    }
}
