//! The report of many patients.

use std::path::PathBuf;

use spineline::analysis::{Analysis, Subject};
use spineline::cohort::CohortPatient;
use spineline_files::{AnalysisFile, results_line};
use spineline_report::cohort::{Patients, report};

use super::args::ReportArgs;
use super::write;
use crate::analysis::cohort::{self, Members};
use crate::analysis::record::RunRecord;
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, print_notices};
use crate::run::provenance::generator;
use crate::run::threads::map_all;

/// Beginning of the names of files of a cohort.
const STEM: &str = "cohort";

pub fn run(paths: &[PathBuf], args: &ReportArgs, outputs: Outputs) -> Result<Ending, Failure> {
    if args.uncertainty.identifiability || args.uncertainty.replicates.asked().is_some() {
        return Err(Failure::usage(
            "--identifiability and --replicates are for the report of one patient; give one case",
        ));
    }
    let out = write::target(STEM, args, &outputs)?;
    let record = RunRecord::new(&args.method, &args.uncertainty)?;
    let Members { analyses, sources, refused, read } =
        Members::analyze(paths, &record, args.threads)?;
    let subjects: Vec<Subject> = sources.iter().map(|(_, one)| one.case.subject.clone()).collect();
    print_notices(&read.warnings());
    let notes = analyses.iter().filter_map(|analysis| record.amplitude_note(analysis));
    print_notices(&notes.collect::<Vec<_>>());
    read.ids().iter().for_each(|id| outputs.of_case(id));
    let pairs: Vec<_> = analyses.iter().zip(&sources).collect();
    let files = map_all("writing", &pairs, args.threads, |(analysis, (_, source))| {
        let provenance = record.provenance_of(source);
        results_line(&AnalysisFile::new(analysis, source.file.clone(), provenance))
    })?;
    let patients = map_all("comparing lines", &analyses, args.threads, CohortPatient::of)?;
    let document = report(&Patients {
        analyses: &analyses,
        subjects: &subjects,
        together: &cohort::of(&patients, cohort::BOOTSTRAP_SEED, args.threads)?,
        refused: &refused,
        generator: &generator(),
        json: &format!("[{}]", files.join(",")),
    });
    let provenance = record.provenance_of_all(&read);
    let report = write::Report { document: &document, stem: STEM, provenance: &provenance };
    report.write(&out, args, outputs)?;
    Ok(match (refused.is_empty(), analyses.iter().all(Analysis::has_what_was_asked)) {
        (false, _) => Ending::BadInput,
        (true, false) => Ending::NotConverged,
        (true, true) => Ending::Done,
    })
}
