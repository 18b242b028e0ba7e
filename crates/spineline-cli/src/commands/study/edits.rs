//! Withdrawn and corrected readings, and studies that are renamed or archived.

use std::path::Path;

use spineline_report::document::Table;
use spineline_report::terminal::{self, Lines};
use spineline_store::{
    Name, ReadingId, ReadingRecord, Signature, Store, StoreError, StudyEdit, WithdrawalCause,
};

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{entry_width, print};

pub fn list_readings(path: &Path, study: &Name) -> Result<Ending, Failure> {
    let table = Store::view(path).and_then(|store| table(&store, study));
    let table = table.map_err(|error| Failure::file(path, &error))?;
    print(Lines::of_text(&terminal::table(&table, entry_width())))
}

pub fn withdraw(
    path: &Path,
    reading: i64,
    reason: &str,
    by: &Signature,
) -> Result<Ending, Failure> {
    let store = Store::open(path);
    let correction = store.and_then(|mut s| s.withdraw_reading(ReadingId(reading), reason, by));
    let correction = correction.map_err(|error| Failure::file(path, &error))?;
    let mut text = Lines::of(format!("Reading {reading} is withdrawn."));
    if let Some(ReadingId(copy)) = correction {
        text.line(format!("Reading {copy}, its open correction, is withdrawn too."));
    }
    print(text)
}

pub fn correct(path: &Path, reading: i64, by: &Signature) -> Result<Ending, Failure> {
    let store = Store::open(path);
    let copy = store.and_then(|mut store| store.correct_reading(ReadingId(reading), by));
    let copy = copy.map_err(|error| match error {
        StoreError::NotYours { .. } => {
            Failure::file(path, &error).with_line("`--by` must be the observer of the reading")
        }
        _ => Failure::file(path, &error),
    });
    let copy = copy?.0;
    print(format!(
        "Reading {copy} is a copy of reading {reading}, and replaces it when {} finishes it in the browser.",
        by.who
    ))
}

pub fn edit(
    path: &Path,
    study: &Name,
    edit: &StudyEdit,
    by: &Signature,
) -> Result<Ending, Failure> {
    let edited = Store::open(path).and_then(|mut store| {
        let revision = store.study(study)?.revision;
        store.edit_study(study, edit, revision, by)
    });
    edited.map_err(|error| Failure::file(path, &error))?;
    let done = match edit {
        StudyEdit::Label { label: Some(label) } if !label.trim().is_empty() => "has its new label",
        StudyEdit::Label { .. } => "has no label now",
        StudyEdit::Archived { archived: true } => "is archived",
        StudyEdit::Archived { archived: false } => "is back from the archive",
    };
    print(format!("Study {study} {done}."))
}

fn table(store: &Store, study: &Name) -> Result<Table, StoreError> {
    let films = store.films(study)?;
    let film = |reading: &ReadingRecord| {
        let film = films.iter().find(|film| film.id == reading.film);
        film.map_or_else(String::new, |film| film.view.to_string())
    };
    Ok(Table::of("", store.readings(study)?, |add| {
        add.numbers("Reading", |reading| reading.id.0.to_string());
        add.words("Film", film);
        add.words("Observer", |reading| reading.observer.to_string());
        add.numbers("Repeat", |reading| reading.repeat.to_string());
        add.words("State", state);
    }))
}

fn state(reading: &ReadingRecord) -> String {
    let state = match reading.withdrawn.as_ref().map(|withdrawal| &withdrawal.cause) {
        Some(WithdrawalCause::Reason(_)) => "withdrawn".to_owned(),
        Some(WithdrawalCause::CorrectedBy(copy)) => format!("replaced by {}", copy.0),
        None if reading.finished_at.is_some() => "finished".to_owned(),
        None => "open".to_owned(),
    };
    match reading.corrects {
        Some(corrected) => format!("{state}, corrects {}", corrected.0),
        None => state,
    }
}
