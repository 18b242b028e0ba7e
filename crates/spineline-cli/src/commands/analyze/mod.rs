//! `spineline analyze`: one patient, or a cohort.

mod args;
mod model;
mod output;
mod run;
mod tables;

pub use args::{AnalyzeArgs, EXAMPLES};

use std::path::PathBuf;

use spineline::warning::counted;
use spineline_tables::{chain_table, errors_table};

use crate::analysis::record::RunRecord;
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::case_files;
use crate::run::outputs::{Outputs, is_stdout, print_document};
use crate::run::provenance::generator;
use model::Model;
use output::{CohortStatistics, Csv, Figures, Json, Output};
use run::{Asked, analyze_all};
use tables::Tables;

pub fn run(args: &AnalyzeArgs) -> Result<Ending, Failure> {
    let record = RunRecord::new(&args.method, &args.uncertainty)?;
    let paths = case_paths(args)?;
    let is_list = paths.len() != 1 || args.shard.is_some();
    let to_stdout = check_streams(args, is_list)?;
    let outputs = check_outputs(args, &paths)?;
    let asked = Asked { args, record: &record, outputs: &outputs, is_list };
    let all = begin_outputs(asked)?;
    let finished = analyze_all(&paths, asked, &all)?;
    all.into_iter().for_each(|output| output.end(&finished));
    let shown = finished.shown(&generator());
    let ending = finished.ending();
    drop(finished);
    let kept = outputs.commit_and_say();
    // Results are shown although they cannot be written.
    if let Some(document) = shown.filter(|_| !to_stdout) {
        print_document(&document)?;
    }
    kept?;
    Ok(ending)
}

/// Begins every output that is asked for.
fn begin_outputs(asked: Asked<'_>) -> Result<Vec<Box<dyn Output + '_>>, Failure> {
    let Asked { args, record, outputs, is_list } = asked;
    let mut all: Vec<Box<dyn Output + '_>> = Vec::new();
    if let Some(path) = &args.json {
        all.push(Box::new(Json::new(path, record, is_list, outputs)?));
    }
    if let Some(path) = &args.csv {
        all.push(Box::new(Csv::new(path, errors_table, outputs)?));
    }
    if let Some(path) = &args.chain {
        all.push(Box::new(Csv::new(path, chain_table, outputs)?));
    }
    if let Some(folder) = &args.tables.folder {
        all.push(Box::new(Tables::new(folder, &args.tables.formats, outputs)));
    }
    if let Some(folder) = &args.figures {
        all.push(Box::new(Figures { folder, record, outputs }));
    }
    if let Some(path) = &args.cohort {
        all.push(Box::new(CohortStatistics { path, outputs }));
    }
    if let Some(path) = &args.model {
        all.push(Box::new(Model { path, args, outputs }));
    }
    Ok(all)
}

/// The cases to analyse: all, or one part of them.
fn case_paths(args: &AnalyzeArgs) -> Result<Vec<PathBuf>, Failure> {
    let mut paths = case_files(&args.cases)?;
    let Some(shard) = args.shard else { return Ok(paths) };
    let (places, all) = (shard.places(paths.len()), paths.len());
    if places.is_empty() {
        let cases = counted(all, "case");
        return Err(Failure::usage(format!(
            "--shard {shard}: this part has no case, since there are {cases}; take at most {all} parts"
        )));
    }
    Ok(paths.drain(places).collect())
}

/// Refuses outputs that exclude each other; says whether one goes to the standard output.
fn check_streams(args: &AnalyzeArgs, is_list: bool) -> Result<bool, Failure> {
    let outputs = [&args.json, &args.csv, &args.chain, &args.cohort, &args.model];
    let outputs = outputs.into_iter().flatten();
    let to_stdout = outputs.filter(|path| is_stdout(path)).count();
    if to_stdout > 1 {
        return Err(Failure::usage(
            "only one of --json, --csv, --chain, --cohort and --model can go to the standard output",
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
        if CohortStatistics::is_csv(path) { outputs.table(path)? } else { outputs.file(path)? }
    }
    for folder in [&args.tables.folder, &args.figures].into_iter().flatten() {
        outputs.folder(folder)?;
    }
    Ok(outputs)
}
