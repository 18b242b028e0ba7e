//! The report of one patient.

use std::path::Path;

use spineline::analysis::analyze;
use spineline_io::AnalysisFile;
use spineline_report::document::{Notice, NoticeKind};
use spineline_report::file_stem;
use spineline_report::patient::{Patient, report};

use super::args::ReportArgs;
use super::{films, write};
use crate::analyze::generator;
use crate::failure::{Ending, Failure};
use crate::{identifiability, uncertainty};

pub fn run(path: &Path, args: &ReportArgs) -> Result<Ending, Failure> {
    let options = args.options.options()?;
    let file = spineline_io::read_text(path)
        .and_then(|text| spineline_io::parse_case_file(&text))
        .map_err(|error| Failure::file(path, &error))?;
    let case = file.clone().into_case().map_err(|error| Failure::file(path, &error))?;
    let analysis = analyze(&case, &options)
        .map_err(|error| Failure::input(&path.display().to_string(), &error, error.help()))?;
    let asked = &args.uncertainty;
    let identified = asked.identifiability.then(|| identifiability::run(&analysis, args.threads));
    let identified = identified.transpose()?;
    let spread = uncertainty::run(&case, &analysis, asked, args.threads)?;
    let (pictures, hidden) = films::pictures(path, &file, &case, args.threads)?;
    let generator = generator();
    let mut json = AnalysisFile::new(&analysis, &generator);
    if let Some(found) = &identified {
        json = json.with_identifiability(&analysis, found);
    }
    if let Some(found) = &spread {
        json = json.with_uncertainty(&analysis, found);
    }
    let mut document = report(&Patient {
        case: &case,
        analysis: &analysis,
        pictures: &pictures,
        identifiability: identified.as_deref(),
        uncertainty: spread.as_ref(),
        generator: &generator,
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
    write::all(&document, &file_stem(&document.subject), args)?;
    Ok(if analysis.is_converged() { Ending::Done } else { Ending::NotConverged })
}
