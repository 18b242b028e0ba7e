//! De-identified films, and the case beside them.

use std::fs::{self, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use spineline::analysis::Case;
use spineline::anatomy::FilmView;
use spineline::measure::{Film, FilmLandmarks, LateralFilm};
use spineline_files::{CaseFile, FilmSource, sha256_hex};
use spineline_films::intake::{IntakeLimits, read};
use spineline_films::{DeidAction, DeidOptions, DeidReport, FilmKind, FilmLimits, deidentify};

use super::args::ImportArgs;
use super::candidates::Candidates;
use super::landmarks::LandmarksByPosture;
use super::resolve::ResolvedFilm;
use crate::run::failure::Failure;
use crate::run::messages::say;
use crate::run::outputs::{Outputs, OverwriteArgs};
use crate::run::provenance::generator;

/// Landmarks on the films of a case.
pub struct Marks {
    pub frontal: LandmarksByPosture,
    /// The lateral film, where there is one, with its readings.
    pub lateral: Option<LateralFilm>,
}

/// What was removed from a film, and remarks on it.
#[derive(Serialize)]
struct FilmReport {
    film: &'static str,
    file: String,
    sha256: String,
    notes: Vec<String>,
    /// Absent where the identity was kept.
    deidentification: Option<DeidRecord>,
}

/// What was done with a film's attributes, by their tags; never a value.
#[derive(Serialize)]
struct DeidRecord {
    removed: Vec<String>,
    emptied: Vec<String>,
    replaced: Vec<String>,
    added: Vec<String>,
    remarks: Vec<String>,
}

impl DeidRecord {
    fn of(report: &DeidReport) -> Self {
        let tags = |wanted: &[DeidAction]| -> Vec<String> {
            let entries = report.entries.iter().filter(|entry| wanted.contains(&entry.action));
            entries.map(|entry| entry.attribute.to_string()).collect()
        };
        Self {
            removed: tags(&[DeidAction::Removed]),
            emptied: tags(&[DeidAction::Emptied]),
            replaced: tags(&[DeidAction::Replaced, DeidAction::UidReplaced]),
            added: tags(&[DeidAction::Added]),
            remarks: report.remarks.iter().map(ToString::to_string).collect(),
        }
    }
}

#[derive(Serialize)]
struct ImportReport<'a> {
    format: &'static str,
    version: u32,
    generator: String,
    case_id: &'a str,
    identity_kept: bool,
    films: Vec<FilmReport>,
}

/// Refuses a folder that holds anything that an import writes: films and landmarks are never overwritten.
pub fn check_free(folder: &Path) -> Result<(), Failure> {
    let name = |view| FilmKind::ALL.map(|kind| file_name(view, kind));
    let films = FilmView::ALL.into_iter().flat_map(name);
    let ours = ["case.json", "import.json"].map(str::to_owned).into_iter().chain(films);
    match ours.map(|name| folder.join(name)).find(|path| path.exists()) {
        None => Ok(()),
        Some(there) => Err(Failure::input(
            there.display(),
            "it exists already, and an import overwrites nothing",
            "choose another folder with --out",
        )),
    }
}

fn file_name(view: FilmView, kind: FilmKind) -> String {
    format!("{}.{}", view.key(), kind.key())
}

/// Writes the films, the case, and a report of what was done.
pub fn write(
    args: &ImportArgs,
    folder: &Path,
    case_id: &str,
    candidates: &Candidates,
    films: &[ResolvedFilm],
    marks: &Marks,
) -> Result<(), Failure> {
    // Films and landmarks are never overwritten: `check_free` found the folder without them.
    let outputs = Outputs::new(OverwriteArgs { overwrite: false }, []);
    outputs.folder(folder)?;
    let secret = secret(args)?;
    let mut reports = Vec::new();
    let mut sources = Vec::new();
    for film in films {
        let (bytes, source, report) = cleaned_film(args, case_id, candidates, film, &secret)?;
        outputs.write(&folder.join(&report.file), bytes)?;
        sources.push((film.view, source));
        reports.push(report);
    }
    let case = CaseFile::from_case(&case(case_id, films, marks));
    let case =
        sources.into_iter().fold(case, |case, (view, source)| case.with_source(view, source));
    let report = ImportReport {
        format: "spineline-import",
        version: 1,
        generator: generator(),
        case_id,
        identity_kept: args.keep_identity,
        films: reports,
    };
    outputs.write(&folder.join("import.json"), spineline_files::to_text(&report))?;
    // The case is written last: if it exists, the files that it names exist.
    outputs.write(&folder.join("case.json"), spineline_files::to_text(&case))?;
    outputs.commit()
}

/// A film as it is written, its source for the case, and what was done with it.
fn cleaned_film(
    args: &ImportArgs,
    case_id: &str,
    candidates: &Candidates,
    film: &ResolvedFilm,
    secret: &[u8; 32],
) -> Result<(Vec<u8>, FilmSource, FilmReport), Failure> {
    let found = &candidates.films[film.index].found;
    let bytes = read(&found.place, &IntakeLimits::default())?;
    if sha256_hex(&bytes) != film.source {
        return Err(Failure::input(
            &found.place,
            "it changed during the import",
            "run the import again while no other program writes there",
        ));
    }
    let (bytes, kind, deidentification) = if args.keep_identity {
        (bytes, found.kind, None)
    } else {
        let options = DeidOptions {
            case_id: case_id.to_owned(),
            salt: *secret,
            retain_sex_and_age: args.keep_characteristics,
        };
        let clean = deidentify(&bytes, &options, &FilmLimits::default())
            .map_err(|error| Failure::of(film.view, &error))?;
        // Pictures without a DICOM header are encoded again.
        let kind = if found.kind == FilmKind::Dicom { FilmKind::Dicom } else { FilmKind::Png };
        (clean.bytes, kind, Some(DeidRecord::of(&clean.report)))
    };
    let file = file_name(film.view, kind);
    let sha256 = sha256_hex(&bytes);
    let source = FilmSource {
        file: Some(file.clone()),
        sha256: Some(sha256.clone()),
        inverted: film.inverted,
    };
    let notes = film.notes.clone();
    Ok((bytes, source, FilmReport { film: film.view.key(), file, sha256, notes, deidentification }))
}

/// The case: pictures, sides and scales, with imported landmarks.
fn case(case_id: &str, films: &[ResolvedFilm], marks: &Marks) -> Case {
    let frontal = films.iter().filter_map(|film| {
        let posture = film.view.posture()?;
        let unmarked = || FilmLandmarks::Corners {
            image: film.image,
            iliac_crests: None,
            readings: Vec::new(),
        };
        let landmarks = marks.frontal.get(&posture).cloned();
        Some(Film::new(posture, landmarks.unwrap_or_else(unmarked)))
    });
    Case {
        // One film of a patient makes the case a patient's.
        synthetic: films.iter().all(|film| film.is_phantom),
        lateral: marks.lateral.clone(),
        ..Case::of_films(case_id, frontal.collect())
    }
}

/// The secret that maps identifiers; made once, and readable by its owner alone.
fn secret(args: &ImportArgs) -> Result<[u8; 32], Failure> {
    if args.keep_identity {
        return Ok([0; 32]);
    }
    let path = args.secret.clone().map_or_else(default_secret, Ok)?;
    let failed = |error: &std::io::Error| Failure::write(&path.display().to_string(), error);
    match secret_bytes(&path) {
        Ok(bytes) => {
            return <[u8; 32]>::try_from(bytes).map_err(|bytes| {
                Failure::input(
                    path.display(),
                    match bytes.len() {
                        33.. => "a secret has 32 bytes, and this file has more".to_owned(),
                        count => format!("a secret has 32 bytes, and this file has {count}"),
                    },
                    "name another file, or a file that does not exist yet",
                )
            });
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
        Err(error) => return Err(failed(&error)),
    }
    let mut secret = [0; 32];
    getrandom::fill(&mut secret)
        .map_err(|error| Failure::internal(format!("no random numbers: {error}")))?;
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| failed(&error))?;
    }
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut file = options.open(&path).map_err(|error| failed(&error))?;
    file.write_all(&secret).and_then(|()| file.sync_all()).map_err(|error| failed(&error))?;
    say(format!("new secret for identifiers: {} (keep it, and do not pass it on)", path.display()));
    Ok(secret)
}

/// The bytes of a secret; of a longer file, one more.
fn secret_bytes(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    fs::File::open(path)?.take(33).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn default_secret() -> Result<PathBuf, Failure> {
    // The XDG specification ignores a relative path: it would lie in the working folder.
    let variable =
        |name| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let folder = variable("XDG_CONFIG_HOME")
        .or_else(|| variable("APPDATA"))
        .or_else(|| variable("HOME").map(|home| home.join(".config")));
    folder.map(|folder| folder.join("spineline").join("identifiers.secret")).ok_or_else(|| {
        Failure::usage("no configuration folder was found: name a file with --secret")
    })
}
