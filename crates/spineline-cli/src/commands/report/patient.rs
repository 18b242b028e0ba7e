//! The report of one patient.

use std::path::Path;

use spineline_files::{AnalysisFile, results_line};
use spineline_report::document::{Notice, NoticeKind};
use spineline_report::patient::{Patient, report};
use spineline_report::{file_stem, sentence_case};

use super::args::ReportArgs;
use super::{films, write};
use crate::analysis::case::analyze_input;
use crate::analysis::confidence::{Confidence, interruption};
use crate::analysis::record::{ReadCases, RunRecord};
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::CaseInput;
use crate::run::outputs::{Outputs, print_notices};
use crate::run::provenance::generator;

pub fn run(path: &Path, args: &ReportArgs, outputs: Outputs) -> Result<Ending, Failure> {
    let record = RunRecord::new(&args.method, &args.uncertainty)?;
    let source = CaseInput::read(path)?;
    record.check_learned(&source)?;
    let mut read = ReadCases::default();
    read.add(&source, &record)?;
    outputs.of_case(&source.case.id);
    let stem = file_stem(&source.case.id);
    let out = write::target(&stem, args, &outputs)?;
    print_notices(&read.warnings());
    let CaseInput { file, case, .. } = &source;
    let mut analysis = analyze_input(path, &source, &record.request.options)?;
    let confidence = Confidence::compute(case, &mut analysis, &record.request, args.threads)?;
    if confidence.is_cut_short() && !confidence.has_replicates() {
        return Err(Failure::interrupted());
    }
    print_notices(interruption(&analysis).as_slice());
    print_notices(record.amplitude_note(&analysis).as_slice());
    let (pictures, reasons) = films::pictures(path, file, case, args.threads)?;
    let note = |why: &String| Notice::new(NoticeKind::Note, format!("{}.", sentence_case(why)));
    let hidden: Vec<Notice> = reasons.iter().map(note).collect();
    print_notices(&hidden);
    let json = AnalysisFile::new(&analysis, file.clone(), record.provenance_of(&source));
    let json = confidence.add_to(&analysis, json);
    let mut document = report(&Patient {
        pictures: &pictures,
        json: &results_line(&json),
        ..confidence.report(&analysis, case, &generator())
    });
    if let Some(films) = document.sections.iter_mut().find(|section| section.id == "films") {
        hidden.into_iter().for_each(|notice| films.notice(notice));
    }
    let provenance = record.provenance_of(&source);
    let report = write::Report { document: &document, stem: &stem, provenance: &provenance };
    report.write(&out, args, outputs)?;
    Ok(if confidence.is_cut_short() {
        Ending::Interrupted
    } else if analysis.has_what_was_asked() {
        Ending::Done
    } else {
        Ending::NotConverged
    })
}
