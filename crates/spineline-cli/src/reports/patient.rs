//! The report of one patient.

use std::path::Path;

use spineline_files::AnalysisFile;
use spineline_report::document::{Notice, NoticeKind};
use spineline_report::file_stem;
use spineline_report::patient::{Patient, report};

use super::args::ReportArgs;
use super::{films, write};
use crate::analyze::{Origins, Sureness, analyze_case, generator};
use crate::failure::{Ending, Failure};
use crate::provenance::Source;

pub fn run(path: &Path, args: &ReportArgs) -> Result<Ending, Failure> {
    let mut origins = Origins::new(&args.options, &args.uncertainty)?;
    origins.sources.push(Source::read(path)?);
    eprint!("{}", origins.warnings());
    let Source { file, case, .. } = &origins.sources[0];
    let analysis = analyze_case(path, case, &origins.request.options)?;
    let sure = Sureness::ask(case, &analysis, &origins.request, args.threads)?;
    let (pictures, hidden) = films::pictures(path, file, case, args.threads)?;
    let json = AnalysisFile::new(&analysis, file.clone(), origins.of(&origins.sources));
    let json = sure.write(&analysis, json);
    let mut document = report(&Patient {
        case,
        analysis: &analysis,
        pictures: &pictures,
        identifiability: sure.identified.as_deref(),
        uncertainty: sure.spread.as_ref(),
        generator: &generator(),
        json: &serde_json::to_string(&json).expect("string keys only"),
    });
    if let Some(films) = document.sections.iter_mut().find(|section| section.id == "films") {
        for why in hidden {
            let mut words = why.chars();
            let first = words.next().into_iter().flat_map(char::to_uppercase);
            let text = format!("{}.", first.chain(words).collect::<String>());
            films.notice(Notice::new(NoticeKind::Note, text));
        }
    }
    write::all(&document, &file_stem(&document.subject), origins.date_utc(), args)?;
    Ok(if analysis.is_converged() { Ending::Done } else { Ending::NotConverged })
}
