//! `analyze --json` of a cohort: the list is written patient by patient.

use std::fs;

use serde_json::Value;

use crate::program;
use crate::results::results;

/// More cases than one thread holds at once, and one file that is not a case.
#[test]
fn a_list_in_a_file_has_the_same_bytes_for_any_number_of_threads_and_leaves_out_a_bad_case() {
    let here = tempfile::tempdir().expect("a place for files");
    for subject in 1..=6 {
        let subject = subject.to_string();
        let asked = ["phantom", "--subject", &subject, "--out", "cases"];
        let (_, error, code) = program::run(here.path(), &asked);
        assert_eq!(code, 0, "{error}");
    }
    fs::write(here.path().join("cases/a-bad-one.json"), "{}").expect("a place");
    let list = |threads: &str| {
        let asked = ["analyze", "cases", "--json", "all.json", "--threads", threads];
        let (_, error, code) = program::run(here.path(), &asked);
        assert!(code == 3 && error.contains("a-bad-one.json"), "{error}");
        results(&fs::read_to_string(here.path().join("all.json")).expect("the list"))
    };
    let one_thread = list("1");
    for threads in ["2", "8"] {
        assert!(list(threads) == one_thread, "the bytes depend on the threads ({threads})");
    }
    let all: Value = serde_json::from_str(&one_thread).expect("JSON");
    let all = all.as_array().expect("a list");
    assert_eq!(all.len(), 7);
    assert_eq!(all[0]["refused"]["file"], "a-bad-one.json", "the refused case has its place");
    let case = all[1]["case_id"].as_str().expect("a name");
    let (alone, error, code) =
        program::run(here.path(), &["analyze", &format!("cases/{case}.json"), "--json", "-"]);
    assert_eq!(code, 0, "{error}");
    let alone: Value = serde_json::from_str(&results(&alone)).expect("JSON");
    assert_eq!(all[1], alone, "a patient in a cohort is as the patient alone");
}

#[test]
fn a_cohort_without_a_usable_case_writes_a_list_of_refused_cases() {
    let here = tempfile::tempdir().expect("a place for files");
    for name in ["a.json", "b.json"] {
        fs::write(here.path().join(name), "{}").expect("a place");
    }
    let (_, error, code) =
        program::run(here.path(), &["analyze", "a.json", "b.json", "--json", "all.json"]);
    assert_eq!(code, 3, "{error}");
    let list = fs::read_to_string(here.path().join("all.json")).expect("the list");
    let list: Value = serde_json::from_str(&list).expect("JSON");
    let items = list.as_array().expect("a list");
    assert_eq!(items.len(), 2);
    assert!(items.iter().all(|item| item["format"] == "spineline-refused-case"), "{items:?}");
}
