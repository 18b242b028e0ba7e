//! `spineline analyze`: one patient, or a cohort.

mod args;
mod model;
mod patient;
mod tables;
mod written;

pub use args::AnalyzeArgs;

use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use spineline::analysis::{LineModel, ModelChoice};
use spineline::cohort::{Cohort, CohortPatient, RefusalStep, RefusedCase};
use spineline::warning::counted;
use spineline_files::{Provenance, to_text};
use spineline_report::cohort::PatientRow;
use spineline_report::document::Notice;
use spineline_report::terminal::Lines;
use spineline_report::{patient as report, terminal};
use spineline_tables::cohort_tests_table;

use crate::analysis::case::Refusal;
use crate::analysis::cohort;
use crate::analysis::figures::draw_figures;
use crate::analysis::record::{ReadCases, RunRecord};
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::case_files;
use crate::run::interrupt;
use crate::run::messages::say;
use crate::run::outputs::{Outputs, is_stdout, print, print_notices};
use crate::run::progress::bar;
use crate::run::provenance::generator;
use crate::run::threads::stream_all;
use model::{choose, say_missing, write_model};
use patient::{Analysed, Asked, OutputParts};
use written::Written;

pub fn run(args: &AnalyzeArgs) -> Result<Ending, Failure> {
    let record = RunRecord::new(&args.method, &args.uncertainty)?;
    let paths = case_paths(args)?;
    let is_list = paths.len() != 1 || args.shard.is_some();
    let to_stdout = check_streams(args, is_list)?;
    let outputs = check_outputs(args, &paths)?;
    let mut written = Written::begin(args, is_list, &outputs)?;
    let asked = Asked::new(args, &record, is_list);
    let found = analyze_all(&paths, asked, &mut written, &outputs)?;
    if found.is_cut_short && !found.has_replicates {
        return Err(Failure::interrupted());
    }
    print_notices(&found.read.warnings());
    let together = statistics(&found, asked)?;
    // Results are shown although they cannot be written.
    keep(&found, together.as_ref(), asked, written, &outputs);
    let kept = outputs.commit();
    if !to_stdout {
        print(Lines::of_text(&text(&found, together.as_ref())))?;
    }
    kept?;
    if let (Some(path), Some(one), None) = (&args.model, &found.one, &found.model) {
        say_missing(path, args, &one.analysis);
    }
    Ok(if found.is_cut_short { Ending::Interrupted } else { found.ending })
}

/// Statistics over a cohort; `None` for one patient.
fn statistics(found: &Found, asked: Asked<'_>) -> Result<Option<Cohort>, Failure> {
    let of_all = || cohort::of(&found.patients, asked.args.threads);
    asked.is_cohort.then(of_all).transpose()
}

/// Writes what is left to write.
fn keep(
    found: &Found,
    together: Option<&Cohort>,
    asked: Asked<'_>,
    written: Written<'_>,
    outputs: &Outputs,
) {
    let args = asked.args;
    let provenance = || asked.record.provenance_of_all(&found.read);
    written.keep(provenance);
    if let (Some(path), Some(together)) = (&args.cohort, together) {
        outputs.attempt(path, || write_cohort(path, found, together, provenance(), outputs));
    }
    if let (Some(path), Some(one), Some(choice)) = (&args.model, &found.one, &found.model)
        && let Some(model) = one.analysis.model(choice.kind)
    {
        let chosen = (&one.analysis, model, &choice.words[..]);
        outputs.attempt(path, || write_model(path, chosen, &provenance(), outputs));
    }
}

/// The cases to analyse: all, or one part of them.
fn case_paths(args: &AnalyzeArgs) -> Result<Vec<PathBuf>, Failure> {
    let mut paths = case_files(&args.cases)?;
    let Some(shard) = args.shard else { return Ok(paths) };
    let (places, all) = (shard.places(paths.len()), paths.len());
    if places.is_empty() {
        let cases = counted(all, "case");
        return Err(Failure::usage(format!(
            "--shard {shard}: there is no case for this part, since there are {cases}; take at most {all} parts"
        )));
    }
    Ok(paths.drain(places).collect())
}

/// Refuses outputs that exclude each other; says whether one goes to the standard output.
fn check_streams(args: &AnalyzeArgs, is_list: bool) -> Result<bool, Failure> {
    let outputs = [&args.json, &args.csv, &args.chain, &args.cohort].into_iter().flatten();
    let to_stdout = outputs.filter(|path| is_stdout(path)).count();
    if to_stdout > 1 {
        return Err(Failure::usage(
            "only one of --json, --csv, --chain and --cohort can go to the standard output",
        ));
    }
    if args.model.is_some() && is_list {
        return Err(Failure::usage("--model writes the model of one case; give one case file"));
    }
    Ok(to_stdout == 1)
}

/// Checks every output before any work.
fn check_outputs(args: &AnalyzeArgs, paths: &[PathBuf]) -> Result<Outputs, Failure> {
    let inputs = paths.iter().map(PathBuf::as_path).chain(args.method.files());
    let outputs = Outputs::new(args.overwrite, inputs);
    for path in [&args.json, &args.model].into_iter().flatten() {
        outputs.file(path)?;
    }
    for path in [&args.csv, &args.chain].into_iter().flatten() {
        outputs.table(path)?;
    }
    if let Some(path) = &args.cohort {
        if is_csv(path) { outputs.table(path)? } else { outputs.file(path)? }
    }
    for folder in [&args.tables.folder, &args.figures].into_iter().flatten() {
        outputs.folder(folder)?;
    }
    Ok(outputs)
}

fn is_csv(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "csv")
}

/// What is left of the patients after their results were written.
struct Found {
    read: ReadCases,
    /// Of a cohort.
    patients: Vec<CohortPatient>,
    rows: Vec<PatientRow>,
    /// Cases of a list without a result.
    refused: Vec<RefusedCase>,
    /// Of a single case.
    one: Option<Analysed>,
    /// The model of it that is written, where one is asked for.
    model: Option<ModelChoice>,
    ending: Ending,
    is_cut_short: bool,
    has_replicates: bool,
}

/// Analyses all cases and writes their results one after the other; in a cohort, a case that fails is reported and left out.
fn analyze_all(
    paths: &[PathBuf],
    asked: Asked<'_>,
    written: &mut Written<'_>,
    outputs: &Outputs,
) -> Result<Found, Failure> {
    let Asked { args, record, .. } = asked;
    let _deferred = record.request.replicates.map(|_| interrupt::defer());
    let progress =
        if asked.is_long() { ProgressBar::hidden() } else { bar("analysing", paths.len()) };
    let mut found = Found {
        read: ReadCases::default(),
        patients: Vec::new(),
        rows: Vec::new(),
        refused: Vec::new(),
        one: None,
        model: None,
        ending: Ending::Done,
        is_cut_short: false,
        has_replicates: false,
    };
    let run = |place: usize| Analysed::of(&paths[place], asked);
    let across = if asked.is_long() { 1 } else { args.threads };
    stream_all(&progress, paths.len(), across, run, |result| {
        let checked = result.and_then(|one| match found.read.add(&one.input, record) {
            Ok(()) => Ok(one),
            Err(failure) => {
                Err(Refusal::new(&one.path, Some(&one.input), RefusalStep::Counting, failure))
            }
        });
        match checked {
            Ok(one) => {
                let notices = notices(&one);
                found.add(one, asked, written, outputs);
                // Nobody waits for the results of an interrupted run that has none.
                if !found.is_cut_short || found.has_replicates {
                    progress.suspend(|| print_notices(&notices));
                }
                Ok(())
            }
            Err(refusal) if !asked.is_list => Err(refusal.failure),
            Err(Refusal { case, failure }) => {
                progress.suspend(|| say(&failure));
                found.ending = Ending::BadInput;
                case.case_id.iter().for_each(|id| outputs.of_case(id));
                written.add(OutputParts::refused(&case, asked));
                found.refused.push(*case);
                Ok(())
            }
        }
    })?;
    Ok(found)
}

/// What a person is told of a patient.
fn notices(one: &Analysed) -> Vec<Notice> {
    let mut all = report::warnings(&one.analysis);
    all.extend(one.confidence.interruption(&one.analysis));
    all
}

impl Found {
    /// Writes what a patient adds to the outputs, and keeps the rest.
    fn add(
        &mut self,
        mut one: Analysed,
        asked: Asked<'_>,
        written: &mut Written<'_>,
        outputs: &Outputs,
    ) {
        outputs.of_case(&one.analysis.case_id);
        written.add(std::mem::take(&mut one.parts));
        let Analysed { input, analysis, confidence, row, .. } = &mut one;
        let args = asked.args;
        if let Some(folder) = &args.figures {
            let provenance = asked.record.provenance_of(input);
            outputs.attempt(folder, || draw_figures(analysis, &provenance, folder, outputs));
        }
        self.is_cut_short |= confidence.is_cut_short();
        self.has_replicates |= confidence.has_replicates();
        self.model = args.model.as_ref().and_then(|_| choose(args, analysis));
        let chosen = self.model.as_ref().and_then(|choice| analysis.model(choice.kind));
        let is_written = args.model.is_none() || chosen.is_some_and(LineModel::is_converged);
        if self.ending == Ending::Done && !(analysis.has_what_was_asked() && is_written) {
            self.ending = Ending::NotConverged;
        }
        if let Some((patient, row)) = row.take() {
            self.patients.push(patient);
            self.rows.push(row);
        }
        if !asked.is_list {
            self.one = Some(one);
        }
    }
}

/// What is shown: a cohort in short, or one patient.
fn text(found: &Found, together: Option<&Cohort>) -> String {
    let generator = generator();
    let document = match (&found.one, together) {
        (Some(one), _) => {
            report::summary(&one.confidence.report(&one.analysis, &one.input.case, &generator))
        }
        (None, Some(together)) => {
            spineline_report::cohort::summary(&found.rows, together, &found.refused, &generator)
        }
        (None, None) => return String::new(),
    };
    terminal(&document, terminal::WIDTH)
}

fn write_cohort(
    path: &Path,
    found: &Found,
    cohort: &Cohort,
    provenance: Provenance,
    outputs: &Outputs,
) -> Result<(), Failure> {
    if is_csv(path) {
        return outputs.write_table(path, cohort_tests_table(cohort).to_csv()?, &provenance);
    }
    let Found { read, refused, .. } = found;
    let file = cohort::file(read.ids(), cohort, refused, &generator()).with_provenance(provenance);
    outputs.write(path, to_text(&file))
}
