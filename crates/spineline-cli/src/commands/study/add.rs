//! A case into a store: its films by their bytes, its readings click by click.

use std::path::Path;

use spineline::warning::counted;
use spineline_files::parse_case_file;
use spineline_films::intake::{IntakeLimits, Place, read};
use spineline_store::{CaseError, NewCase, Signature, Store};

use crate::analysis::films::{FilmWarning, check_films};
use crate::run::failure::Failure;

/// Adds one case; returns what was added as text. Films that may not belong into the case are taken only if accepted.
pub fn add(
    store: &mut Store,
    at: &Path,
    (path, accept): (&Path, bool),
    by: &Signature,
) -> Result<String, Failure> {
    let text = spineline_files::read_text(path).map_err(|error| Failure::file(path, &error))?;
    let bytes_of = |file: &str| {
        let place = Place::File(path.with_file_name(file));
        read(&place, &IntakeLimits::default()).map_err(|error| Failure::intake(&error))
    };
    let case = NewCase::read(&text, bytes_of).map_err(|error| refusal(path, error))?;
    let warnings = film_warnings(path, &text)?;
    let doubts: Vec<&FilmWarning> = warnings.iter().filter(|one| one.doubts_film()).collect();
    if !accept && !doubts.is_empty() {
        return Err(doubtful(path, &doubts));
    }
    let added = store.add_case(&case, by).map_err(|error| Failure::store(at, &error))?;
    let (films, readings) =
        (counted(added.films.len(), "film"), counted(added.readings, "reading"));
    let mut text = format!("{}: added {films} and {readings}.\n", added.study);
    for remark in &added.remarks {
        text.push_str(&format!("  ! {remark}\n"));
    }
    for one in &warnings {
        text.push_str(&format!("  ! {}\n", one.place_and_text()));
    }
    Ok(text)
}

fn doubtful(path: &Path, doubts: &[&FilmWarning]) -> Failure {
    let texts: Vec<String> = doubts.iter().map(|doubt| doubt.place_and_text()).collect();
    let help = "give the case other films, or --accept if you are sure";
    Failure::input(&path.display().to_string(), &texts.join("; "), help)
}

/// Warnings about the films of the case; one picture for two films is refused.
fn film_warnings(path: &Path, text: &str) -> Result<Vec<FilmWarning>, Failure> {
    let failed = |error| Failure::file(path, &error);
    let file = parse_case_file(text).map_err(failed)?;
    let case = file.clone().into_case().map_err(failed)?;
    check_films(path, &file, &case)
}

fn refusal(path: &Path, error: CaseError<Failure>) -> Failure {
    match error {
        CaseError::File(error) => Failure::file(path, &error),
        CaseError::Picture(failure) => failure,
        CaseError::Name(error) => Failure::usage(format!("{error}; {}", error.help())),
        other => {
            let help = other.help();
            Failure::input(&path.display().to_string(), &other, help)
        }
    }
}
