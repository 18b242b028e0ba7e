//! A report and its figures as files.

use std::path::{Path, PathBuf};

use spineline_files::{InputFile, Provenance, ProvenanceFile, to_text, with_hash};
use spineline_report::document::{Figure, Notice, NoticeKind};
use spineline_report::fonts::Fonts;
use spineline_report::terminal::Lines;
use spineline_report::{Document, PRINT_SCALE, html, markdown, png};

use super::args::{FormName, ReportArgs};
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, is_stdout, print, print_notices};
use crate::run::pdf;
use crate::run::provenance::in_svg;
use crate::run::threads::map_all;

/// The file of a report, checked before any work; named after its subject unless the user names it.
///
/// # Errors
/// If it must not be written.
pub fn target(stem: &str, args: &ReportArgs, outputs: &Outputs) -> Result<PathBuf, Failure> {
    if let Some(out) = &args.out {
        return Ok(out.clone());
    }
    let out = PathBuf::from(format!("{stem}.{}", args.form()?.ending()));
    outputs.file(&out)?;
    Ok(out)
}

/// A report as it is written.
pub struct Report<'a> {
    pub document: &'a Document,
    /// Beginning of the names of its figures.
    pub stem: &'a str,
    pub provenance: &'a Provenance,
}

impl Report<'_> {
    /// Writes the report in the requested format, and every figure if requested; prints what was written, unless the report goes to
    /// the standard output.
    pub fn write(
        &self,
        out: &Path,
        args: &ReportArgs,
        outputs: Outputs,
    ) -> Result<Ending, Failure> {
        let form = args.form()?;
        let mut said = Lines::default();
        if outputs.attempt(out, || self.write_page(form, out, &outputs)) {
            said.line(format!("Report   {}", out.display()));
        }
        if let Some(folder) = &args.figures {
            self.warn_of_letters();
            if outputs.attempt(folder, || self.write_figures(folder, args.threads, &outputs)) {
                said.line(format!("Figures  {} (SVG and PNG)", folder.display()));
            }
        }
        let kept = outputs.commit();
        if is_stdout(out) {
            return kept.map(|()| Ending::Done);
        }
        let shown = print(said);
        kept.and(shown)
    }

    fn write_page(&self, form: FormName, out: &Path, outputs: &Outputs) -> Result<(), Failure> {
        match form {
            FormName::Html => outputs.write(out, html(self.document)),
            FormName::Md => self.write_markdown(out, outputs),
            FormName::Pdf => {
                outputs.write(out, pdf::pdf(self.document, &self.provenance.date_utc)?)
            }
        }
    }

    /// A PDF itself lists letters without a font; a browser uses the fonts of its machine.
    fn warn_of_letters(&self) {
        let texts = self.document.figures().map(|figure| figure.svg.as_str());
        if let Some(words) = Fonts::for_texts(texts).missing_words() {
            print_notices(&[Notice {
                kind: NoticeKind::Warning,
                place: self.document.subject.clone(),
                text: words,
                code: "letters_missing".to_owned(),
            }]);
        }
    }

    /// Every figure as SVG and PNG, and a list of them with their provenance.
    fn write_figures(
        &self,
        folder: &Path,
        threads: usize,
        outputs: &Outputs,
    ) -> Result<(), Failure> {
        let figures: Vec<&Figure> = self.document.figures().collect();
        let written = map_all("figures", &figures, threads, |figure| {
            let svg = with_hash(in_svg(&figure.svg, self.provenance).into_bytes());
            let pixels = png(&figure.svg, PRINT_SCALE)
                .map_err(|error| Failure::internal(format!("{}: {error}", figure.name)))?;
            let add = |ending: &str, content: Vec<u8>| {
                let name = format!("{}-{}.{ending}", self.stem, figure.name);
                let path = folder.join(&name);
                let file = InputFile::of(name, &content);
                outputs.write(&path, content).map(|()| file)
            };
            Ok([add("svg", svg)?, add("png", pixels)?])
        })?;
        let written = written.into_iter().collect::<Result<Vec<_>, Failure>>()?;
        let name = format!("{}-figures.provenance.json", self.stem);
        let files = written.into_iter().flatten().collect();
        let list = ProvenanceFile::new(files, self.provenance.clone());
        outputs.write(&folder.join(name), to_text(&list))
    }

    /// The text, and its figures in a folder beside it.
    fn write_markdown(&self, out: &Path, outputs: &Outputs) -> Result<(), Failure> {
        let name = out.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{}-figures", spineline_report::file_stem(&name));
        let folder = out.with_file_name(&name);
        for figure in self.document.figures() {
            let file = folder.join(format!("{}.svg", figure.name));
            outputs.write(&file, in_svg(&figure.svg, self.provenance))?;
        }
        outputs.write(out, markdown(self.document, &name))
    }
}
