//! A report and its figures as files.

use std::path::{Path, PathBuf};

use spineline_report::document::{Figure, Notice, NoticeKind};
use spineline_report::fonts::Fonts;
use spineline_report::{Document, html, markdown, png};

use super::args::{FormName, ReportArgs};
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{print, print_notices, write_file};
use crate::run::pdf;
use crate::run::threads::map_all;

/// Pixels of a PNG per unit of its SVG.
const PNG_SCALE: f32 = 2.0;

/// Writes the report in the requested format, and every figure if requested; prints what was written.
pub fn all(
    document: &Document,
    stem: &str,
    date_utc: &str,
    args: &ReportArgs,
) -> Result<Ending, Failure> {
    let out = match &args.out {
        Some(out) => out.clone(),
        None => PathBuf::from(format!("{stem}.{}", args.to.ending())),
    };
    match args.to {
        FormName::Html => write_file(&out, html(document))?,
        FormName::Md => write_markdown(document, &out)?,
        FormName::Pdf => write_file(&out, pdf::pdf(document, date_utc)?)?,
    }
    // A PDF says it itself; a browser looks for letters where it is.
    if args.figures.is_some() {
        let texts = document.figures().map(|figure| figure.svg.as_str());
        if let Some(words) = Fonts::for_texts(texts).missing_words() {
            print_notices(&[Notice {
                kind: NoticeKind::Warning,
                place: document.subject.clone(),
                text: words,
                code: "letters_missing".to_owned(),
            }]);
        }
    }
    let mut said = format!("Report   {}\n", out.display());
    if let Some(folder) = &args.figures {
        let figures: Vec<&Figure> = document.figures().collect();
        let written = map_all("figures", &figures, args.threads, |figure| {
            let file = |ending: &str| folder.join(format!("{stem}-{}.{ending}", figure.name));
            write_file(&file("svg"), &figure.svg)?;
            let pixels = png(&figure.svg, PNG_SCALE)
                .map_err(|error| Failure::internal(format!("{}: {error}", figure.name)))?;
            write_file(&file("png"), pixels)
        })?;
        written.into_iter().collect::<Result<(), Failure>>()?;
        said.push_str(&format!("Figures  {} (SVG and PNG)\n", folder.display()));
    }
    print(&said)
}

/// The text, and its figures in a folder beside it.
fn write_markdown(document: &Document, out: &Path) -> Result<(), Failure> {
    let name = out.file_stem().unwrap_or_default().to_string_lossy();
    let folder = format!("{}-figures", spineline_report::file_stem(&name));
    for figure in document.figures() {
        write_file(&out.with_file_name(&folder).join(format!("{}.svg", figure.name)), &figure.svg)?;
    }
    write_file(out, markdown(document, &folder))
}
