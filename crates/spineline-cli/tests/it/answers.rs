//! What a user reads first: the answers, the warnings by kind, the files that were written, and what a picture needs.

use std::fs;

use crate::program::{CASE, folder, run, with_phantom, with_phantoms};

#[test]
fn a_picture_is_sent_to_import_whatever_its_name_is() {
    let here = folder();
    for (name, start) in
        [("a.png", &b"junk"[..]), ("b.json", b"\x89PNG\r\n"), ("c", b"\xff\xd8\xff\xe0")]
    {
        fs::write(here.path().join(name), start).expect("written");
        for command in ["analyze", "check", "report"] {
            let (_, error, code) = run(here.path(), &[command, name]);
            assert!(code == 3 && error.contains("spineline import"), "{command} {name}: {error}");
        }
    }
}

#[test]
fn analyse_is_analyze() {
    let here = with_phantom(&[]);
    let [one, other] = ["analyze", "analyse"].map(|name| run(here.path(), &[name, CASE]).0);
    assert_eq!(one, other);
    assert!(one.contains("Which line?"), "{one}");
}

#[test]
fn outputs_are_named_when_they_are_written() {
    let here = with_phantom(&[]);
    let outputs = ["--json", "a.json", "--model", "m.json", "--tables", "tables"];
    let (_, error, code) = run(here.path(), &[&["analyze", CASE][..], &outputs].concat());
    assert_eq!(code, 0, "{error}");
    for line in ["written: a.json", "written: m.json", "files in tables"] {
        assert!(error.contains(line), "{line} is missing in\n{error}");
    }
    let (_, error, _) = run(here.path(), &["export", "m.json", "--to", "mjcf", "--out", "m.xml"]);
    assert!(error.contains("written: m.xml"), "{error}");
}

#[test]
fn a_cohort_has_one_line_per_kind_of_warning() {
    let here = with_phantoms("bend", &["1", "2", "3"]);
    let (_, short, _) = run(here.path(), &["analyze", "cases"]);
    assert!((1..=10).contains(&short.lines().count()), "{short}");
    assert!(!short.contains("phantom-bend-01"), "{short}");
    let (_, all, _) = run(here.path(), &["analyze", "cases", "--warnings"]);
    assert!(all.contains("phantom-bend-01"), "{all}");
}
