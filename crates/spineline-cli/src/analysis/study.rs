//! A case into a store: its films by their bytes, its readings click by click.

use std::collections::BTreeSet;
use std::path::Path;

use spineline::anatomy::FilmView;
use spineline::measure::{alike_names, alike_words};
use spineline::warning::{Warning, WarningCode, Warnings, counted};
use spineline_files::{FileError, parse_case_file};
use spineline_report::terminal::Lines;
use spineline_store::{CaseError, Hash, Name, NewCase, Signature, Store, StoreError};

use crate::analysis::films::check_films;
use crate::run::failure::Failure;
use crate::run::film_decoder::case_film_bytes;

/// Adds one case; returns what was added as text. Films that may not belong to the case are added only if accepted, and other pictures
/// than those with the landmarks never.
/// `fail` names the store in its errors.
pub fn add_case(
    store: &mut Store,
    fail: impl Fn(StoreError) -> Failure + Copy,
    path: &Path,
    accept: bool,
    by: &Signature,
) -> Result<Lines, Failure> {
    let text = spineline_files::read_text(path).map_err(|error| Failure::file(path, &error))?;
    let bytes_of = |file: &str| case_film_bytes(&path.with_file_name(file)).map_err(Failure::from);
    let case = NewCase::read(&text, bytes_of).map_err(|error| refusal(path, error))?;
    let (warnings, observers) = film_warnings(path, &text)?;
    let is_other = |one: &&Warning| one.code == WarningCode::PictureDiffers;
    let help = "put the film on which the landmarks were placed into the folder of the case, or correct `sha256` or the size of its `image` in the case";
    refuse_films(path, warnings.all().iter().filter(is_other), help)?;
    if !accept {
        let help = "give the case other films, or --accept if you are sure";
        refuse_films(path, warnings.all().iter().filter(|one| one.code.doubts_film()), help)?;
    }
    let added = store.add_case(&case, by).map_err(fail)?;
    let (films, readings) =
        (counted(added.films.len(), "film"), counted(added.readings, "reading"));
    let mut text = Lines::of(format!("{}: added {films} and {readings}.", added.study));
    for remark in &added.remarks {
        text.line(format!("  ! {remark}"));
    }
    for remark in alike_observers(store, &observers).map_err(fail)? {
        text.line(format!("  ! {remark}"));
    }
    for one in warnings.all() {
        text.line(format!("  ! {}", place_and_text(one)));
    }
    Ok(text)
}

/// Remarks on the films of a case that its study, which `place` keeps, lacks.
///
/// # Errors
/// If the store has studies of other cases only.
pub fn compare_case(store: &Store, place: &Path, path: &Path) -> Result<Vec<String>, Failure> {
    let in_file = |error: FileError| Failure::file(path, &error);
    let in_store = |error: StoreError| Failure::file(place, &error);
    let text = spineline_files::read_text(path).map_err(in_file)?;
    let file = parse_case_file(&text).map_err(in_file)?;
    let case = file.clone().into_case().map_err(in_file)?;
    let id = Name::new(&case.id).map_err(|error| refusal(path, CaseError::Name(error)))?;
    let studies = store.studies().map_err(in_store)?;
    if !studies.iter().any(|study| study.id == id) {
        let known: Vec<&str> = studies.iter().map(|study| study.id.as_str()).collect();
        let place = place.display();
        let what = format!("it is the case {id}, and the store {place} keeps {}", known.join(", "));
        let help = "give the store another name, or add the case to it with `spineline study add`";
        return Err(Failure::input(path.display(), what, help));
    }
    let films = store.films(&id).map_err(in_store)?;
    let differs = FilmView::ALL.into_iter().filter_map(|view| {
        let bytes = case_film_bytes(&path.with_file_name(file.source(view)?.file?)).ok()?;
        let hash = Hash::of(&bytes);
        let is_kept = films.iter().any(|film| film.view == view && film.content == hash);
        let remark = || format!("{}: its study has another {view} film", path.display());
        (!is_kept).then(remark)
    });
    Ok(differs.collect())
}

fn place_and_text(warning: &Warning) -> String {
    match warning.posture {
        Some(posture) => format!("{posture} film: {}", warning.message),
        None => warning.message.clone(),
    }
}

/// Refuses the films of these warnings.
fn refuse_films<'a>(
    path: &Path,
    doubts: impl Iterator<Item = &'a Warning>,
    help: &str,
) -> Result<(), Failure> {
    let texts: Vec<String> = doubts.map(place_and_text).collect();
    if texts.is_empty() {
        return Ok(());
    }
    Err(Failure::input(path.display(), texts.join("; "), help))
}

/// Warnings about the films of the case, and its observers; one picture for two films is refused.
fn film_warnings(path: &Path, text: &str) -> Result<(Warnings, BTreeSet<String>), Failure> {
    let failed = |error| Failure::file(path, &error);
    let file = parse_case_file(text).map_err(failed)?;
    let case = file.clone().into_case().map_err(failed)?;
    let frontal = case.films.iter().flat_map(|film| film.landmarks.reading_ids());
    let lateral = case.lateral.iter().flat_map(|film| &film.readings).map(|reading| &reading.id);
    let observers = frontal.chain(lateral).map(|id| id.observer.clone()).collect();
    Ok((check_films(path, &file, &case)?, observers))
}

/// Remarks on observers whose names differ only by capitals and marks, from each other or from account names.
pub fn alike_observers(
    store: &Store,
    observers: &BTreeSet<String>,
) -> Result<Vec<String>, StoreError> {
    let accounts = store.accounts()?;
    let accounts = accounts.iter().map(|account| account.name.as_str());
    let alike = alike_names(observers.iter().map(String::as_str).chain(accounts));
    let of_these = |names: &&Vec<&str>| names.iter().any(|name| observers.contains(*name));
    Ok(alike.iter().filter(of_these).map(|names| alike_words(names)).collect())
}

fn refusal(path: &Path, error: CaseError<Failure>) -> Failure {
    match error {
        CaseError::File(error) => Failure::file(path, &error),
        CaseError::Picture(failure) => failure,
        CaseError::Name(error) => Failure::usage(format!("{error}; {}", error.help())),
        other => Failure::of(path.display(), &other),
    }
}
