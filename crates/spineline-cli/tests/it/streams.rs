//! Streams that are full or closed, outputs that cannot be written, and numbers that no computer holds: an exit code of the table,
//! never a panic.

use std::fs;
use std::process::{Command, Stdio};

use crate::program::{CASE, Here, folder, split, unwrapped, with_phantom};

/// Commands that say something on the standard error, and how they end.
const TALKATIVE: [(&[&str], i32); 6] = [
    (&["check", "missing.json"], 3),
    (&["analyze", CASE, CASE], 3),
    (&["analyze", "cases", "missing.json"], 3),
    (&["film", CASE], 3),
    (&["rerun", CASE], 3),
    (&["analyze", "--no-such-option"], 2),
];

#[test]
#[cfg(target_os = "linux")]
fn a_full_error_stream_changes_no_exit_code() {
    let here = with_phantom(&[]);
    for (arguments, expected) in TALKATIVE {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
        let status = here.process().args(arguments).stdout(Stdio::null()).stderr(full).status();
        assert_eq!(status.expect("it starts").code(), Some(expected), "{arguments:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_output_stream_is_said_and_has_its_code() {
    let here = with_phantom(&[]);
    for arguments in [
        &["--help"][..],
        &["stiffness"],
        &["schema", "case"],
        &["completions", "bash"],
        &["check", CASE],
        &["analyze", CASE, "--json", "-"],
        &["film", CASE, "--json"],
    ] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
        let output = here.process().args(arguments).stdout(full).output().expect("it starts");
        let error = unwrapped(&String::from_utf8_lossy(&output.stderr));
        assert_eq!(output.status.code(), Some(3), "{arguments:?} {error}");
        if arguments[0] != "film" {
            assert!(error.contains("standard output could not be written"), "{error}");
            assert!(error.contains("help: too little space"), "{error}");
        }
    }
}

#[test]
#[cfg(unix)]
fn closed_streams_change_no_exit_code() {
    let here = with_phantom(&[]);
    let program = assert_cmd::cargo::cargo_bin("spineline");
    for closed in ["2>&-", ">&- 2>&-", "<&- >&- 2>&-"] {
        for (arguments, expected) in TALKATIVE {
            let line = format!("exec \"$0\" \"$@\" {closed}");
            let mut shell = Command::new("sh");
            shell.args(["-c", &line]).arg(&program).args(arguments).current_dir(here.folder());
            let code = shell.status().expect("a shell").code();
            assert_eq!(code, Some(expected), "{arguments:?} {closed}");
        }
    }
}

#[test]
#[cfg(unix)]
fn a_reader_that_goes_away_is_not_an_error() {
    let here = with_phantom(&[]);
    let program = assert_cmd::cargo::cargo_bin("spineline");
    let mut shell = Command::new("sh");
    shell.args(["-c", "{ \"$0\" schema case; echo $? >&2; } | true"]).arg(&program);
    let output = shell.current_dir(here.folder()).output().expect("a shell");
    assert_eq!(String::from_utf8_lossy(&output.stderr).trim(), "0");
}

/// Numbers that JSON allows, or nearly, and that are not measurements.
const NUMBERS: [&str; 7] =
    ["1e400", "-1e400", "NaN", "1e308", "5e-324", "-0.0", "99999999999999999999"];

/// The text with the first number after a key replaced.
fn with_number(text: &str, key: &str, number: &str) -> String {
    let at = text.find(&format!("\"{key}\"")).unwrap_or_else(|| panic!("no key {key}"));
    let digit = |c: char| c.is_ascii_digit() || c == '-';
    let from = at + key.len() + 2 + text[at + key.len() + 2..].find(digit).expect("a number");
    let length = text[from..].find([',', '\n', ' ', ']', '}']).expect("an end");
    format!("{}{number}{}", &text[..from], &text[from + length..])
}

fn assert_ends_well(here: &Here, arguments: &[&str], what: &str) -> (i32, String) {
    let (_, error, code) = here.run(arguments);
    assert!([0, 3, 4].contains(&code), "{arguments:?} {what}: {code} {error}");
    assert!(!error.contains("a bug"), "{arguments:?} {what}: {error}");
    (code, error)
}

#[test]
fn a_number_beyond_all_numbers_is_bad_input_wherever_it_stands() {
    let here = with_phantom(&[]);
    here.done(&["analyze", CASE, "--json", "a.json", "--model", "m.json"]);
    let (case, analysis, model) = (here.text(CASE), here.text("a.json"), here.text("m.json"));
    let try_all = |text: &str, keys: &[&str], command: &[&str]| {
        for key in keys {
            for number in NUMBERS {
                here.write("hostile.json", with_number(text, key, number));
                let what = format!("{key} {number}");
                let (code, error) = assert_ends_well(&here, command, &what);
                if number.contains("400") || number == "NaN" {
                    assert_eq!(code, 3, "{what} {error}");
                    assert!(error.contains("hostile.json: line"), "{what} {error}");
                    assert!(!error.contains("phantom-rod"), "{what} {error}");
                }
            }
        }
    };
    try_all(&case, &["superior_left", "column_spacing_mm", "columns"], &["check", "hostile.json"]);
    // One that is computed with, and one that only the comparison reads.
    try_all(
        &analysis,
        &["superior_left", "rmse_mm", "lateral_nm_per_rad"],
        &["rerun", "hostile.json"],
    );
    let simulate = ["simulate", "hostile.json", "--push", "left", "--force", "5"];
    try_all(&model, &["centre_mm", "stiffness"], &simulate);
}

#[test]
fn json_nested_without_end_is_bad_input() {
    let here = with_phantom(&[]);
    let deep = format!("{}{}", "[".repeat(200_000), "]".repeat(200_000));
    let case = here.text(CASE);
    let inside = case.replacen("\"films\":", &format!("\"films\": {deep}, \"x\":"), 1);
    for text in [deep, inside] {
        here.write("deep.json", text);
        for command in ["check", "analyze", "rerun", "report"] {
            here.refused(&[command, "deep.json"], 3);
        }
    }
}

#[test]
fn an_output_that_cannot_be_written_is_code_3_with_advice() {
    let here = with_phantom(&[]);
    here.write("file", "");
    fs::create_dir(here.path("folder")).expect("a folder");
    for (out, advice) in [("file/a.json", "name another path"), ("folder", "help: ")] {
        let error = here.refused(&["analyze", CASE, "--json", out], 3);
        assert!(error.contains(advice), "{error}");
    }
}

#[test]
fn a_case_with_a_mark_of_the_byte_order_enters_a_store() {
    let here = folder();
    here.done(&split("phantom --subject 1 --films --pixel-size 4 --out c"));
    let text = here.text("c/phantom-rod-01.json");
    here.write("c/phantom-rod-01.json", format!("\u{feff}{text}"));
    here.done(&["study", "create", "s.spineline"]);
    let add = ["study", "add", "s.spineline", "c/phantom-rod-01.json"];
    here.done(&add);
}
