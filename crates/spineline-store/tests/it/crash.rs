//! Processes killed at every write, and truncated write-ahead logs.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use spineline_store::Store;

use crate::session::{self, STEPS, create, fingerprint, folder, reference};

const STORE: &str = "SPINELINE_TEST_SESSION_STORE";
const MAX_FILE: &str = "SPINELINE_TEST_LARGEST_FILE_BYTES";

/// Not a test: the session that the tests below start as a process and kill. It takes one step per line of input.
#[test]
#[ignore = "runs as a child of the crash tests"]
fn child_session() {
    let path = std::env::var(STORE).expect("the path of a store");
    #[cfg(unix)]
    if let Ok(bytes) = std::env::var(MAX_FILE) {
        let bytes = bytes.parse().expect("a number");
        rlimit::setrlimit(rlimit::Resource::CORE, 0, 0).expect("a limit");
        rlimit::setrlimit(rlimit::Resource::FSIZE, bytes, bytes).expect("a limit");
    }
    let mut store = Store::open(Path::new(&path)).expect("a store");
    let mut lines = std::io::stdin().lines();
    for step in 0..STEPS {
        if lines.next().is_none() {
            break;
        }
        session::run(&mut store, step).expect("a step");
        println!("acknowledged {step}");
    }
    assert_eq!(session::fingerprint(&store).lines().count(), 7, "the session ends as scripted");
}

fn start(path: &Path, largest_file_bytes: Option<u64>) -> Child {
    let mut command = Command::new(std::env::current_exe().expect("this program"));
    command.args(["--exact", "crash::child_session", "--ignored", "--nocapture"]);
    command.env(STORE, path).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    if let Some(bytes) = largest_file_bytes {
        command.env(MAX_FILE, bytes.to_string());
    }
    command.spawn().expect("a child")
}

fn allow(child: &mut Child, steps: usize) {
    let stdin = child.stdin.as_mut().expect("piped");
    // A child that ended at once has closed its end of the pipe.
    let _ = stdin.write_all("go\n".repeat(steps).as_bytes()).and_then(|()| stdin.flush());
}

/// Reads up to `wanted` acknowledgements.
fn acknowledgements(output: &mut impl BufRead, wanted: usize) -> usize {
    let (mut seen, mut line) = (0, String::new());
    while seen < wanted && output.read_line(&mut line).expect("lines") > 0 {
        seen += usize::from(line.contains("acknowledged"));
        line.clear();
    }
    seen
}

/// The number of steps in a store: the acknowledged ones, or one more.
fn steps_kept(path: &Path, reference: &[String], acknowledged: usize, what: &str) -> usize {
    let store = Store::open(path).expect("a store that opens after a crash");
    let verification = store.verify(None).expect("verifiable");
    assert!(verification.is_clean(), "{what}: {verification:?}");
    let print = fingerprint(&store);
    let kept = reference.iter().position(|known| *known == print);
    let kept = kept.unwrap_or_else(|| panic!("{what}: a state of no step:\n{print}"));
    let allowed = acknowledged..=acknowledged + 1;
    assert!(allowed.contains(&kept), "{what}: {acknowledged} acknowledged, {kept} kept");
    kept
}

#[test]
fn a_kill_after_any_acknowledgement_keeps_exactly_the_acknowledged_changes() {
    let folder = folder();
    let reference = reference(&folder.path().join("reference"));
    for steps in 0..=STEPS {
        let path = folder.path().join(format!("store-{steps}"));
        drop(create(&path));
        let mut child = start(&path, None);
        allow(&mut child, steps);
        let mut output = BufReader::new(child.stdout.take().expect("piped"));
        let seen = acknowledgements(&mut output, steps);
        child.kill().expect("a living child");
        child.wait().expect("a dead child");
        assert_eq!(seen, steps);
        let kept = steps_kept(&path, &reference, seen, &format!("killed after {steps}"));
        assert_eq!(kept, steps, "it was waiting, and wrote more");
    }
}

#[test]
fn a_kill_during_a_write_loses_unacknowledged_changes_only() {
    let folder = folder();
    let reference = reference(&folder.path().join("reference"));
    let mut in_flight = 0;
    for steps in 0..STEPS {
        let path = folder.path().join(format!("store-{steps}"));
        drop(create(&path));
        let mut child = start(&path, None);
        let mut output = BufReader::new(child.stdout.take().expect("piped"));
        allow(&mut child, steps);
        let seen = acknowledgements(&mut output, steps);
        assert_eq!(seen, steps);
        // One more step, and a kill during it.
        allow(&mut child, 1);
        std::thread::sleep(Duration::from_micros(97 * (steps as u64 % 13)));
        child.kill().expect("a living child");
        child.wait().expect("a dead child");
        let later = acknowledgements(&mut output, usize::MAX);
        let kept = steps_kept(&path, &reference, seen + later, &format!("killed in {steps}"));
        in_flight += usize::from(kept == steps);
    }
    assert!(in_flight > 1, "{in_flight} of {STEPS} steps were cut off");
    println!("{in_flight} of {STEPS} steps were cut off");
}

/// The kernel ends a process that writes beyond the limit of file size, during a write and before the commit.
#[test]
#[cfg(unix)]
fn a_crash_at_any_byte_of_the_write_ahead_log_keeps_acknowledged_changes() {
    use std::os::unix::process::ExitStatusExt;
    const KILLED_BY_SIZE: i32 = 25;
    let folder = folder();
    let reference = reference(&folder.path().join("reference"));
    let mut stopped_at = std::collections::BTreeSet::new();
    // The index beside the log has 32 KiB; whoever may write less cannot start.
    for largest_bytes in (33_000_u64..).step_by(14_983) {
        let path = folder.path().join(format!("store-{largest_bytes}"));
        drop(create(&path));
        let mut child = start(&path, Some(largest_bytes));
        allow(&mut child, STEPS);
        let mut output = BufReader::new(child.stdout.take().expect("piped"));
        let seen = acknowledgements(&mut output, usize::MAX);
        let status = child.wait().expect("a dead child");
        if status.success() {
            break;
        }
        assert_eq!(status.signal(), Some(KILLED_BY_SIZE), "{largest_bytes} bytes: {status}");
        let what = format!("at most {largest_bytes} bytes");
        stopped_at.insert(steps_kept(&path, &reference, seen, &what));
    }
    assert!(stopped_at.len() > STEPS / 2, "died only after {stopped_at:?}");
}

#[test]
fn a_truncated_write_ahead_log_gives_an_acknowledged_state() {
    let folder = folder();
    let reference = reference(&folder.path().join("reference"));
    let path = folder.path().join("store");
    drop(create(&path));
    // A killed process leaves its log behind.
    let mut child = start(&path, None);
    allow(&mut child, STEPS - 1);
    let mut output = BufReader::new(child.stdout.take().expect("piped"));
    assert_eq!(acknowledgements(&mut output, STEPS - 1), STEPS - 1);
    child.kill().expect("a living child");
    child.wait().expect("a dead child");
    let log = fs::read(folder.path().join("store-wal")).expect("a log");
    assert!(log.len() > 100_000, "{} bytes", log.len());
    let (cut, cut_log) = (folder.path().join("cut"), folder.path().join("cut-wal"));
    let mut last = 0;
    for bytes in (0..=log.len()).step_by(512).chain([log.len()]) {
        fs::copy(&path, &cut).expect("a copy");
        // Each cut is a separate crash, without the later heads.
        let _ = fs::remove_file(folder.path().join("cut-head"));
        fs::write(&cut_log, &log[..bytes]).expect("a log");
        // A view replays the log without writing it into the file.
        let print = fingerprint(&Store::view(&cut).expect("a store"));
        let kept = reference.iter().position(|known| *known == print);
        let kept = kept.unwrap_or_else(|| panic!("{bytes} bytes: a state of no step"));
        assert!(kept >= last, "{bytes} bytes: {kept} steps after {last}");
        if kept > last || bytes == 0 {
            let store = Store::open(&cut).expect("a store");
            assert_eq!(fingerprint(&store), print, "{bytes} bytes");
            assert!(store.verify(None).expect("verifiable").is_clean(), "{bytes} bytes");
        }
        last = kept;
    }
    assert_eq!(last, STEPS - 1);
    // Without a log.
    fs::copy(&path, &cut).expect("a copy");
    let _ = fs::remove_file(&cut_log);
    assert_eq!(fingerprint(&Store::open(&cut).expect("a store")), reference[0]);
    let mut rest = String::new();
    output.read_to_string(&mut rest).expect("nothing more");
}
