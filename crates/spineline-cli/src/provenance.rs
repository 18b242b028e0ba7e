//! Where an output comes from: command, date and inputs, which only the program knows.

use std::path::{Path, PathBuf};

use chrono::{DateTime, SecondsFormat, Utc};
use spineline::analysis::Case;
use spineline_files::{CaseFile, InputFile, ProgramRun, Provenance, ProvenanceFile, Request};

use crate::analyze::{generator, write_file};
use crate::failure::Failure;
use crate::print;

/// Seconds since 1970 that stand for now, so that outputs can be made again byte by byte (reproducible-builds.org).
const EPOCH: &str = "SOURCE_DATE_EPOCH";

/// This run of the program.
///
/// # Errors
/// If `SOURCE_DATE_EPOCH` is set and names no time.
pub fn this_run() -> Result<ProgramRun, Failure> {
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    Ok(ProgramRun {
        program: generator(),
        command: std::iter::once("spineline".to_owned()).chain(words).collect(),
        date_utc: now()?.to_rfc3339_opts(SecondsFormat::Secs, true),
    })
}

fn now() -> Result<DateTime<Utc>, Failure> {
    let Some(given) = std::env::var_os(EPOCH) else { return Ok(Utc::now()) };
    let seconds = given.to_str().and_then(|text| text.parse::<i64>().ok());
    seconds.and_then(|seconds| DateTime::from_timestamp(seconds, 0)).ok_or_else(|| {
        Failure::usage(format!(
            "{EPOCH} is `{}`; expected whole seconds since 1970",
            given.to_string_lossy()
        ))
    })
}

/// A case with the file that it was read from.
#[derive(Clone)]
pub struct Source {
    pub file: CaseFile,
    pub case: Case,
    /// What was asked of it, where it comes from within an analysis.
    pub asked: Option<Request>,
    pub input: InputFile,
}

impl Source {
    /// Reads a case, or the case within an analysis.
    ///
    /// # Errors
    /// As the library's readers.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let failed = |error| Failure::file(path, &error);
        let text = spineline_files::read_text(path).map_err(failed)?;
        let (file, asked) = spineline_files::parse_case_within(&text).map_err(failed)?;
        let case = file.clone().into_case().map_err(failed)?;
        Ok(Self { file, case, asked, input: input_of(path, &text) })
    }
}

/// A text file that was read, by the name that the user gave it.
pub fn input_of(path: &Path, text: &str) -> InputFile {
    InputFile::of(path.to_string_lossy(), text.as_bytes())
}

/// As [`input_of`], of a file that something else reads.
///
/// # Errors
/// If it cannot be read.
pub fn read_input(path: &Path) -> Result<InputFile, Failure> {
    let text = spineline_files::read_text(path).map_err(|error| Failure::file(path, &error))?;
    Ok(input_of(path, &text))
}

/// Writes a table plain, so that every program reads it at once, and its provenance beside it; to the standard output
/// (`-`) goes the table alone.
///
/// # Errors
/// If they cannot be written.
pub fn write_table(path: &Path, text: &str, provenance: &Provenance) -> Result<(), Failure> {
    if path.as_os_str() == "-" {
        print(text).map(|_| ())
    } else {
        write_beside(path, text.as_bytes(), provenance)
    }
}

/// Writes a file that has no place for its provenance, and the provenance beside it.
///
/// # Errors
/// If they cannot be written.
pub fn write_beside(path: &Path, content: &[u8], provenance: &Provenance) -> Result<(), Failure> {
    write_file(path, content)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let file = ProvenanceFile::new(vec![InputFile::of(&*name, content)], provenance.clone());
    write_file(&beside(path), spineline_files::to_text(&file))
}

/// `errors.csv` has `errors.csv.provenance.json` beside it.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".provenance.json");
    path.with_file_name(name)
}

/// A picture that holds its provenance as metadata, which no program draws.
pub fn in_svg(svg: &str, provenance: &Provenance) -> String {
    let Some(end) = svg.find("<svg").and_then(|start| Some(start + svg[start..].find('>')? + 1))
    else {
        return svg.to_owned();
    };
    let text = spineline_files::to_text(provenance);
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    format!("{}\n<metadata>{text}</metadata>{}", &svg[..end], &svg[end..])
}
