//! The report of many patients.

use std::path::{Path, PathBuf};

use spineline::analysis::{Analysis, AnalysisOptions};
use spineline_files::AnalysisFile;
use spineline_report::cohort::{Patients, Refusal, Refused, report};

use super::args::ReportArgs;
use super::write;
use crate::analyze::{Origins, analyze_case, generator};
use crate::cohort;
use crate::failure::{Ending, Failure};
use crate::progress::map_all;
use crate::provenance::Source;

pub fn run(paths: &[PathBuf], args: &ReportArgs) -> Result<Ending, Failure> {
    if args.uncertainty.identifiability || args.uncertainty.replicates.is_some() {
        return Err(Failure::usage(
            "--identifiability and --replicates are for the report of one patient; give one case",
        ));
    }
    let mut origins = Origins::new(&args.options, &args.uncertainty)?;
    let options = &origins.request.options;
    let results = map_all("analysing", paths, args.threads, |path| one(path, options))?;
    let (mut analyses, mut subjects, mut refused) = (Vec::new(), Vec::new(), Vec::new());
    for (path, result) in paths.iter().zip(results) {
        let found = result.and_then(|found| {
            origins.once(found).map_err(|failure| (Refusal::NotAnalysed, failure))
        });
        match found {
            Ok((analysis, source)) => {
                analyses.push(analysis);
                subjects.push(source.case.subject.clone());
                origins.sources.push(source);
            }
            Err((refusal, failure)) => {
                eprintln!("{failure}");
                let name = path.file_name().unwrap_or(path.as_os_str());
                let name = name.to_string_lossy().into_owned();
                refused.push(Refused { name, refusal, why: failure.what().to_owned() });
            }
        }
    }
    if analyses.is_empty() {
        return Err(Failure::usage("none of these cases could be analysed: there is no cohort"));
    }
    eprint!("{}", origins.warnings());
    let pairs: Vec<(&Analysis, &Source)> = analyses.iter().zip(&origins.sources).collect();
    let files = map_all("writing", &pairs, args.threads, |(analysis, source)| {
        let provenance = origins.of(std::slice::from_ref(*source));
        let file = AnalysisFile::new(analysis, source.file.clone(), provenance);
        serde_json::to_string(&file).expect("string keys only")
    })?;
    let document = report(&Patients {
        analyses: &analyses,
        subjects: &subjects,
        together: &cohort::of(&analyses),
        refused: &refused,
        generator: &generator(),
        json: &format!("[{}]", files.join(",")),
    });
    write::all(&document, "cohort", origins.date_utc(), args)?;
    Ok(match (refused.is_empty(), analyses.iter().all(Analysis::is_converged)) {
        (false, _) => Ending::BadInput,
        (true, false) => Ending::NotConverged,
        (true, true) => Ending::Done,
    })
}

/// One patient, or where it ended and why.
fn one(path: &Path, options: &AnalysisOptions) -> Result<(Analysis, Source), (Refusal, Failure)> {
    let source = Source::read(path).map_err(|failure| (Refusal::Unread, failure))?;
    let analysis = analyze_case(path, &source.case, options)
        .map_err(|failure| (Refusal::NotAnalysed, failure))?;
    Ok((analysis, source))
}
