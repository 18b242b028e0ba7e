//! The program built without the weights, by `--no-default-features`.

use serde_json::json;

use crate::program::{CASE, unwrapped, with_phantom};

#[test]
fn landmarks_are_not_proposed_and_completed_ones_count_as_clicked() {
    let here = with_phantom(&["--subject", "1", "--films", "--pixel-size", "2"]);
    let film = "cases/phantom-rod-01-erect.dcm";
    let (_, error, code) = here.run(&["detect", film, "--posture", "erect", "--out", "f"]);
    assert!(code == 3 && error.contains("built without the networks"), "{code} {error}");
    assert!(!error.contains("AASCE"), "{error}");
    let licences = here.done(&["licences"]);
    assert!(licences.contains("crate serde 1") && !licences.contains("AASCE"));
    let clicked = here.done(&["check", CASE]);
    let mut case = here.json(CASE);
    let readings = case["films"][0]["readings"].as_array_mut().expect("readings");
    let vertebrae = readings[0]["vertebrae"].as_object_mut().expect("vertebrae");
    vertebrae.values_mut().for_each(|one| one["origins"] = json!(vec!["completed"; 4]));
    here.write("completed.json", case.to_string());
    let completed = here.done(&["check", "completed.json"]);
    let shape = "built without the shape of spines";
    let says = |text: &str| unwrapped(text).contains(shape);
    assert!(says(&completed) && !says(&clicked), "{completed}");
}
