//! `analyze --json` of a cohort: the list is written patient by patient.

use crate::program::{assert_says, folder, json, with_phantoms};
use crate::results::results;

/// More cases than one thread holds at once, and one file that is not a case.
#[test]
fn a_list_in_a_file_has_the_same_bytes_for_any_number_of_threads_and_leaves_out_a_bad_case() {
    let here = with_phantoms("rod", &["1", "2", "3", "4", "5", "6"]);
    here.write("cases/a-bad-one.json", "{}");
    let list = |threads: &str| {
        let asked = ["analyze", "cases", "--json", "all.json", "--threads", threads];
        let (text, error, code) = here.run(&asked);
        assert!(code == 3 && error.contains("a-bad-one.json"), "{error}");
        assert_says(&text, &["6 patients · SYNTHETIC", "phantom-rod-06"]);
        results(&here.text("all.json"))
    };
    let one_thread = list("1");
    for threads in ["2", "8"] {
        assert!(list(threads) == one_thread, "the bytes depend on the threads ({threads})");
    }
    let (printed, _, _) = here.run(&["analyze", "cases", "--json", "-"]);
    assert!(results(&printed) == one_thread, "the printed list differs");
    let all = json(&one_thread);
    let all = all.as_array().expect("a list");
    assert_eq!(all.len(), 7);
    assert_eq!(all[0]["refused"]["file"], "a-bad-one.json", "the refused case has its place");
    let case = all[1]["case_id"].as_str().expect("a name");
    let alone = here.done(&["analyze", &format!("cases/{case}.json"), "--json", "-"]);
    assert_eq!(all[1], json(&results(&alone)), "a patient in a cohort is as the patient alone");
}

#[test]
fn a_cohort_without_a_usable_case_writes_a_list_of_refused_cases() {
    let here = folder();
    for name in ["a.json", "b.json"] {
        here.write(name, "{}");
    }
    here.refused(&["analyze", "a.json", "b.json", "--json", "all.json"], 3);
    let list = here.json("all.json");
    let items = list.as_array().expect("a list");
    assert_eq!(items.len(), 2);
    assert!(items.iter().all(|item| item["format"] == "spineline-refused-case"), "{items:?}");
}
