//! Reading cases, models and folders of them.

use std::fs::{self, DirEntry, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use spineline::analysis::Case;
use spineline::cohort::{KnownPatients, PatientMarks};
use spineline::warning::counted;
use spineline_files::{
    CaseFile, FileError, InputFile, Request, StoredModel, parse_model, read_text,
};

use super::failure::Failure;
use super::messages::say;
use super::provenance::shown_name;

/// The format of analyses, which contain their cases.
const ANALYSIS: &str = "spineline-analysis";
/// The format of the true values of a phantom, which lie beside its case.
const TRUTH: &str = "spineline-phantom-truth";

/// Adds a case to the patients so far.
///
/// # Errors
/// If its patient would count twice.
pub fn count_once(known: &mut KnownPatients, place: &str, case: &Case) -> Result<(), Failure> {
    let added = known.add(PatientMarks::of(case));
    added.map_err(|error| Failure::of(place, &error))
}

/// The case files that the given paths name, in order; a folder stands for the cases among the `.json` files in it.
///
/// # Errors
/// If a folder cannot be read or has no `.json` file.
pub fn case_files(given: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    for path in given {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let entries = fs::read_dir(path)
            .and_then(Iterator::collect::<Result<Vec<_>, _>>)
            .map_err(|error| Failure::input(path.display(), error, "check the folder"))?;
        let (mut inside, others): (Vec<PathBuf>, Vec<PathBuf>) =
            entries.iter().map(DirEntry::path).partition(|file| ends_in_json(file));
        note_folders(path, &others);
        if inside.is_empty() {
            let help = "give a folder of case files";
            return Err(Failure::input(path.display(), "no .json file in this folder", help));
        }
        // Reading a pipe could wait for ever; a pipe given by name is read.
        if let Some(odd) = inside.iter().find(|file| !file.is_file()) {
            let help = "move it out of the folder, or give the files by name";
            return Err(Failure::input(odd.display(), "it is not a plain file", help));
        }
        inside.sort();
        files.append(&mut without_outputs(path, inside)?);
    }
    Ok(files)
}

/// Says that folders inside a folder have files that may be cases.
fn note_folders(folder: &Path, others: &[PathBuf]) {
    let may_be_case =
        |file: PathBuf| ends_in_json(&file) && file.is_file() && output_format(&file).is_none();
    let has_case = |inside: &&PathBuf| {
        let mut entries = fs::read_dir(inside).into_iter().flatten().filter_map(Result::ok);
        inside.is_dir() && entries.any(|entry| may_be_case(entry.path()))
    };
    let unread = others.iter().filter(has_case).count();
    if unread > 0 {
        let (unread, folder) = (counted(unread, "folder"), folder.display());
        say(format!(
            "note: not read: {unread} with .json files inside {folder}; give each by name"
        ));
    }
}

/// The cases among the files of a folder: files that this program wrote are passed over, and a message says so. Analyses count as
/// cases if the folder has no case.
fn without_outputs(folder: &Path, inside: Vec<PathBuf>) -> Result<Vec<PathBuf>, Failure> {
    let (mut outputs, mut cases): (Vec<_>, Vec<_>) = inside
        .into_par_iter()
        .map(|file| (output_format(&file), file))
        .filter(|(format, _)| format.as_deref() != Some(TRUTH))
        .collect::<Vec<_>>()
        .into_iter()
        .partition(|(format, _)| format.is_some());
    if cases.is_empty() {
        let is_analysis = |format: &Option<String>| format.as_deref() == Some(ANALYSIS);
        (cases, outputs) = outputs.into_iter().partition(|(format, _)| is_analysis(format));
    }
    if cases.is_empty() {
        let help = "give a folder of case files";
        let what = "no case file in this folder; this program wrote the files in it";
        return Err(Failure::input(folder.display(), what, help));
    }
    for (format, file) in &outputs {
        let format = format.as_deref().unwrap_or_default();
        say(format!(
            "note: {} is passed over: it is an output (`{format}`), not a case",
            file.display()
        ));
    }
    Ok(cases.into_iter().map(|(_, file)| file).collect())
}

/// The format of a file of this program other than a case; of a list, the format of its analyses. `None` for anything else.
fn output_format(path: &Path) -> Option<String> {
    let text = read_text(path).ok()?;
    let format = spineline_files::file_format(&text)?;
    (format.starts_with("spineline-") && format != "spineline-case").then_some(format)
}

/// A case with the file that it was read from.
#[derive(Clone)]
pub struct CaseInput {
    pub file: CaseFile,
    pub case: Case,
    /// The options of the analysis that holds the case, if it was read from one.
    pub request: Option<Request>,
    pub input: InputFile,
}

impl CaseInput {
    /// Reads a case, or the case within an analysis.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let failed = |error| Failure::file(path, &error);
        refuse_picture(path)?;
        let text = read_text(path).map_err(failed)?;
        let (file, request) = spineline_files::parse_case_within(&text).map_err(failed)?;
        let case = file.clone().into_case().map_err(failed)?;
        Ok(Self { file, case, request, input: input_of(path, &text) })
    }
}

/// Endings of pictures.
const PICTURES: [&str; 7] = ["dcm", "dicom", "png", "jpg", "jpeg", "tif", "tiff"];

/// The first bytes of a file; `None` for a pipe, which gives each byte once, and for a file that cannot be read.
fn start_of(path: &Path) -> Option<Vec<u8>> {
    let mut start = Vec::new();
    let file = path.is_file().then(|| File::open(path))?.ok()?;
    file.take(132).read_to_end(&mut start).ok().map(|_| start)
}

/// Whether a file ends in `.json`, in any capitals.
fn ends_in_json(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
}

/// Whether a path stands for a case, not for a picture or a store: by its name, or because the file there is JSON.
pub fn is_case(path: &Path) -> bool {
    let is_json = |start: Vec<u8>| {
        let text = start.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&start);
        text.trim_ascii_start().starts_with(b"{")
    };
    ends_in_json(path) || start_of(path).is_some_and(is_json)
}

/// Refuses a picture where a case is expected.
fn refuse_picture(path: &Path) -> Result<(), Failure> {
    let Some(start) = start_of(path) else { return Ok(()) };
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let is_picture = ending.is_some_and(|ending| PICTURES.contains(&&*ending))
        || spineline_films::sniff(&start).is_ok();
    if !is_picture {
        return Ok(());
    }
    let help = "make a case of the films first: `spineline import FOLDER --case-id ID --out DIR`; then mark them with `spineline serve DIR/case.json`";
    Err(Failure::input(path.display(), "it is a picture, and this command takes cases", help))
}

/// A text file that was read, by its name without its folder.
pub fn input_of(path: &Path, text: &str) -> InputFile {
    InputFile::of(shown_name(path), text.as_bytes())
}

/// As [`input_of`], for a file that other code reads.
pub fn read_input(path: &Path) -> Result<InputFile, Failure> {
    let text = read_text(path).map_err(|error| Failure::file(path, &error))?;
    Ok(input_of(path, &text))
}

/// Reads a personalised model with at least one joint.
///
/// # Errors
/// If the file is not a model, or the model has no joint.
pub fn read_model(path: &Path) -> Result<StoredModel, Failure> {
    let stored = read_text(path).and_then(|text| parse_model(&text));
    let stored = stored.map_err(|error| match &error {
        FileError::Format { .. } => Failure::input(
            path.display(),
            &error,
            "this command takes a model; `spineline analyze CASE --model FILE` writes one",
        ),
        _ => Failure::file(path, &error),
    })?;
    if stored.model.spine.joints.is_empty() {
        let help = "give a model of at least two vertebrae";
        return Err(Failure::input(path.display(), "the model has no joint", help));
    }
    Ok(stored)
}
