//! Processes killed at every step of a restoration: the store of that name is whole, and the next restoration succeeds. The
//! steps are private to the crate.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::restore::restore;
use crate::{Store, StoreError, Study, session};

const FOLDER: &str = "SPINELINE_TEST_RESTORE_FOLDER";
const STEP: &str = "SPINELINE_TEST_RESTORE_STEP";

/// Not a test: the restoration that the tests below start as a process, which kills itself at one step.
#[test]
#[ignore = "runs as a child of the tests of restoration"]
fn child_restoration() {
    let folder = PathBuf::from(std::env::var(FOLDER).expect("a folder"));
    let last: usize = std::env::var(STEP).ok().and_then(|step| step.parse().ok()).expect("a step");
    let mut step = 0;
    let restored = restore(&folder.join("backup"), &folder.join("store"), &mut |_| {
        if step == last {
            std::process::abort();
        }
        step += 1;
    });
    assert!(restored.expect("a restoration").verification.is_clean());
}

/// Starts a restoration that is killed at a step; returns whether it finished.
fn killed_at(step: usize, folder: &Path) -> bool {
    let mut command = Command::new(std::env::current_exe().expect("this program"));
    command.args(["--exact", "restore_killed::child_restoration", "--ignored"]);
    command.env(FOLDER, folder).env(STEP, step.to_string());
    command.output().expect("a child").status.success()
}

/// A store with acknowledged changes in its log, and an earlier backup.
fn prepare(folder: &Path) -> [String; 2] {
    let mut store = session::create_after(&folder.join("source"), 8);
    assert!(store.backup_to(&folder.join("backup")).expect("a backup").is_clean());
    let earlier = session::fingerprint(&store);
    session::run_steps(&mut store, 8..session::STEPS);
    for end in ["", "-wal", "-head"] {
        let from = folder.join(format!("source{end}"));
        fs::copy(from, folder.join(format!("store{end}"))).expect("a copy");
    }
    [session::fingerprint(&store), earlier]
}

fn kept(folder: &Path) -> Vec<PathBuf> {
    let files = fs::read_dir(folder).expect("a folder").map(|file| file.expect("a file").path());
    let mut kept: Vec<_> =
        files.filter(|file| file.to_string_lossy().contains(".replaced-")).collect();
    kept.sort();
    kept
}

#[test]
fn a_restoration_killed_at_any_step_leaves_the_earlier_store_or_the_restored_one() {
    let mut steps = 0;
    loop {
        let folder = session::folder();
        let states = prepare(folder.path());
        let path = folder.path().join("store");
        let went_through = killed_at(steps, folder.path());
        let store = Store::open(&path).expect("a store");
        let state = session::fingerprint(&store);
        let place = states.iter().position(|known| *known == state);
        let place = place.unwrap_or_else(|| panic!("step {steps}: neither store:\n{state}"));
        assert!(store.verify(None).expect("verifiable").is_clean(), "step {steps}");
        drop(store);
        assert!(!went_through || place == 1);
        let restored = Store::restore(&folder.path().join("backup"), &path).expect("room");
        assert!(restored.verification.is_clean());
        let store = Store::open(&path).expect("a store");
        assert_eq!(session::fingerprint(&store), states[1], "step {steps}");
        assert!(store.verify(None).expect("verifiable").is_clean(), "step {steps}");
        let names = fs::read_dir(folder.path()).expect("a folder");
        let parts = names.filter(|file| {
            file.as_ref().is_ok_and(|file| file.file_name().to_string_lossy().contains(".part"))
        });
        assert_eq!(parts.count(), 0, "step {steps}");
        let is_kept = |path: &PathBuf| {
            Store::view(path).is_ok_and(|store| session::fingerprint(&store) == states[0])
        };
        assert!(kept(folder.path()).iter().any(is_kept), "step {steps}: the earlier store is gone");
        if went_through {
            break;
        }
        steps += 1;
    }
    assert!(steps > 6, "only {steps} steps");
}

#[test]
fn a_store_beside_another_log_is_restored_at_any_kill_and_the_log_is_kept() {
    let mut steps = 0;
    loop {
        let folder = session::folder();
        let at = |name: &str| folder.path().join(name);
        let [_, earlier] = prepare(folder.path());
        fs::copy(at("backup"), at("store")).expect("the usual advice");
        let log = fs::read(at("store-wal")).expect("a log");
        let went_through = killed_at(steps, folder.path());
        let restored = Store::restore(&at("backup"), &at("store")).expect("room");
        assert!(restored.verification.is_clean());
        let store = Store::open(&at("store")).expect("a store");
        assert_eq!(session::fingerprint(&store), earlier, "step {steps}");
        let is_log = |path: &PathBuf| fs::read(path).is_ok_and(|bytes| bytes == log);
        assert!(kept(folder.path()).iter().any(is_log), "step {steps}: the log is gone");
        if went_through {
            break;
        }
        steps += 1;
    }
    assert!(steps > 6, "only {steps} steps");
}

#[test]
fn a_store_in_use_another_file_and_a_damaged_backup_change_nothing() {
    let (folder, store) = session::folder_with_new_store();
    let at = |name: &str| folder.path().join(name);
    assert!(store.backup_to(&at("backup")).expect("a backup").is_clean());
    let refused = Store::restore(&at("backup"), &at("store"));
    assert!(matches!(refused, Err(StoreError::Held)), "{refused:?}");
    let refused = Store::restore(&at("store"), &at("store"));
    assert!(matches!(refused, Err(StoreError::SameFile { .. })), "{refused:?}");
    drop(store);
    fs::write(at("notes"), "notes").expect("a file");
    let refused = Store::restore(&at("backup"), &at("notes"));
    assert!(matches!(refused, Err(StoreError::NotAStore { .. })), "{refused:?}");
    let raw = rusqlite::Connection::open(at("backup")).expect("a database");
    raw.execute_batch("UPDATE head SET last_ms = 0").expect("an edit");
    drop(raw);
    let before = fs::read(at("store")).expect("bytes");
    let restored = Store::restore(&at("backup"), &at("store")).expect("a verification");
    assert!(!restored.verification.is_clean() && restored.replaced.is_none());
    assert!(fs::read(at("store")).expect("bytes") == before);
    assert_eq!(fs::read(at("notes")).expect("bytes"), b"notes");
    let whole = fs::read(at("backup")).expect("bytes");
    for bytes in [0, 100, whole.len() / 4] {
        fs::write(at("cut"), &whole[..bytes]).expect("a file");
        let refused = Store::restore(&at("cut"), &at("store"));
        assert!(matches!(refused, Err(StoreError::Backup { .. })), "{bytes} bytes: {refused:?}");
    }
    assert!(fs::read(at("store")).expect("bytes") == before);
    assert_eq!(kept(folder.path()), Vec::<PathBuf>::new());
}

#[test]
fn a_missing_a_damaged_and_an_empty_store_are_restored() {
    let folder = session::folder();
    let at = |name: &str| folder.path().join(name);
    let mut store = session::create(&at("source"));
    let study = Study::new(session::name("S-9"), None, true);
    store.add_study(&study, &session::by("lead", 9)).expect("a study");
    assert!(store.backup_to(&at("backup")).expect("a backup").is_clean());
    let mut damaged = fs::read(at("backup")).expect("bytes");
    damaged[..200].fill(0);
    for content in [None, Some(&[][..]), Some(&damaged)] {
        if let Some(content) = content {
            fs::write(at("store"), content).expect("a file");
        }
        let restored = Store::restore(&at("backup"), &at("store")).expect("a restoration");
        let is_kept = |path: PathBuf| fs::read(path).ok();
        let expected = content.filter(|content| !content.is_empty()).map(<[u8]>::to_vec);
        assert_eq!(restored.replaced.and_then(is_kept), expected);
        let opened = Store::open(&at("store")).expect("a store");
        assert_eq!(session::fingerprint(&opened), session::fingerprint(&store));
        drop(opened);
        fs::remove_file(at("store")).expect("removed");
    }
}

#[test]
fn what_a_killed_backup_leaves_does_not_block_the_next_one() {
    let (folder, store) = session::folder_with_new_store();
    let at = |name: &str| folder.path().join(name);
    let whole = fs::read(at("store")).expect("bytes");
    for (number, left) in [&b""[..], b"half", &whole].into_iter().enumerate() {
        let (copy, part) = (at(&format!("copy-{number}")), at(&format!("copy-{number}.part")));
        fs::write(&copy, "").expect("a file");
        fs::write(&part, left).expect("a file");
        for end in ["-wal", "-journal", "-shm"] {
            fs::write(at(&format!("copy-{number}.part{end}")), left).expect("a file");
        }
        assert!(store.backup_to(&copy).expect("a backup").is_clean());
        assert!(!part.exists());
        let refused = store.backup_to(&copy);
        assert!(matches!(refused, Err(StoreError::AlreadyExists { .. })), "{refused:?}");
    }
}
