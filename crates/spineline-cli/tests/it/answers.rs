//! What a user reads first: the answers, the warnings by kind, the files that were written, and what a picture needs.

use crate::program::{CASE, assert_says, folder, with_phantom, with_phantoms};

#[test]
fn a_picture_is_sent_to_import_whatever_its_name_is() {
    let here = folder();
    for (name, start) in
        [("a.png", &b"junk"[..]), ("b.json", b"\x89PNG\r\n\x1a\n"), ("c", b"\xff\xd8\xff\xe0")]
    {
        here.write(name, start);
        for command in ["analyze", "check", "report"] {
            let (_, error, code) = here.run(&[command, name]);
            assert!(code == 3 && error.contains("spineline import"), "{command} {name}: {error}");
        }
    }
}

#[test]
fn analyse_is_analyze() {
    let here = with_phantom(&[]);
    let [one, other] = ["analyze", "analyse"].map(|name| here.run(&[name, CASE]).0);
    assert_eq!(one, other);
    assert!(one.contains("Which line?"), "{one}");
}

#[test]
fn outputs_are_named_when_they_are_written() {
    let here = with_phantom(&[]);
    let outputs = ["--json", "a.json", "--model", "m.json", "--tables", "tables"];
    let (_, error, code) = here.run(&[&["analyze", CASE][..], &outputs].concat());
    assert_eq!(code, 0, "{error}");
    assert_says(&error, &["written: a.json", "written: m.json", "files in tables"]);
    let (_, error, _) = here.run(&["export", "m.json", "--to", "mjcf", "--out", "m.xml"]);
    assert!(error.contains("written: m.xml"), "{error}");
}

#[test]
fn a_cohort_has_one_line_per_kind_of_warning() {
    let here = with_phantoms("bend", &["1", "2", "3"]);
    let (_, short, _) = here.run(&["analyze", "cases"]);
    assert!((1..=10).contains(&short.lines().count()), "{short}");
    assert!(!short.contains("phantom-bend-01"), "{short}");
    let (_, all, _) = here.run(&["analyze", "cases", "--warnings"]);
    assert!(all.contains("phantom-bend-01"), "{all}");
}
