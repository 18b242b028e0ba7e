//! Stores of schema 1, which an independent writer makes here from the schema's SQL and the description of the log.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rusqlite::{Connection, params};
use sha2::{Digest, Sha256};
use spineline::anatomy::{Level, Posture};
use spineline_server::store::{
    Account, Corner, Event, FilmEdit, FilmId, PasswordHash, ReadingId, Role, Store, StoreError,
};

use crate::session::{by, film_bytes, image, name};

const V1: &str = include_str!("../../src/store/schema/v1.sql");
const CHILD: &str = "SPINELINE_TEST_MIGRATION_STORE";
/// The schema that this program writes.
const CURRENT: i64 = 4;
const TIME_MS: i64 = 1_700_000_000_000;

fn sha256(bytes: impl AsRef<[u8]>) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Adds rows and their log entries as schema 1 wants them.
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

fn write_v1(path: &Path, films: i64) {
    use serde_json::json;
    let raw = Connection::open(path).expect("a database");
    raw.execute_batch(V1).expect("schema 1");
    raw.execute_batch("PRAGMA application_id = 1399870324; PRAGMA user_version = 1; BEGIN")
        .expect("marks");
    let mut writer = Writer { raw, entries: 0, hash: String::new() };
    writer.log("store", "");
    writer.add(
        "INSERT INTO studies VALUES ('S-1', 'Doe', 1)",
        "study/S-1",
        &json!(["S-1", "S-1", "Doe", 1]),
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
            "INSERT INTO films VALUES ({film}, 'S-1', '{posture}', '{hash}', '{image}', 0)"
        );
        let digested = json!([film, film, "S-1", posture, hash, image, 0]);
        writer.add(&sql, &format!("film/{film}"), &digested);
        let (begun, finished) = (TIME_MS, TIME_MS + 1000);
        let sql =
            format!("INSERT INTO readings VALUES ({film}, {film}, 'A', 1, {begun}, {finished})");
        let digested = json!([film, film, film, "A", 1, begun, finished]);
        writer.add(&sql, &format!("reading/{film}"), &digested);
        // The last click came after the finish, by a clock that went back.
        for (revision, corner) in (1..).zip(Corner::ALL) {
            let event = json!({ "kind": "place_corner", "level": "L4", "corner": corner.key(), "column_px": revision, "row_px": film }).to_string();
            let (number, time) = ((film - 1) * 4 + revision, TIME_MS + revision * 1000);
            let sql = format!(
                "INSERT INTO events VALUES ({number}, {film}, {revision}, {time}, '{event}')"
            );
            let digested = json!([number, number, film, revision, time, event]);
            writer.add(&sql, &format!("event/{number}"), &digested);
        }
    }
    let (entries, hash) = (writer.entries, writer.hash.clone());
    writer
        .raw
        .execute("INSERT INTO head VALUES (1, ?1, ?2, ?3)", params![entries, hash, TIME_MS])
        .expect("a head");
    writer.raw.execute_batch("COMMIT; PRAGMA journal_mode = WAL").expect("committed");
}

fn schema_of(path: &Path) -> i64 {
    let raw = Connection::open(path).expect("a database");
    raw.pragma_query_value(None, "user_version", |row| row.get(0)).expect("a number")
}

#[test]
fn an_old_store_is_migrated_with_a_backup_and_keeps_every_reading() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, backup) = (folder.path().join("store"), folder.path().join("store.backup-v1"));
    write_v1(&path, 3);
    fs::write(&backup, "an older backup").expect("a file");
    let refused = Store::view(&path);
    assert!(matches!(refused, Err(StoreError::OlderSchema { found: 1, .. })), "{refused:?}");
    let mut store = Store::open(&path).expect("a migrated store");
    assert!(store.verify(None).expect("verifiable").is_clean());
    let readings = store.readings(&name("S-1")).expect("readings");
    assert_eq!(readings.len(), 3);
    // The washout counts from the last click.
    assert_eq!(readings[0].rest_from.map(|time| time.unix_ms()), Some(TIME_MS + 4000));
    let state = store.reading_state(ReadingId(2)).expect("a state");
    assert!(state.finished);
    assert_eq!(state.vertebrae[&Level::L4].corners[&Corner::InferiorRight], [4.0, 2.0]);
    store.edit_film(FilmId(1), FilmEdit::Inverted(true), 0, &by("lead", 0)).expect("a new thing");
    let log = store.audit_log().expect("a log");
    assert!(log.iter().any(|entry| entry.action == format!("migrate_1_to_{CURRENT}")));
    drop(store);
    assert_eq!(schema_of(&path), CURRENT);
    assert_eq!(fs::read(&backup).expect("a file"), b"an older backup");
    let second = folder.path().join("store.backup-v1-2");
    assert_eq!(schema_of(&second), 1);
    // The backup is a store like the one that it was made of.
    let again = Store::open(&second).expect("a migrated backup");
    assert_eq!(again.reading_state(ReadingId(2)).expect("a state"), state);
    let left: Vec<_> = fs::read_dir(folder.path()).expect("a folder").collect();
    assert_eq!(left.len(), 6, "stores of two open connections and backups: {left:?}");
}

#[test]
fn a_store_of_schema_one_gets_accounts_grants_and_sessions() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("store");
    write_v1(&path, 1);
    let mut store = Store::open(&path).expect("a migrated store");
    assert_eq!(store.accounts().expect("accounts"), []);
    let account = Account { name: name("lead"), role: Role::Admin, enabled: true };
    let password = PasswordHash::new("a long enough sentence").expect("a password");
    store.add_account(&account, &password, &by("old", 0)).expect("an account");
    store.grant(&name("S-1"), &name("lead"), Role::Reader, &by("old", 0)).expect("a grant");
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn an_old_store_that_was_tampered_with_is_not_sealed_by_a_migration() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("store");
    write_v1(&path, 2);
    let raw = Connection::open(&path).expect("a database");
    raw.execute("UPDATE readings SET observer = 'B' WHERE id = 1", []).expect("an edit");
    drop(raw);
    let refused = Store::open(&path);
    assert!(
        matches!(refused, Err(StoreError::MigrationRefused { schema: 1, findings: 1 })),
        "{refused:?}"
    );
    assert_eq!(schema_of(&path), 1);
}

#[test]
fn a_store_of_a_newer_program_is_refused_and_not_changed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("store");
    drop(crate::session::create(&path));
    let raw = Connection::open(&path).expect("a database");
    let newer = CURRENT + 1;
    raw.execute_batch(&format!("PRAGMA user_version = {newer}; PRAGMA journal_mode = DELETE"))
        .expect("a newer schema");
    drop(raw);
    let before = fs::read(&path).expect("bytes");
    for refused in [Store::open(&path), Store::view(&path)] {
        let refused = refused.expect_err("newer");
        assert!(
            matches!(refused, StoreError::NewerSchema { found, supported: CURRENT } if found == newer),
            "{refused:?}"
        );
    }
    assert!(fs::read(&path).expect("bytes") == before);
}

#[test]
#[ignore = "runs as a child of the migration test"]
fn child_migration() {
    let path = std::env::var(CHILD).expect("the path of a store");
    let store = Store::open(Path::new(&path)).expect("a migrated store");
    assert_eq!(store.studies().expect("studies").len(), 1);
}

#[test]
fn a_migration_killed_at_any_time_leaves_the_old_store_or_the_new_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let original = folder.path().join("original");
    write_v1(&original, 80);
    let start = |path: &Path| {
        Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "migration::child_migration", "--ignored", "--nocapture"])
            .env(CHILD, path)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a child")
    };
    let whole = folder.path().join("whole");
    fs::copy(&original, &whole).expect("a copy");
    let begun = Instant::now();
    assert!(start(&whole).wait().expect("an end").success());
    let duration = begun.elapsed();
    let (mut old, mut new) = (0, 0);
    let kills = 20;
    for kill in 0..kills {
        let path = folder.path().join(format!("store-{kill}"));
        fs::copy(&original, &path).expect("a copy");
        let mut child = start(&path);
        let share = f64::from(kill) / f64::from(kills - 1);
        std::thread::sleep(duration.mul_f64(share).max(Duration::from_millis(1)));
        let _ = child.kill();
        child.wait().expect("an end");
        match schema_of(&path) {
            1 => old += 1,
            CURRENT => new += 1,
            other => panic!("schema {other}"),
        }
        let store = Store::open(&path).expect("a store, migrated now at the latest");
        assert!(store.verify(None).expect("verifiable").is_clean(), "kill {kill}");
        assert_eq!(store.readings(&name("S-1")).expect("readings").len(), 80);
        let refused = store.reading_state(ReadingId(81));
        assert!(matches!(refused, Err(StoreError::Unknown { .. })), "{refused:?}");
    }
    println!("killed within {duration:?}: {old} old, {new} new");
    assert!(old > 0);
}

#[test]
fn an_event_of_schema_one_reads_as_it_was_written() {
    let json = r#"{"kind":"place_corner","level":"Th12","corner":"superior_left","column_px":1,"row_px":2.5}"#;
    let event: Event = serde_json::from_str(json).expect("an event");
    assert_eq!(event, crate::session::place(Level::T12, Corner::SuperiorLeft, 1.0, 2.5));
    let wrong = json.replace("column_px", "column");
    assert!(serde_json::from_str::<Event>(&wrong).is_err(), "an unknown key");
}
