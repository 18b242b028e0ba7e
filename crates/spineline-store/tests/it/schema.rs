//! The schema: a store that an independent writer makes from its SQL and the description of the log, and stores of a
//! newer schema.

use std::fs;
use std::path::Path;

use rusqlite::{Connection, params};
use sha2::{Digest, Sha256};
use spineline::anatomy::{FilmView, Level, Posture};
use spineline_files::method_text::ChosenOptions;
use spineline_store::{
    Corner, Event, FilmEdit, FilmId, ReadingId, Store, StoreError, StudyOptions,
};

use crate::options::option;
use crate::session::{by, film_bytes, folder, image, name};

const SCHEMA: &str = include_str!("../../src/schema.sql");
/// The schema that this program reads and writes.
const VERSION: i64 = 1;
const TIME_MS: i64 = 1_700_000_000_000;

fn sha256(bytes: impl AsRef<[u8]>) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Adds rows and their log entries as the schema and the log want them.
struct Writer {
    raw: Connection,
    entries: i64,
    hash: String,
}

impl Writer {
    fn log(&mut self, object: &str, digest: &str) {
        self.entries += 1;
        let json = format!(
            r#"{{"sequence":{},"time_ms":{TIME_MS},"actor":"old","action":"add","object":"{object}","digest":"{digest}"}}"#,
            self.entries
        );
        self.hash = sha256(self.hash.clone() + &json);
        self.raw
            .execute(
                "INSERT INTO audit VALUES (?1, ?2, 'old', 'add', ?3, ?4, ?5)",
                params![self.entries, TIME_MS, object, digest, self.hash],
            )
            .expect("an entry");
    }

    /// `digested` is the JSON array of the row's key and columns.
    fn add(&mut self, sql: &str, object: &str, digested: &serde_json::Value) {
        self.raw.execute(sql, []).expect("a row");
        self.log(object, &sha256(digested.to_string()));
    }
}

fn write_store(path: &Path, films: i64) {
    use serde_json::json;
    let raw = Connection::open(path).expect("a database");
    raw.execute_batch(SCHEMA).expect("the schema");
    raw.execute_batch("PRAGMA application_id = 1399870324; PRAGMA user_version = 1; BEGIN")
        .expect("marks");
    let mut writer = Writer { raw, entries: 0, hash: String::new() };
    writer.log("store", "");
    writer.add(
        "INSERT INTO studies VALUES ('S-1', 'Doe', 1, 0, 0)",
        "study/S-1",
        &json!(["S-1", "S-1", "Doe", 1, 0, 0]),
    );
    for film in 1..=films {
        let bytes = film_bytes(u32::try_from(film).expect("few"));
        let (hash, image) = (sha256(&bytes), image().to_string());
        writer
            .raw
            .execute("INSERT INTO contents VALUES (?1, ?2)", params![hash, bytes])
            .expect("bytes");
        let digested = json!([hash, hash, hash]);
        writer.log(&format!("content/{hash}"), &sha256(digested.to_string()));
        let posture = Posture::ALL[film as usize % 5].key();
        let sql = format!(
            "INSERT INTO films VALUES ({film}, 'S-1', '{posture}', '{hash}', '{image}', 0, 0)"
        );
        let digested = json!([film, film, "S-1", posture, hash, image, 0, 0]);
        writer.add(&sql, &format!("film/{film}"), &digested);
        let sql = format!(
            "INSERT INTO readings VALUES ({film}, {film}, 'A', 1, {TIME_MS}, NULL, NULL, NULL)"
        );
        writer.raw.execute(&sql, []).expect("a reading");
        // The last click came after the finish, by a clock that went back.
        for (revision, corner) in (1..).zip(Corner::FRONTAL.points()) {
            let event = json!({ "kind": "place_corner", "level": "L4", "corner": corner.key(), "column_px": revision, "row_px": film }).to_string();
            let (number, time) = ((film - 1) * 4 + revision, TIME_MS + revision * 1000);
            let sql = format!(
                "INSERT INTO events VALUES ({number}, {film}, {revision}, {time}, '{event}')"
            );
            let digested = json!([number, number, film, revision, time, event]);
            writer.add(&sql, &format!("event/{number}"), &digested);
        }
        let (finished, rest_from) = (TIME_MS + 1000, TIME_MS + 4000);
        let sql = format!(
            "UPDATE readings SET finished_ms = {finished}, rest_from_ms = {rest_from} WHERE id = {film}"
        );
        let digested = json!([film, film, film, "A", 1, TIME_MS, finished, rest_from, null]);
        writer.add(&sql, &format!("reading/{film}"), &digested);
    }
    let (entries, hash) = (writer.entries, writer.hash.clone());
    writer
        .raw
        .execute("INSERT INTO head VALUES (1, ?1, ?2, ?3)", params![entries, hash, TIME_MS])
        .expect("a head");
    writer.raw.execute_batch("COMMIT; PRAGMA journal_mode = WAL").expect("committed");
}

#[test]
fn a_study_takes_one_lateral_film() {
    let folder = folder();
    let path = folder.path().join("store");
    write_store(&path, 1);
    assert!(Store::view(&path).expect("a store").verify(None).expect("verifiable").is_clean());
    let mut store = Store::open(&path).expect("a store");
    let (study, lateral) = (name("S-1"), FilmView::Lateral);
    let mut add =
        |seed| store.add_film(&study, lateral, &film_bytes(seed), &image(), &by("lead", 0));
    add(7).expect("the first one");
    refused!(add(8), ViewTwice { view: FilmView::Lateral, .. });
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn a_store_with_the_described_schema_is_read_and_written() {
    let folder = folder();
    let path = folder.path().join("store");
    write_store(&path, 3);
    let study = name("S-1");
    let before = fs::read(&path).expect("bytes");
    let viewed = Store::view(&path).expect("a store");
    assert!(viewed.verify(None).expect("verifiable").is_clean());
    assert_eq!(viewed.study_options(&study).expect("none yet"), StudyOptions::default());
    drop(viewed);
    assert!(fs::read(&path).expect("bytes") == before, "viewing changes nothing");
    let mut store = Store::open(&path).expect("a store");
    let verified = store.verify(None).expect("verifiable");
    assert!(verified.is_clean(), "{verified:?}");
    let readings = store.readings(&name("S-1")).expect("readings");
    assert_eq!(readings.len(), 3);
    assert_eq!(readings[0].rest_from.map(|time| time.unix_ms()), Some(TIME_MS + 4000));
    let state = store.reading_state(ReadingId(2)).expect("a state");
    assert!(state.finished);
    assert_eq!(state.vertebrae[&Level::L4].corners[&Corner::InferiorRight], [4.0, 2.0]);
    refused!(store.reading_state(ReadingId(4)), Unknown { .. });
    store.edit_film(FilmId(1), FilmEdit::Inverted(true), 0, &by("lead", 0)).expect("a new thing");
    let chosen = ChosenOptions::new(&[option("support", "free")]).expect("valid");
    store.set_study_options(&study, &chosen, 0, &by("lead", 0)).expect("the new table");
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn a_store_of_a_newer_program_is_refused_and_not_changed() {
    let folder = folder();
    let path = folder.path().join("store");
    drop(crate::session::create(&path));
    let raw = Connection::open(&path).expect("a database");
    let newer = VERSION + 1;
    raw.execute_batch(&format!("PRAGMA user_version = {newer}; PRAGMA journal_mode = DELETE"))
        .expect("a newer schema");
    drop(raw);
    let before = fs::read(&path).expect("bytes");
    for refused in [Store::open(&path), Store::view(&path)] {
        let refused = refused.expect_err("newer");
        assert!(
            matches!(refused, StoreError::NewerSchema { found, supported: VERSION } if found == newer),
            "{refused:?}"
        );
    }
    assert!(fs::read(&path).expect("bytes") == before);
}

#[test]
fn a_store_without_the_number_of_its_schema_is_damaged_and_not_changed() {
    let folder = folder();
    let path = folder.path().join("store");
    for number in [0, -1] {
        let _ = fs::remove_file(&path);
        drop(crate::session::create(&path));
        let raw = Connection::open(&path).expect("a database");
        let change = format!("PRAGMA user_version = {number}; PRAGMA journal_mode = DELETE");
        raw.execute_batch(&change).expect("another number");
        drop(raw);
        let before = fs::read(&path).expect("bytes");
        for refused in [Store::open(&path), Store::view(&path)] {
            refused!(refused, Damaged { .. });
        }
        assert!(fs::read(&path).expect("bytes") == before);
    }
}

#[test]
fn an_event_of_the_schema_round_trips() {
    let json = r#"{"kind":"place_corner","level":"Th12","corner":"superior_left","column_px":1,"row_px":2.5}"#;
    let event: Event = serde_json::from_str(json).expect("an event");
    assert_eq!(event, crate::session::place(Level::T12, Corner::SuperiorLeft, 1.0, 2.5));
    let wrong = json.replace("column_px", "column");
    assert!(serde_json::from_str::<Event>(&wrong).is_err(), "an unknown key");
}
