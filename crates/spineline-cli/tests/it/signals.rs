//! Ctrl-C and SIGTERM at any moment: the exit code, what is said, and that files are whole or absent.
//!
//! No test relies on what a command has done by a certain time: whatever it was, the rule holds.
#![cfg(unix)]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use crate::program::{CASE, Here, folder, with_phantom, with_phantoms};

/// Moments after the start.
const MOMENTS_MS: [u64; 4] = [0, 30, 300, 1500];

struct Ended {
    /// `None`: the signal came before the program could catch it.
    code: Option<i32>,
    error: String,
}

fn start(here: &Here, arguments: &[&str]) -> Child {
    here.process()
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

fn send(child: &Child, signal: &str) {
    let kill = format!("kill -{signal} {}", child.id());
    let sent = Command::new("sh").args(["-c", &kill]).status().expect("a shell");
    assert!(sent.success(), "{kill}");
}

/// A command that gets a signal so long after its start.
fn signalled(here: &Here, arguments: &[&str], signal: &str, after_ms: u64) -> Ended {
    let child = start(here, arguments);
    sleep(Duration::from_millis(after_ms));
    send(&child, signal);
    let output = child.wait_with_output().expect("an end");
    let error = String::from_utf8(output.stderr).expect("UTF-8");
    Ended { code: output.status.code(), error }
}

/// All files below a folder.
fn files(here: &Here) -> Vec<PathBuf> {
    let all = walkdir::WalkDir::new(here.folder()).into_iter().filter_map(Result::ok);
    all.filter(|entry| entry.file_type().is_file()).map(walkdir::DirEntry::into_path).collect()
}

fn assert_nothing_is_half_written(here: &Here) {
    for path in files(here) {
        let name = path.display().to_string();
        assert!(!name.contains(".part"), "{name}");
        if name.ends_with(".json") {
            let text = fs::read_to_string(&path).expect("a file");
            serde_json::from_str::<Value>(&text).expect(&name);
        }
    }
}

#[test]
fn commands_without_partial_results_write_nothing() {
    for arguments in [
        &["noise-study", "--out", "out", "--phantoms", "60"][..],
        &["reproduce", "--out", "out"],
        &["phantom", "--films", "--out", "out"],
    ] {
        for (moment, signal) in MOMENTS_MS.into_iter().zip(["INT", "TERM"].into_iter().cycle()) {
            let here = folder();
            let Ended { code, error } = signalled(&here, arguments, signal, moment);
            let at = format!("{arguments:?} {signal} after {moment} ms: {code:?} {error}");
            if code == Some(0) {
                // It was faster, or wrote already.
                assert_nothing_is_half_written(&here);
                continue;
            }
            assert!(matches!(code, None | Some(130)), "{at}");
            assert!(code.is_none() || error.contains("interrupted before a result"), "{at}");
            assert!(files(&here).is_empty(), "{at}");
        }
    }
}

/// More replicates than any test waits for.
const REPLICATES: [&str; 4] = ["--replicates", "1000000", "--seed", "1"];

/// A command with replicates on a phantom, as [`cut_short_on`].
fn cut_short(arguments: &[&str], output: &str, signal: &str) -> (Here, String, u64) {
    cut_short_on(|| with_phantom(&[]), arguments, output, signal)
}

/// A command with replicates that gets a signal later and later, until some replicates count.
fn cut_short_on(
    cases: impl Fn() -> Here,
    arguments: &[&str],
    output: &str,
    signal: &str,
) -> (Here, String, u64) {
    let arguments = [arguments, &REPLICATES].concat();
    let mut moment = 0;
    loop {
        let here = cases();
        let Ended { code, error } = signalled(&here, &arguments, signal, moment);
        assert_nothing_is_half_written(&here);
        let at = format!("{arguments:?} after {moment} ms: {code:?} {error}");
        if code == Some(4) {
            let words: Vec<&str> = error.split_whitespace().collect();
            let of = words.windows(3).find(|next| next[1..] == ["of", "1000000"]).expect(&at);
            let counted = of[0].parse().expect(&at);
            assert!(error.contains("replicates finished, which count") && counted > 0, "{at}");
            return (here, error, counted);
        }
        assert!(matches!(code, None | Some(130)), "{at}");
        assert!(!here.path(output).exists(), "{at}");
        moment = 2 * moment + 200;
    }
}

#[test]
fn an_analysis_says_how_many_replicates_count() {
    for signal in ["INT", "TERM"] {
        let arguments = ["analyze", CASE, "--json", "a.json"];
        let (here, _, counted) = cut_short(&arguments, "a.json", signal);
        let file = here.json("a.json");
        assert_eq!(file["uncertainty"]["done"], counted);
        assert_eq!(file["uncertainty"]["replicates"], 1_000_000);
        let text = format!("interrupted: {counted} of 1000000 replicates finished, which count");
        let warnings = file["warnings"].as_array().expect("a list");
        let is_it = |one: &&Value| one["code"] == "replicates_interrupted";
        assert_eq!(warnings.iter().find(is_it).expect("a warning")["message"], text);
        let (_, error, code) = here.run(&["rerun", "a.json"]);
        assert!(code == 3 && error.contains(&format!("after {counted} of 1000000")), "{error}");
    }
}

#[test]
fn a_cohort_names_the_cases_that_were_not_begun() {
    let arguments = ["analyze", "cases", "--json", "a.json", "--cohort", "c.json"];
    let three = || with_phantoms("rod", &["1", "2", "3"]);
    let (here, error, counted) = cut_short_on(three, &arguments, "c.json", "INT");
    assert!(error.contains("interrupted: 2 cases not begun; analyse them again"), "{error}");
    let refused = here.json("c.json")["refused"].clone();
    let steps: Vec<&Value> =
        refused.as_array().expect("cases").iter().map(|one| &one["step"]).collect();
    assert_eq!(steps, ["interruption", "interruption"], "{refused}");
    let all = here.json("a.json");
    let all = all.as_array().expect("a list");
    assert_eq!(all.len(), 3);
    assert_eq!(all[0]["uncertainty"]["done"], counted);
    assert!(all[1..].iter().all(|one| one.get("uncertainty").is_none()));
}

#[test]
fn a_report_says_how_many_replicates_count() {
    let arguments = ["report", CASE, "--out", "report.html"];
    let (here, ..) = cut_short(&arguments, "report.html", "INT");
    let page = here.text("report.html");
    assert!(page.contains("requested were 1000000 replicates"));
}

#[test]
fn a_repeated_analysis_compares_nothing_that_was_cut_short() {
    let here = with_phantom(&[]);
    let whole = ["analyze", CASE, "--json", "a.json", "--replicates", "2", "--seed", "1"];
    here.done(&whole);
    here.change("a.json", |file| file["provenance"]["replicates"]["count"] = 1_000_000.into());
    for moment in MOMENTS_MS {
        let rerun = ["rerun", "a.json", "--json", "again.json"];
        let Ended { code, error } = signalled(&here, &rerun, "INT", moment);
        assert!(matches!(code, None | Some(130)), "{code:?} {error}");
        assert!(!here.path("again.json").exists());
    }
}

#[test]
fn a_simulation_leaves_whole_files_or_none() {
    let here = with_phantom(&[]);
    here.done(&["analyze", CASE, "--model", "m.json"]);
    for moment in [0, 20, 60, 120, 250] {
        let arguments =
            ["simulate", "m.json", "--push", "left", "--force", "50", "--json", "s.json"];
        let Ended { code, error } = signalled(&here, &arguments, "INT", moment);
        assert!(matches!(code, None | Some(0 | 4 | 130)), "{code:?} {error}");
        assert_nothing_is_half_written(&here);
        let written = fs::remove_file(here.path("s.json")).is_ok();
        assert_eq!(written, matches!(code, Some(0 | 4)), "{code:?} {error}");
    }
}

#[test]
fn a_second_signal_ends_the_program_at_once() {
    let here = with_phantom(&[]);
    let mut child = start(&here, &[&["analyze", CASE], &REPLICATES[..]].concat());
    let mut lines = BufReader::new(child.stderr.take().expect("its messages")).lines();
    // Until it is in the work that stops by itself, the first one ends it.
    sleep(Duration::from_millis(2000));
    send(&child, "INT");
    let Some(line) = lines.next() else {
        // The program had not begun to catch signals.
        assert_eq!(child.wait().expect("an end").code(), None);
        return;
    };
    let line = line.expect("text");
    send(&child, "INT");
    let code = child.wait().expect("an end").code();
    let expected = if line.starts_with("stopping") { &[130, 4][..] } else { &[130] };
    assert!(code.is_some_and(|code| expected.contains(&code)), "{code:?} {line}");
}

#[test]
fn a_signal_is_the_ordinary_end_of_the_server() {
    for signal in ["INT", "TERM"] {
        let here = folder();
        let mut child = start(&here, &["serve", "s.spineline", "--port", "0"]);
        let mut output = BufReader::new(child.stdout.take().expect("its output"));
        output.read_line(&mut String::new()).expect("an address");
        send(&child, signal);
        assert_eq!(child.wait().expect("an end").code(), Some(0), "{signal}");
        here.done(&["study", "verify", "s.spineline"]);
    }
}
