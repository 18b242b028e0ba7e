//! `spineline analyze`: one patient, or a cohort.

mod args;
mod kept;
mod model;
mod output;
mod run;
mod tables;

pub use args::{AnalyzeArgs, EXAMPLES};

use std::path::{Path, PathBuf};

use spineline::warning::counted;
use spineline_tables::{chain_table, errors_table};

use crate::analysis::record::RunRecord;
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::case_files;
use crate::run::outputs::{Outputs, is_stdout, print_document};
use crate::run::provenance::generator;
use kept::Asked;
use model::Model;
use output::{CohortStatistics, Csv, Figures, Json, Output};
use run::analyze_all;
use tables::Tables;

pub fn run(args: &AnalyzeArgs) -> Result<Ending, Failure> {
    let record = RunRecord::new(&args.method, &args.uncertainty)?;
    let paths = case_paths(args)?;
    let is_list = paths.len() != 1 || args.shard.is_some();
    let to_stdout = check_streams(args, is_list)?;
    let outputs = check_outputs(args, &paths)?;
    let asked = Asked { args, record: &record, outputs: &outputs, is_list };
    let all = begin_outputs(asked)?;
    let kept = analyze_all(&paths, asked, &all)?;
    all.into_iter().for_each(|output| output.end(&kept));
    let shown = kept.shown(&generator());
    let ending = kept.ending();
    drop(kept);
    let committed = outputs.commit_and_say();
    // Results are shown although they cannot be written.
    if let Some(document) = shown.filter(|_| !to_stdout) {
        print_document(&document)?;
    }
    committed?;
    Ok(ending)
}

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

/// What an output of `analyze` is written to.
struct Target<'a> {
    flag: &'static str,
    path: &'a Path,
    check: Check,
}

/// How a target is checked: as a file, a table or a folder.
type Check = fn(&Outputs, &Path) -> Result<(), Failure>;

/// Every target that is asked for.
fn targets(args: &AnalyzeArgs) -> Vec<Target<'_>> {
    let cohort = args.cohort.as_deref();
    let is_table = cohort.is_some_and(CohortStatistics::is_csv);
    let of_cohort: Check = if is_table { Outputs::table } else { Outputs::file };
    let all: [(&str, Option<&Path>, Check); 7] = [
        ("--json", args.json.as_deref(), Outputs::file),
        ("--csv", args.csv.as_deref(), Outputs::table),
        ("--chain", args.chain.as_deref(), Outputs::table),
        ("--tables", args.tables.folder.as_deref(), Outputs::folder),
        ("--figures", args.figures.as_deref(), Outputs::folder),
        ("--cohort", cohort, of_cohort),
        ("--model", args.model.as_deref(), Outputs::file),
    ];
    all.into_iter()
        .filter_map(|(flag, path, check)| Some(Target { flag, path: path?, check }))
        .collect()
}

/// Refuses outputs that exclude each other; says whether one goes to the standard output.
fn check_streams(args: &AnalyzeArgs, is_list: bool) -> Result<bool, Failure> {
    let targets = targets(args);
    let to_stdout = targets.iter().filter(|target| is_stdout(target.path));
    let flags: Vec<&str> = to_stdout.map(|target| target.flag).collect();
    if flags.len() > 1 {
        let flags = flags.join(" and ");
        return Err(Failure::usage(format!(
            "{flags} go to the standard output, which takes one of them; give the others a file"
        )));
    }
    if args.model.is_some() && is_list {
        return Err(Failure::usage("--model writes the model of one case; give one case file"));
    }
    Ok(flags.len() == 1)
}

/// Checks every output before any work.
fn check_outputs(args: &AnalyzeArgs, paths: &[PathBuf]) -> Result<Outputs, Failure> {
    let inputs = paths.iter().map(PathBuf::as_path).chain(args.method.files());
    let outputs = Outputs::new(args.overwrite, inputs);
    for Target { path, check, .. } in targets(args) {
        check(&outputs, path)?;
    }
    Ok(outputs)
}
