//! Logs of another store, and damaged logs: the error names them, and neither they nor the store are changed.

use std::fs;
use std::path::{Path, PathBuf};

use rusqlite::Connection;
use spineline_store::{Finding, Store, StoreError, Study};

use crate::session::{STEPS, by, create, create_after, fingerprint, folder, name, run, run_steps};

fn beside(path: &Path, end: &str) -> PathBuf {
    PathBuf::from(format!("{}{end}", path.display()))
}

/// The files of an open store as a kill would leave them, under another name.
fn killed(store: &Path, copy: &Path) {
    for end in ["", "-wal", "-head"] {
        fs::copy(beside(store, end), beside(copy, end)).expect("a copy");
    }
}

/// Every way to open it refuses and changes neither the file nor what lies beside it.
fn assert_refused(path: &Path, end: &str) {
    let files = || ["", end].map(|end| fs::read(beside(path, end)).expect("a file"));
    let before = files();
    let backup = beside(path, "-copy");
    let refusals = [
        Store::open(path).map(drop),
        Store::view(path).map(drop),
        Store::view(path).and_then(|store| store.backup_to(&backup)).map(drop),
        Store::open(path).map(drop),
    ];
    for refused in refusals {
        let Err(StoreError::UnfittingLog { log }) = refused else { panic!("{refused:?}") };
        assert!(log.to_string_lossy().ends_with(end), "{log:?}");
    }
    assert!(files() == before, "a refused open changed a file");
    assert!(!backup.exists());
}

#[test]
fn a_log_of_another_store_destroys_nothing() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mut other = Store::create(&at("other"), &by("lead", 1)).expect("another store");
    let study = |number: usize| Study::new(name(&format!("T-{number}")), None, true);
    for steps in [0, 1, 4, STEPS] {
        let store = create_after(&at("store"), steps);
        let sound = fingerprint(&store);
        drop(store);
        for number in 0..3 {
            let study = study(10 * steps + number);
            other.add_study(&study, &by("lead", 500)).expect("a study");
            fs::copy(at("other-wal"), at("store-wal")).expect("a log");
            assert_refused(&at("store"), "-wal");
        }
        // Only the log is at fault.
        fs::rename(at("store-wal"), at("moved")).expect("moved");
        assert_eq!(fingerprint(&Store::open(&at("store")).expect("a store")), sound);
        fs::remove_file(at("store")).expect("no store");
    }
}

#[test]
fn a_backup_in_the_place_of_a_killed_store_does_not_become_the_newer_store() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for begun in [1, 5, 8, 20] {
        let mut store = create_after(&at("store"), begun);
        assert!(store.backup_to(&at("backup")).expect("a backup").is_clean());
        let in_backup = fingerprint(&store);
        for step in begun..STEPS {
            run_steps(&mut store, step..step + 1);
            killed(&at("store"), &at("killed"));
            fs::copy(at("backup"), at("killed")).expect("the usual advice");
            assert_refused(&at("killed"), "-wal");
            // Also without the heads beside it.
            fs::remove_file(at("killed-head")).expect("removed");
            assert_refused(&at("killed"), "-wal");
        }
        fs::remove_file(at("killed-wal")).expect("moved");
        assert_eq!(fingerprint(&Store::open(&at("killed")).expect("a store")), in_backup);
        drop(store);
        for name in ["store", "backup"] {
            fs::remove_file(at(name)).expect("removed");
        }
    }
}

#[test]
fn an_earlier_copy_in_the_place_of_a_killed_store_does_not_become_the_newer_store() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    drop(create_after(&at("store"), 6));
    fs::copy(at("store"), at("copy")).expect("a copy of a closed store");
    let mut store = Store::open(&at("store")).expect("a store");
    run_steps(&mut store, 6..8);
    drop(store);
    let mut store = Store::open(&at("store")).expect("a store");
    run_steps(&mut store, 8..20);
    killed(&at("store"), &at("killed"));
    fs::copy(at("copy"), at("killed")).expect("a copy");
    assert_refused(&at("killed"), "-wal");
}

#[test]
fn a_damaged_log_is_kept_unless_only_its_last_change_is_unreadable() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mut store = create_after(&at("store"), STEPS - 1);
    let before_last = fingerprint(&store);
    run_steps(&mut store, STEPS - 1..STEPS);
    killed(&at("store"), &at("killed"));
    let (main, log) =
        (fs::read(at("killed")).expect("bytes"), fs::read(at("killed-wal")).expect("bytes"));
    let (mut refused, mut last) = (0, 0);
    let places = (0..48).step_by(5).chain((32..log.len()).step_by(log.len() / 60));
    for place in places {
        fs::write(at("killed"), &main).expect("a store");
        let mut damaged = log.clone();
        damaged[place] ^= 0x10;
        fs::write(at("killed-wal"), &damaged).expect("a log");
        // The heads beside it lack even the last change.
        assert_refused(&at("killed"), "-wal");
        fs::rename(at("killed-head"), at("head")).expect("moved");
        match Store::open(&at("killed")) {
            Ok(store) => {
                assert_eq!(fingerprint(&store), before_last, "byte {place}");
                last += 1;
            }
            Err(_) => {
                assert_refused(&at("killed"), "-wal");
                refused += 1;
            }
        }
        let _ = fs::remove_file(at("killed-head"));
        fs::rename(at("head"), at("killed-head")).expect("moved");
    }
    assert!(refused > 5 * last && refused > 40, "{refused} refused, {last} opened");
    fs::write(at("killed"), &main).expect("a store");
    fs::write(at("killed-wal"), vec![0xA5; 40_000]).expect("a log");
    assert_refused(&at("killed"), "-wal");
}

#[test]
fn a_journal_of_another_program_is_not_written_into_the_store() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let other = Connection::open(at("other")).expect("a database");
    other
        .execute_batch(
            "PRAGMA cache_size = 1; CREATE TABLE a (b); INSERT INTO a VALUES (randomblob(90000));
            BEGIN; UPDATE a SET b = randomblob(90000)",
        )
        .expect("a change under way");
    drop(create(&at("store")));
    fs::copy(at("other-journal"), at("store-journal")).expect("a journal");
    assert_refused(&at("store"), "-journal");
}

#[test]
fn a_new_store_does_not_destroy_the_log_of_one_that_is_missing() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let store = create_after(&at("store"), 10);
    killed(&at("store"), &at("killed"));
    let log = fs::read(at("killed-wal")).expect("a log");
    for content in [None, Some("")] {
        fs::remove_file(at("killed")).expect("removed");
        if let Some(content) = content {
            fs::write(at("killed"), content).expect("a file");
        }
        refused!(Store::create(&at("killed"), &by("lead", 0)), UnfittingLog { .. });
        assert!(store.backup_to(&at("killed")).is_err());
        refused!(Store::open(&at("killed")), NotFound { .. } | StoreError::Damaged { .. });
        assert!(fs::read(at("killed-wal")).expect("a log") == log);
        fs::write(at("killed"), "").expect("a file");
    }
}

#[test]
fn a_damaged_store_is_called_damaged() {
    let folder = folder();
    let path = folder.path().join("store");
    drop(create_after(&path, STEPS));
    let sound = fs::read(&path).expect("bytes");
    let parts = [(0, 16), (0, 100), (16, 24), (68, 72), (100, 4096), (0, 4096), (0, sound.len())];
    for (from, to) in parts {
        let mut damaged = sound.clone();
        damaged[from..to].fill(0);
        fs::write(&path, &damaged).expect("a file");
        for opened in [Store::open(&path), Store::view(&path)] {
            assert!(matches!(opened, Err(StoreError::Damaged { .. })), "{from}..{to}: {opened:?}");
        }
        assert!(fs::read(&path).expect("bytes") == damaged);
    }
}

#[test]
fn a_store_that_two_versions_were_mixed_into_is_not_opened_for_writing() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mut store = create_after(&at("store"), STEPS);
    assert!(store.backup_to(&at("backup")).expect("a backup").is_clean());
    for number in 0..400 {
        let study = Study::new(name(&format!("T-{number}")), None, true);
        store.add_study(&study, &by("lead", 500)).expect("a study");
    }
    killed(&at("store"), &at("mixed"));
    fs::copy(at("backup"), at("mixed")).expect("a copy");
    assert_refused(&at("mixed"), "-wal");
    // Another program of SQLite takes the log for the store's.
    fs::remove_file(at("mixed-head")).expect("removed");
    let raw = Connection::open(at("mixed")).expect("a database");
    let _ = raw.query_row("SELECT count(*) FROM studies", [], |_| Ok(()));
    drop(raw);
    refused!(Store::open(&at("mixed")), Damaged { .. });
    let found = Store::view(&at("mixed")).and_then(|store| store.verify(None));
    assert!(!found.is_ok_and(|found| found.is_clean()));
}

#[test]
fn a_lost_log_is_missed_and_the_audit_log_says_so() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let store = create_after(&at("store"), STEPS);
    let acknowledged = store.head().expect("a head").entries;
    killed(&at("store"), &at("killed"));
    fs::remove_file(at("killed-wal")).expect("removed");
    let went_back = Finding::WentBack { acknowledged };
    let findings = |store: Store| store.verify(None).expect("verifiable").findings;
    assert_eq!(
        findings(Store::view(&at("killed")).expect("a store")),
        std::slice::from_ref(&went_back)
    );
    // Opening the store does not change this.
    assert_eq!(findings(Store::open(&at("killed")).expect("a store")), [went_back]);
    let mut store = Store::open(&at("killed")).expect("a store");
    assert_eq!(store.lost_head().map(|head| head.entries), Some(acknowledged));
    run(&mut store, 0).expect("a step");
    assert_eq!(store.lost_head(), None);
    let log = store.audit_log().expect("a log");
    assert!(log.iter().any(|entry| entry.action == "store_went_back"), "{log:?}");
    assert_eq!(findings(store), []);
}

#[test]
fn after_seconds_of_rest_the_main_file_alone_holds_every_change() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let mut store = create(&at("store"));
    let alone = |store: &Store| {
        let copy = at("copy");
        fs::copy(at("store"), &copy).expect("a copy");
        let _ = fs::remove_file(at("copy-head"));
        fingerprint(&Store::view(&copy).expect("a store")) == fingerprint(store)
    };
    run_steps(&mut store, 0..12);
    assert!(!alone(&store));
    store.rest().expect("a first look");
    assert!(!alone(&store), "it is in use");
    store.rest().expect("a checkpoint");
    assert!(alone(&store));
    run_steps(&mut store, 12..STEPS);
    store.rest().expect("a look");
    store.rest().expect("a checkpoint");
    assert!(alone(&store));
    assert!(store.verify(None).expect("verifiable").is_clean());
}
