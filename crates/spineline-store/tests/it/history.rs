//! The audit log: edits, removals, moves and truncations are detected; a complete rewrite only with an external head.

use std::path::Path;

use rusqlite::Connection;
use sha2::{Digest, Sha256};
use spineline_store::{Finding, Hash, Store, Thumbnails};

use crate::session::{
    STEPS, create, create_after, folder, folder_with_new_store, folder_with_store, name, run,
    run_steps,
};

/// Edits tables like an attacker: removes the triggers and restores them.
fn attack(path: &Path, sql: &str) {
    let raw = Connection::open(path).expect("a database");
    let mut query = raw
        .prepare("SELECT name, sql FROM sqlite_schema WHERE type = 'trigger'")
        .expect("triggers");
    let triggers: Vec<(String, String)> = query
        .query_map([], |row| Ok((row.get(0)?, row.get(1)?)))
        .and_then(Iterator::collect)
        .expect("triggers");
    for (name, _) in &triggers {
        raw.execute_batch(&format!("DROP TRIGGER {name}")).expect("a drop");
    }
    raw.execute_batch(sql).expect("an attack");
    for (_, definition) in &triggers {
        raw.execute_batch(definition).expect("a trigger");
    }
}

fn findings_after(sql: &str) -> Vec<Finding> {
    let folder = folder();
    let path = folder.path().join("store");
    drop(create_after(&path, STEPS));
    attack(&path, sql);
    Store::view(&path).expect("a store").verify(None).expect("verifiable").findings
}

#[test]
fn an_undamaged_store_has_no_findings_and_one_entry_per_change() {
    let (_folder, store) = folder_with_store(STEPS);
    assert_eq!(findings_after("SELECT 1"), []);
    let log = store.audit_log().expect("a log");
    // One for the creation, one per step, two for the bytes of films, one for the clock that went back.
    assert_eq!(log.len(), 1 + STEPS + 2 + 1);
    assert_eq!(log.iter().filter(|entry| entry.action == "clock_went_back").count(), 1);
    assert!(log.iter().map(|entry| entry.sequence).eq(1..=log.len() as i64));
}

#[test]
fn a_click_changes_a_study_but_not_its_results() {
    let (_folder, mut store) = folder_with_new_store();
    let study = name("S-1");
    run_steps(&mut store, 0..2);
    for step in 2..STEPS {
        let before = (store.last_change(&study), store.last_result_change(&study));
        run(&mut store, step).expect("a step");
        let after = (store.last_change(&study), store.last_result_change(&study));
        let last = store.audit_log().expect("a log").pop().expect("an entry");
        let [before, after] = [before, after].map(|(change, settled)| {
            (change.expect("a change").sequence, settled.expect("a change").sequence)
        });
        assert_eq!(after.0, last.sequence, "{last:?}");
        let is_click = last.object.starts_with("event/") || last.object.starts_with("conflict/");
        assert_eq!(after.1, if is_click { before.1 } else { last.sequence }, "{last:?}");
    }
}

#[test]
fn thumbnails_are_stored_for_known_films_outside_of_the_log() {
    let (folder, mut store) = folder_with_store(STEPS);
    let path = folder.path().join("store");
    let content = store.films(&name("S-1")).expect("films")[0].content.clone();
    let head = store.head().expect("a head");
    assert_eq!(store.thumbnails(&content).expect("none"), None);
    let thumbnails = Thumbnails { plain: vec![1, 2], inverted: vec![3] };
    store.keep_thumbnails(&content, &thumbnails).expect("kept");
    refused!(store.keep_thumbnails(&Hash::of(b"no film"), &thumbnails), Unknown { .. });
    drop(store);
    let store = Store::open(&path).expect("a store");
    assert_eq!(store.thumbnails(&content).expect("kept"), Some(thumbnails));
    assert!(store.verify(Some(&head)).expect("verifiable").is_clean());
    assert_eq!(store.head().expect("a head"), head);
}

#[test]
fn the_hash_chain_follows_its_description() {
    let (_folder, store) = folder_with_store(STEPS);
    let mut previous = String::new();
    for entry in store.audit_log().expect("a log") {
        let json = format!(
            r#"{{"sequence":{},"time_ms":{},"actor":"{}","action":"{}","object":"{}","digest":"{}"}}"#,
            entry.sequence, entry.time_ms, entry.actor, entry.action, entry.object, entry.digest
        );
        let hash = Sha256::digest(previous + &json);
        previous = hash.iter().map(|byte| format!("{byte:02x}")).collect();
    }
    assert_eq!(store.head().expect("a head").hash.as_str(), previous);
}

#[test]
fn the_database_refuses_edits_of_append_only_tables() {
    let folder = folder();
    let path = folder.path().join("store");
    drop(create_after(&path, STEPS));
    let raw = Connection::open(&path).expect("a database");
    for sql in [
        "UPDATE events SET event = '{}'",
        "DELETE FROM events",
        "UPDATE audit SET actor = 'x'",
        "DELETE FROM audit",
        "UPDATE readings SET finished_ms = 1 WHERE id = 1",
        "DELETE FROM readings",
        "INSERT INTO events VALUES (99, 1, 99, 0, '{\"kind\":\"undo\"}')",
        "DELETE FROM conflicts",
    ] {
        assert!(raw.execute_batch(sql).is_err(), "{sql}");
    }
}

#[test]
fn an_edited_entry_is_detected() {
    let found = findings_after("UPDATE audit SET actor = 'somebody' WHERE sequence = 7");
    assert_eq!(found, [Finding::EntryChanged { sequence: 7 }]);
}

#[test]
fn a_removed_entry_is_detected() {
    let found = findings_after("DELETE FROM audit WHERE sequence = 7");
    assert!(found.contains(&Finding::EntryMissing { sequence: 7 }), "{found:?}");
    assert!(found.iter().any(|f| matches!(f, Finding::Length { .. })), "{found:?}");
}

#[test]
fn swapped_entries_are_detected() {
    let found = findings_after(
        "UPDATE audit SET sequence = -1 WHERE sequence = 9;
         UPDATE audit SET sequence = 9 WHERE sequence = 10;
         UPDATE audit SET sequence = 10 WHERE sequence = -1;",
    );
    for sequence in [9, 10] {
        assert!(found.contains(&Finding::EntryChanged { sequence }), "{found:?}");
    }
}

#[test]
fn a_truncated_log_is_detected() {
    let found = findings_after("DELETE FROM audit WHERE sequence > 20");
    assert!(found.contains(&Finding::HeadChanged), "{found:?}");
    let expected = (1 + STEPS + 3) as u64;
    assert!(found.contains(&Finding::Length { expected, found: 20 }), "{found:?}");
    assert!(found.iter().any(|f| matches!(f, Finding::RowUnknown { .. })), "{found:?}");
}

#[test]
fn edited_removed_and_inserted_rows_are_detected_in_every_table() {
    let object = |text: &str| text.to_owned();
    let found = findings_after(
        "UPDATE events SET event = replace(event, '400.25', '401.25') WHERE sequence = 1",
    );
    assert_eq!(found, [Finding::RowChanged { object: object("event/1") }]);
    let found = findings_after("DELETE FROM events WHERE sequence = 23");
    assert_eq!(found, [Finding::RowMissing { object: object("event/23") }]);
    let found = findings_after("INSERT INTO studies VALUES ('S-2', NULL, 0, 0, 0)");
    assert_eq!(found, [Finding::RowUnknown { object: object("study/S-2") }]);
    for (table, change, object) in [
        ("films", "posture = 'neutral'", "film/1"),
        ("readings", "observer = 'C'", "reading/1"),
        ("studies", "synthetic = 0", "study/S-1"),
        ("studies", "archived = 1", "study/S-1"),
        ("conflicts", "change = '{}'", "conflict/1"),
    ] {
        let found = findings_after(&format!("UPDATE {table} SET {change} WHERE rowid = 1"));
        assert_eq!(found, [Finding::RowChanged { object: object.to_owned() }], "{table}");
    }
}

#[test]
fn a_missing_trigger_is_detected() {
    let folder = folder();
    let path = folder.path().join("store");
    drop(create_after(&path, STEPS));
    let raw = Connection::open(&path).expect("a database");
    raw.execute_batch("DROP TRIGGER events_are_never_edited").expect("a drop");
    drop(raw);
    let found = Store::open(&path).expect("a store").verify(None).expect("verifiable").findings;
    let name = "trigger events_are_never_edited".to_owned();
    assert_eq!(found, [Finding::Definition { name }]);
}

#[test]
fn a_rewritten_log_is_detected_only_with_an_external_head() {
    let folder = folder();
    let (path, other) = (folder.path().join("store"), folder.path().join("other"));
    let mut store = create_after(&path, STEPS);
    let kept = store.head().expect("a head");
    assert!(store.verify(Some(&kept)).expect("verifiable").is_clean());
    // The log may grow.
    let study = spineline_store::Study::new(crate::session::name("S-9"), None, true);
    store.add_study(&study, &crate::session::by("lead", 900)).expect("a study");
    assert!(store.verify(Some(&kept)).expect("verifiable").is_clean());
    // Another valid log.
    let mut forged = create(&other);
    run_steps(&mut forged, 0..STEPS - 1);
    assert!(forged.verify(None).expect("verifiable").is_clean());
    let found = forged.verify(Some(&kept)).expect("verifiable").findings;
    assert_eq!(found, [Finding::Rewritten]);
}
