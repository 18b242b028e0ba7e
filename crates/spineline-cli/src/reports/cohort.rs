//! The report of many patients.

use std::path::{Path, PathBuf};

use spineline::analysis::{Analysis, AnalysisOptions, Subject, analyze};
use spineline_io::AnalysisFile;
use spineline_report::cohort::{Patients, Refusal, Refused, report};

use super::args::ReportArgs;
use super::write;
use crate::analyze::generator;
use crate::cohort;
use crate::failure::{Ending, Failure};
use crate::progress::map_all;

pub fn run(paths: &[PathBuf], args: &ReportArgs) -> Result<Ending, Failure> {
    if args.uncertainty.identifiability || args.uncertainty.replicates.is_some() {
        return Err(Failure::usage(
            "--identifiability and --replicates are for the report of one patient; give one case",
        ));
    }
    let options = args.options.options()?;
    let generator = generator();
    let results = map_all("analysing", paths, args.threads, |path| one(path, &options))?;
    let (mut analyses, mut subjects, mut refused) = (Vec::new(), Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok((analysis, subject)) => {
                analyses.push(analysis);
                subjects.push(subject);
            }
            Err((refused_one, failure)) => {
                eprintln!("{failure}");
                refused.push(refused_one);
            }
        }
    }
    if analyses.is_empty() {
        return Err(Failure::usage("none of these cases could be analysed: there is no cohort"));
    }
    let files = map_all("writing", &analyses, args.threads, |analysis| {
        serde_json::to_string(&AnalysisFile::new(analysis, &generator)).expect("string keys only")
    })?;
    let document = report(&Patients {
        analyses: &analyses,
        subjects: &subjects,
        together: &cohort::of(&analyses),
        refused: &refused,
        generator: &generator,
        json: &format!("[{}]", files.join(",")),
    });
    write::all(&document, "cohort", args)?;
    Ok(match (refused.is_empty(), analyses.iter().all(Analysis::is_converged)) {
        (false, _) => Ending::BadInput,
        (true, false) => Ending::NotConverged,
        (true, true) => Ending::Done,
    })
}

/// One patient, or where it ended and why.
fn one(path: &Path, options: &AnalysisOptions) -> Result<(Analysis, Subject), (Refused, Failure)> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let refused = |refusal, why: String| Refused { name: name.into_owned(), refusal, why };
    let case = match spineline_io::read_text(path).and_then(|text| spineline_io::parse_case(&text))
    {
        Ok(case) => case,
        Err(error) => {
            let why = error.to_string();
            return Err((refused(Refusal::Unread, why), Failure::file(path, &error)));
        }
    };
    match analyze(&case, options) {
        Ok(analysis) => Ok((analysis, case.subject)),
        Err(error) => {
            let failure = Failure::input(&path.display().to_string(), &error, error.help());
            Err((refused(Refusal::NotAnalysed, error.to_string()), failure))
        }
    }
}
