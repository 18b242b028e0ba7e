//! The report of one patient.

use std::path::Path;

use spineline_files::{AnalysisFile, to_line};
use spineline_report::document::{Notice, NoticeKind};
use spineline_report::file_stem;
use spineline_report::patient::{Patient, report};

use super::args::ReportArgs;
use super::{films, write};
use crate::analysis::case::analyze_input;
use crate::analysis::confidence::Confidence;
use crate::analysis::record::RunRecord;
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::CaseInput;
use crate::run::outputs::{Outputs, print_notices};
use crate::run::provenance::generator;

pub fn run(path: &Path, args: &ReportArgs, outputs: Outputs) -> Result<Ending, Failure> {
    let mut record = RunRecord::new(&args.method, &args.uncertainty)?;
    record.cases.push(CaseInput::read(path)?);
    record.refuse_learned(&record.cases[0])?;
    let stem = file_stem(&record.cases[0].case.id);
    let out = write::target(&stem, args, &outputs)?;
    print_notices(&record.warnings());
    let CaseInput { file, case, .. } = &record.cases[0];
    let analysis = analyze_input(path, &record.cases[0], &record.request.options)?;
    let confidence = Confidence::compute(case, &analysis, &record.request, args.threads)?;
    Confidence::check_any_counts(std::slice::from_ref(&confidence))?;
    print_notices(confidence.interruption(&analysis).as_slice());
    let (pictures, hidden) = films::pictures(path, file, case, args.threads)?;
    let json = AnalysisFile::new(&analysis, file.clone(), record.provenance_of(&record.cases));
    let json = confidence.add_to(&analysis, json);
    let mut document = report(&Patient {
        pictures: &pictures,
        json: &to_line(&json),
        ..confidence.report(&analysis, case, &generator())
    });
    if let Some(films) = document.sections.iter_mut().find(|section| section.id == "films") {
        for why in hidden {
            let mut words = why.chars();
            let first = words.next().into_iter().flat_map(char::to_uppercase);
            let text = format!("{}.", first.chain(words).collect::<String>());
            films.notice(Notice::new(NoticeKind::Note, text));
        }
    }
    let provenance = record.provenance_of(&record.cases);
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
