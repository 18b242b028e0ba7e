//! The report of a study, as `spineline report` writes it, and its figures.

use spineline::analysis::{Analysis, Case};
use spineline_files::method_text::ChosenOptions;
use spineline_report::document::{Notice, NoticeKind};
use spineline_report::figures::FilmPicture;
use spineline_report::patient::{self, Patient};
use spineline_report::{Document, PRINT_SCALE, html, png};

use super::archive::archive;
use super::file::{Download, file_of, internal, provenance};
use crate::PROGRAM;
use crate::api::Export;
use crate::decoded::picture;
use crate::jobs::Computed;
use crate::problem::Answer;
use crate::result_cache::StudyResult;
use crate::state::AppState;

/// The pictures of the films whose landmarks are used.
pub async fn pictures(state: &AppState, result: &StudyResult) -> Answer<Vec<FilmPicture>> {
    let mut pictures = Vec::new();
    let films: Vec<_> = result.current.usable_films().collect();
    for (posture, film) in films {
        pictures.push(FilmPicture { posture, png: picture(state, &film.record).await? });
    }
    Ok(pictures)
}

/// The report of an analysis.
pub fn document(
    analysis: &Analysis,
    case: &Case,
    options: &ChosenOptions,
    pictures: &[FilmPicture],
    found: &Computed,
) -> Document {
    let mut document = patient::report(&Patient {
        case,
        analysis,
        pictures,
        identifiability: found.identifiability(),
        uncertainty: found.uncertainty(),
        generator: PROGRAM,
        json: &spineline_files::results_line(&file_of(analysis, case, found)),
    });
    // The options of an analysis do not contain the names of their files.
    for (title, file) in options.files() {
        let text = format!("{title} from the file {file}.");
        document.banners.push(Notice::new(NoticeKind::Banner, text));
    }
    document
}

/// A report as HTML or PDF, or its figures.
pub fn download(export: Export, document: &Document, analysis: &Analysis) -> Answer<Download> {
    match export {
        Export::Figures => figures(document, analysis),
        Export::Pdf => {
            let bytes = pdf(document)?;
            Ok(Download { ending: ".pdf", kind: "application/pdf", bytes })
        }
        _ => Ok(Download {
            ending: ".html",
            kind: "text/html; charset=utf-8",
            bytes: spineline_files::with_hash(html(document).into_bytes()),
        }),
    }
}

fn figures(document: &Document, analysis: &Analysis) -> Answer<Download> {
    let mut files = Vec::new();
    for figure in document.figures() {
        let pixels = png(&figure.svg, PRINT_SCALE).map_err(|error| internal(&error))?;
        files.push((format!("{}.svg", figure.name), figure.svg.clone().into_bytes()));
        files.push((format!("{}.png", figure.name), pixels));
    }
    archive("-figures.zip", files, provenance(analysis))
}

#[cfg(feature = "pdf")]
fn pdf(document: &Document) -> Answer<Vec<u8>> {
    let made = std::time::SystemTime::now().into();
    spineline_pdf::pdf(document, made).map_err(|error| internal(&error))
}

#[cfg(not(feature = "pdf"))]
fn pdf(_: &Document) -> Answer<Vec<u8>> {
    use crate::problem::Failure;
    let text = "this program was built without PDF";
    Err(Failure::new(axum::http::StatusCode::CONFLICT, "no_pdf", text)
        .help("save the HTML report and print it from a browser, or build with `--features pdf`"))
}
