//! Other programs, read-only files and files of other formats.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use rusqlite::Connection;
use spineline_store::{Event, Signature, Store, StoreError};

use crate::session::{
    READING, STEPS, by, clicks, create_after, fingerprint, folder, folder_with_store, name, run,
    run_steps,
};

#[test]
fn a_store_written_by_another_program_is_busy_until_it_ends() {
    let (folder, mut store) = folder_with_store(5);
    let path = folder.path().join("store");
    store.set_busy_timeout(Duration::from_millis(200)).expect("a time");
    let other = Connection::open(&path).expect("a database");
    other.execute_batch("BEGIN IMMEDIATE").expect("a lock");
    let asked = Instant::now();
    refused!(store.record(READING, &clicks()[0], 0, &by("A", 10)), Busy);
    // It waits for the other one before it fails; the delay after that depends on the machine.
    assert!(asked.elapsed() >= Duration::from_millis(190), "{:?}", asked.elapsed());
    // Reading goes on.
    assert_eq!(store.reading_state(READING).expect("a state").revision, 0);
    assert!(store.verify(None).expect("verifiable").is_clean());
    other.execute_batch("ROLLBACK").expect("no lock");
    store.record(READING, &clicks()[0], 0, &by("A", 10)).expect("free again");
}

#[test]
fn two_connections_that_alternate_lose_no_change() {
    let folder = folder();
    let path = folder.path().join("store");
    let mut stores = [create_after(&path, 5), Store::open(&path).expect("the same store")];
    for (revision, event) in (0_u64..).zip(&clicks()) {
        let store = &mut stores[revision as usize % 2];
        store.record(READING, event, revision, &by("A", 10)).expect("an event");
    }
    assert_eq!(fingerprint(&stores[0]), fingerprint(&stores[1]));
    assert!(stores[1].verify(None).expect("verifiable").is_clean());
}

#[test]
fn a_change_that_waited_for_another_one_is_later_and_the_clock_did_not_go_back() {
    let (_folder, mut store) = folder_with_store(5);
    let waiting = Signature::now(name("A"));
    std::thread::sleep(Duration::from_millis(20));
    store.record(READING, &clicks()[0], 0, &Signature::now(name("A"))).expect("an event");
    store.record(READING, &clicks()[1], 1, &waiting).expect("an event");
    let log = store.audit_log().expect("a log");
    assert!(log.iter().all(|entry| entry.action != "clock_went_back"), "{log:?}");
    assert!(log.is_sorted_by_key(|entry| entry.time_ms), "{log:?}");
}

#[test]
fn of_concurrent_writers_one_succeeds_and_the_others_are_told() {
    let folder = folder();
    let path = folder.path().join("store");
    drop(create_after(&path, 5));
    let race = |thread: usize| {
        // Different events: a repeated one would be acknowledged again.
        let event = Event::Note { text: format!("thread {thread}") };
        let mut store = Store::open(&path).expect("a store");
        let (mut won, mut lost) = (0, 0);
        for revision in 0..20 {
            match store.record(READING, &event, revision, &by("A", 10)) {
                Ok(_) => won += 1,
                Err(StoreError::Conflict { .. }) => lost += 1,
                Err(other) => panic!("{other}"),
            }
        }
        (won, lost)
    };
    let outcomes: Vec<(usize, usize)> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..2).map(|i| scope.spawn(move || race(i))).collect();
        threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
    });
    let store = Store::open(&path).expect("a store");
    let won: usize = outcomes.iter().map(|outcome| outcome.0).sum();
    let lost: usize = outcomes.iter().map(|outcome| outcome.1).sum();
    assert_eq!(
        (won + lost, store.reading_state(READING).expect("a state").revision),
        (40, won as u64)
    );
    assert_eq!(store.conflicts_of_reading(READING, 0).expect("conflicts").len(), lost);
    assert!(store.verify(None).expect("verifiable").is_clean());
}

/// Makes a file unwritable for everyone, also for root where the file system can, and restores its rights.
struct WriteProtection<'a> {
    path: &'a Path,
}

impl<'a> WriteProtection<'a> {
    fn put_on(path: &'a Path) -> Option<Self> {
        let mut permissions = fs::metadata(path).expect("a file").permissions();
        permissions.set_readonly(true);
        fs::set_permissions(path, permissions).expect("permissions");
        let _ = Command::new("chattr").arg("+i").arg(path).output();
        let protection = Self { path };
        let writable = if path.is_dir() {
            fs::write(path.join("probe"), "").is_ok()
        } else {
            fs::OpenOptions::new().append(true).open(path).is_ok()
        };
        if writable {
            let _ = fs::remove_file(path.join("probe"));
            println!("skipped: nothing here keeps this user from writing {}", path.display());
            return None;
        }
        Some(protection)
    }
}

impl Drop for WriteProtection<'_> {
    fn drop(&mut self) {
        let _ = Command::new("chattr").arg("-i").arg(self.path).output();
        let mut permissions = fs::metadata(self.path).expect("a file").permissions();
        #[allow(
            clippy::permissions_set_readonly_false,
            reason = "a folder that is removed at once"
        )]
        permissions.set_readonly(false);
        fs::set_permissions(self.path, permissions).expect("permissions");
    }
}

#[test]
fn a_read_only_file_is_reported_and_not_changed() {
    let folder = folder();
    let path = folder.path().join("store");
    drop(create_after(&path, 5));
    let before = fs::read(&path).expect("bytes");
    let Some(protection) = WriteProtection::put_on(&path) else { return };
    refused!(Store::open(&path), ReadOnly);
    let mut store = Store::view(&path).expect("readable");
    assert_eq!(store.films(&name("S-1")).expect("films").len(), 2);
    assert!(store.verify(None).expect("verifiable").is_clean());
    refused!(store.record(READING, &clicks()[0], 0, &by("A", 10)), ReadOnly);
    drop((store, protection));
    assert!(fs::read(&path).expect("bytes") == before);
}

#[test]
fn a_read_only_folder_is_reported_and_a_backup_in_it_is_readable() {
    let folder = folder();
    let path = folder.path().join("store");
    let closed = folder.path().join("closed");
    fs::create_dir(&closed).expect("a folder");
    let copy = closed.join("copy");
    let store = create_after(&path, 5);
    assert!(store.backup_to(&copy).expect("a backup").is_clean());
    let expected = fingerprint(&store);
    let before = fs::read(&copy).expect("bytes");
    {
        let Some(_protection) = WriteProtection::put_on(&closed) else { return };
        let refused = Store::create(&closed.join("new"), &by("lead", 0));
        refused!(refused, CannotOpen | StoreError::ReadOnly);
        refused!(store.backup_to(&closed.join("new")), File { .. });
        refused!(Store::open(&copy), CannotOpen | StoreError::ReadOnly | StoreError::Disk { .. });
        assert_eq!(fingerprint(&Store::view(&copy).expect("readable")), expected);
    }
    assert!(fs::read(&copy).expect("bytes") == before);
}

#[test]
#[cfg(unix)]
fn a_store_that_another_file_replaced_is_reported_as_replaced_and_not_as_read_only() {
    let folder = folder();
    let [open, other] = ["open", "other"].map(|name| folder.path().join(name));
    let database = Connection::open(&open).expect("a database");
    database.execute_batch("CREATE TABLE a (b); INSERT INTO a VALUES (1)").expect("a table");
    fs::copy(&open, &other).expect("a copy");
    fs::rename(&other, &open).expect("the name of the first one");
    let refused = database.execute_batch("INSERT INTO a VALUES (2)").map_err(StoreError::from);
    refused!(refused, Replaced);
    let words = StoreError::Replaced;
    assert!(words.help().contains("start the server again"), "{words}: {}", words.help());
}

#[test]
fn a_read_only_view_does_not_change_the_store() {
    let folder = folder();
    let path = folder.path().join("store");
    drop(create_after(&path, 5));
    let before = fs::read(&path).expect("bytes");
    let mut view = Store::view(&path).expect("readable");
    refused!(run(&mut view, 5), ReadOnly);
    drop(view);
    assert!(fs::read(&path).expect("bytes") == before);
}

#[test]
fn other_files_are_refused_and_not_changed() {
    let folder = folder();
    let path = folder.path().join("file");
    let other = Connection::open(folder.path().join("database")).expect("a database");
    other.execute_batch("CREATE TABLE a (b); PRAGMA application_id = 7").expect("a table");
    drop(other);
    let database = fs::read(folder.path().join("database")).expect("bytes");
    for bytes in [&b""[..], b"{}", &[0; 100_000], &database] {
        fs::write(&path, bytes).expect("a file");
        let refused = Store::open(&path).expect_err("not a store");
        assert!(
            matches!(refused, StoreError::NotAStore { .. }),
            "{} bytes: {refused:?}",
            bytes.len()
        );
        assert!(fs::read(&path).expect("bytes") == bytes);
        if !bytes.is_empty() {
            refused!(Store::create(&path, &by("lead", 0)), AlreadyExists { .. });
            assert!(fs::read(&path).expect("bytes") == bytes);
        }
    }
    refused!(Store::open(&folder.path().join("missing")), NotFound { .. });
    refused!(Store::open(folder.path()), NotAStore { .. });
}

#[test]
fn a_backup_equals_the_store_and_never_replaces_a_file() {
    let folder = folder();
    let (path, copy) = (folder.path().join("store"), folder.path().join("copy"));
    let mut store = create_after(&path, 5);
    let verification = store.backup_to(&copy).expect("a backup");
    assert!(verification.is_clean());
    assert_eq!(verification.head, Some(store.head().expect("a head")));
    let before = fs::read(&copy).expect("bytes");
    refused!(store.backup_to(&copy), AlreadyExists { .. });
    run_steps(&mut store, 5..STEPS);
    assert!(fs::read(&copy).expect("bytes") == before);
    // The copy takes the same steps to the same history.
    let mut restored = Store::open(&copy).expect("a store");
    run_steps(&mut restored, 5..STEPS);
    assert_eq!(fingerprint(&restored), fingerprint(&store));
}
