//! `spineline analyze`: one patient, or a cohort.

mod args;
mod tables;

pub use args::AnalyzeArgs;
use args::ModelLine;

use std::path::{Path, PathBuf};

use spineline::analysis::{Analysis, LineModel};
use spineline::cohort::Cohort;
use spineline_files::{AnalysisFile, ListText, ModelFile, to_text};
use spineline_report::{Document, patient, terminal};
use spineline_tables::{Patient, chain_table, cohort_tests_table, errors_table};

use crate::analysis::case::analyze_input;
use crate::analysis::cohort;
use crate::analysis::confidence::Confidence;
use crate::analysis::figures::draw_figures;
use crate::analysis::record::RunRecord;
use crate::options::choice::Choice;
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::{CaseInput, case_files};
use crate::run::messages::say;
use crate::run::outputs::{Outputs, is_stdout, print, print_notices};
use crate::run::provenance::generator;
use crate::run::threads::{map_all, stream_all};

pub fn run(args: &AnalyzeArgs) -> Result<Ending, Failure> {
    let mut record = RunRecord::new(&args.method, &args.uncertainty)?;
    let paths = case_files(&args.cases)?;
    let to_stdout = check_streams(args, &paths)?;
    let outputs = check_outputs(args, &paths)?;
    let is_one = paths.len() == 1;
    let (analyses, confidences, mut ending) = analyze_all(args, &paths, &mut record)?;
    Confidence::check_any_counts(&confidences)?;
    print_notices(&record.warnings());
    for (analysis, confidence) in analyses.iter().zip(&confidences) {
        print_notices(&patient::warnings(analysis));
        print_notices(confidence.interruption(analysis).as_slice());
    }
    let cohort = (!is_one || args.cohort.is_some()).then(|| cohort::of(&analyses));
    let results = Results {
        analyses: &analyses,
        confidences: &confidences,
        cohort: cohort.as_ref(),
        record: &record,
    };
    results.write(args, !is_one, &outputs)?;
    outputs.commit()?;
    if !to_stdout {
        print(&results.text(is_one))?;
    }
    let is_written = |analysis: &Analysis| {
        args.model.is_none() || written_model(args, analysis).is_none_or(LineModel::is_converged)
    };
    let has_all = |one: &Analysis| one.has_what_was_asked() && is_written(one);
    if ending == Ending::Done && !analyses.iter().all(has_all) {
        ending = Ending::NotConverged;
    }
    if confidences.iter().any(Confidence::is_cut_short) {
        ending = Ending::Interrupted;
    }
    Ok(ending)
}

/// The model that `--model` writes.
fn written_model<'a>(args: &AnalyzeArgs, analysis: &'a Analysis) -> Option<&'a LineModel> {
    let kind = match args.model_line {
        ModelLine::Kind(kind) => kind,
        ModelLine::Auto => analysis.compare_lines().best_predictor()?.0,
    };
    analysis.models.iter().find(|model| model.kind == kind)
}

/// Refuses outputs that exclude each other; says whether one goes to the standard output.
fn check_streams(args: &AnalyzeArgs, paths: &[PathBuf]) -> Result<bool, Failure> {
    let outputs = [&args.json, &args.csv, &args.chain, &args.cohort].into_iter().flatten();
    let to_stdout = outputs.filter(|path| is_stdout(path)).count();
    if to_stdout > 1 {
        return Err(Failure::usage(
            "only one of --json, --csv, --chain and --cohort can go to the standard output",
        ));
    }
    if args.model.is_some() && paths.len() != 1 {
        return Err(Failure::usage("--model writes the model of one case; give one case file"));
    }
    Ok(to_stdout == 1)
}

/// Checks every output before any work.
fn check_outputs(args: &AnalyzeArgs, paths: &[PathBuf]) -> Result<Outputs, Failure> {
    let inputs = paths.iter().chain(args.method.files()).map(PathBuf::as_path);
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

/// Analyses all cases; in a cohort, a case that fails is reported and left out.
fn analyze_all(
    args: &AnalyzeArgs,
    paths: &[PathBuf],
    record: &mut RunRecord,
) -> Result<(Vec<Analysis>, Vec<Confidence>, Ending), Failure> {
    let options = &record.request.options;
    let results = map_all("analysing", paths, args.threads, |path| {
        let input = CaseInput::read(path)?;
        Ok((analyze_input(path, &input, options)?, input))
    })?;
    let (mut analyses, mut confidences, mut ending) = (Vec::new(), Vec::new(), Ending::Done);
    for result in results {
        match result.and_then(|one| record.refuse_known(one)) {
            Ok((analysis, input)) => {
                let request = &record.request;
                confidences.push(Confidence::compute(
                    &input.case,
                    &analysis,
                    request,
                    args.threads,
                )?);
                record.cases.push(input);
                analyses.push(analysis);
            }
            Err(failure) if paths.len() == 1 => return Err(failure),
            Err(failure) => {
                say(&format!("{failure}\n"));
                ending = Ending::BadInput;
            }
        }
    }
    Ok((analyses, confidences, ending))
}

/// What is shown and written.
struct Results<'a> {
    analyses: &'a [Analysis],
    confidences: &'a [Confidence],
    /// For several cases, or where `--cohort` asks for it.
    cohort: Option<&'a Cohort>,
    record: &'a RunRecord,
}

impl Results<'_> {
    fn text(&self, is_one: bool) -> String {
        let generator = generator();
        let cohort = self.cohort.filter(|_| !is_one);
        let documents: Vec<Document> = match cohort {
            Some(found) => {
                vec![spineline_report::cohort::summary(self.analyses, found, &generator)]
            }
            None => self
                .patients()
                .map(|((analysis, confidence), input)| {
                    patient::summary(&confidence.report(analysis, &input.case, &generator))
                })
                .collect(),
        };
        documents.iter().map(|document| terminal(document, terminal::WIDTH)).collect()
    }

    fn write(&self, args: &AnalyzeArgs, is_list: bool, outputs: &Outputs) -> Result<(), Failure> {
        if let Some(path) = &args.json {
            self.write_json(path, is_list, args.threads, outputs)?;
        }
        if let Some(path) = &args.csv {
            outputs.write_table(
                path,
                errors_table(self.analyses).to_csv()?,
                &self.record.provenance(),
            )?;
        }
        if let Some(path) = &args.chain {
            outputs.write_table(
                path,
                chain_table(self.analyses).to_csv()?,
                &self.record.provenance(),
            )?;
        }
        if let (Some(path), Some(cohort)) = (&args.cohort, self.cohort) {
            self.write_cohort(path, cohort, outputs)?;
        }
        if let (Some(path), [analysis]) = (&args.model, self.analyses) {
            self.write_model(path, args, analysis, outputs)?;
        }
        if let Some(folder) = &args.tables.folder {
            let patients: Vec<Patient<'_>> = self
                .patients()
                .map(|((analysis, confidence), input)| confidence.patient(analysis, &input.case))
                .collect();
            tables::write(
                folder,
                &args.tables.formats,
                &patients,
                &self.record.provenance(),
                outputs,
            )?;
        }
        if let Some(folder) = &args.figures {
            for ((analysis, _), input) in self.patients() {
                let provenance = self.record.provenance_of(std::slice::from_ref(input));
                draw_figures(analysis, &provenance, folder, outputs)?;
            }
        }
        Ok(())
    }

    /// Every patient with what it was read from.
    fn patients(&self) -> impl Iterator<Item = ((&Analysis, &Confidence), &CaseInput)> {
        self.analyses.iter().zip(self.confidences).zip(&self.record.cases)
    }

    /// Writes the analysis of one case, or the list of a cohort. A list leaves memory patient by patient.
    fn write_json(
        &self,
        path: &Path,
        is_list: bool,
        threads: usize,
        outputs: &Outputs,
    ) -> Result<(), Failure> {
        let patients: Vec<_> = self.patients().collect();
        let file = |&((analysis, confidence), input): &((&Analysis, &Confidence), &CaseInput)| {
            let provenance = self.record.provenance_of(std::slice::from_ref(input));
            let file = AnalysisFile::new(analysis, input.file.clone(), provenance);
            confidence.add_to(analysis, file)
        };
        match &patients[..] {
            [one] if !is_list => outputs.write(path, to_text(&file(one))),
            all => outputs.write_pieces(path, |add| {
                let mut list = ListText::default();
                stream_all(
                    "writing",
                    all,
                    threads,
                    |one| ListText::item(&file(one)),
                    |item| {
                        add(list.before_item())?;
                        add(&item)
                    },
                )?;
                add(list.end())
            }),
        }
    }

    fn write_cohort(&self, path: &Path, cohort: &Cohort, outputs: &Outputs) -> Result<(), Failure> {
        let provenance = self.record.provenance();
        if is_csv(path) {
            return outputs.write_table(path, cohort_tests_table(cohort).to_csv()?, &provenance);
        }
        let file = cohort::file(self.analyses, cohort, &generator()).with_provenance(provenance);
        outputs.write(path, to_text(&file))
    }

    fn write_model(
        &self,
        path: &Path,
        args: &AnalyzeArgs,
        analysis: &Analysis,
        outputs: &Outputs,
    ) -> Result<(), Failure> {
        let Some(model) = written_model(args, analysis) else {
            let text = match args.model_line {
                ModelLine::Kind(kind) => format!("there is no model with the {kind}"),
                ModelLine::Auto => "no line predicts a film that it was not fitted to".to_owned(),
            };
            let text = format!("{text}, so --model has nothing to write");
            return Err(Failure::input(&analysis.case_id, &text, &help_without_model(analysis)));
        };
        if matches!(args.model_line, ModelLine::Auto) {
            say(&format!(
                "{}: the model of the {} is written, which has the smallest error on films that it was not fitted to, among lines that take one number from each\n",
                analysis.case_id, model.kind
            ));
        }
        let file = ModelFile::new(analysis, model, &generator());
        outputs.write(path, to_text(&file.with_provenance(self.record.provenance())))
    }
}

/// What gives a model to write: a line that has one, or what all lines lack.
fn help_without_model(analysis: &Analysis) -> String {
    let lines: Vec<String> = analysis
        .models
        .iter()
        .map(|model| format!("--model-line {}", model.kind.spelling()))
        .collect();
    if !lines.is_empty() {
        return format!("write another one: {}", lines.join(" or "));
    }
    if let Some(posture) = analysis.film_without_scale() {
        return format!(
            "a model needs the scale of every film, and the {posture} film has none: give `column_spacing_mm`, `row_spacing_mm` and `spacing_plane` in the case file, or import the films with --spacing, --ball or --ruler"
        );
    }
    if analysis.postures.iter().all(|posture| posture.outline.posture.bend().is_none()) {
        return "a model needs a bending film: add one to the case".to_owned();
    }
    "no bending film has a line of action, and the warnings say why: set the inflections with --inflections, or the line with --given-line".to_owned()
}
