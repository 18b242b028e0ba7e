//! `learn-prior`, and what `analyze` does with its file.

use std::fs;

use serde_json::Value;

use crate::program::{CASE, Here, assert_says, folder, json, unwrapped};

/// This number of synthetic patients in `cases`, and one more in `other`. Subject 6 has two films of one shape.
fn cohort(patients: usize) -> Here {
    let here = folder();
    for subject in ["1", "2", "3", "4", "5", "7"].into_iter().take(patients) {
        here.add_phantom(&["--subject", subject]);
    }
    here.done(&["phantom", "--subject", "9", "--out", "other"]);
    here
}

#[test]
fn a_learned_distribution_predicts_the_bends_of_another_patient() {
    let here = cohort(6);
    let said = here.done(&["learn-prior", "cases", "--out", "prior.json"]);
    let parts = ["6 patients, 12 bends", "SYNTHETIC", "L4/L3", "tilt of the top vertebra"];
    assert_says(&said, &parts);
    let scale =
        "The scale of a film is fitted where the film or the erect film does not state it exactly.";
    assert!(unwrapped(&said).contains(scale), "{said}");
    let file = here.json("prior.json");
    assert_eq!(file["synthetic"], true);
    assert_eq!(file["prior"]["patients"], 6);
    assert_eq!(file["left_out"]["patients"], 6);
    assert_eq!(file["provenance"]["inputs"].as_array().map(Vec::len), Some(6));

    let analyzed = |more: &[&str]| -> Value {
        let asked = ["analyze", "other", "--json", "-"];
        json(&here.done(&[&asked[..], more].concat()))
    };
    let with = analyzed(&["--rotation-prior", "prior.json"]);
    let left_out = |analysis: &Value, baseline: &str| {
        analysis["comparison"]["baselines_mm"][baseline]["left_out_bend"].as_f64()
    };
    let [given, tilt] =
        ["rotation_prior", "rotation_prior_with_tilt"].map(|one| left_out(&with, one));
    assert!(given.is_some_and(f64::is_finite) && tilt.is_some_and(f64::is_finite));
    let inputs = with["provenance"]["inputs"].as_array().expect("inputs");
    assert!(inputs.iter().any(|input| input["name"] == "prior.json"), "{inputs:?}");
    assert_eq!(with["provenance"]["options"]["rotation_prior"], file["prior"]);
    // Without the file there is the published distribution, which predicts with the tilt alone.
    let without = analyzed(&[]);
    assert_eq!(left_out(&without, "rotation_prior"), None);
    let published = left_out(&without, "rotation_prior_with_tilt");
    assert!(published.is_some() && published != tilt);
    // The analysis is repeated from its own file.
    here.write("with.json", with.to_string());
    let said = here.done(&["rerun", "with.json"]);
    assert!(said.contains("Nothing differs"), "{said}");
}

#[test]
fn nothing_is_predicted_of_patients_who_were_learned_from() {
    let here = cohort(5);
    here.done(&["learn-prior", "cases", "--out", "prior.json"]);
    for command in ["analyze", "report"] {
        let error = here.refused(&[command, CASE, "--rotation-prior", "prior.json"], 3);
        assert!(error.contains("was learned from the case"), "{error}");
        assert!(error.contains("learn it from other cases"), "{error}");
    }
    // The same patient in a file with other bytes, and with other letters in its identifier.
    let saved_again = here.json(CASE).to_string().replace("phantom", "PHANTOM");
    here.write("again.json", saved_again + "\n\n");
    let asked = ["analyze", "again.json", "--rotation-prior", "prior.json"];
    let error = here.refused(&asked, 3);
    assert!(error.contains("was learned from the case"), "{error}");
    // Beside another patient they are refused before their analysis.
    let asked = ["analyze", "cases", "other", "--rotation-prior", "prior.json"];
    here.refused(&[&asked[..], &["--cohort", "cohort.json"]].concat(), 3);
    let file = here.json("cohort.json");
    let steps = file["refused"].as_array().expect("cases").iter().map(|one| &one["step"]);
    assert_eq!(steps.collect::<Vec<_>>(), ["analysis"; 5]);
}

#[test]
fn a_distribution_of_tilts_by_another_rule_is_refused() {
    let here = cohort(5);
    for (rule, other) in [("endplates", "axis"), ("axis", "endplates")] {
        here.done(&["learn-prior", "cases", "--tilt", rule, "--out", "prior.json", "--overwrite"]);
        assert_eq!(here.json("prior.json")["tilt"], rule);
        let analyze = ["analyze", "other", "--rotation-prior", "prior.json", "--tilt"];
        here.done(&[&analyze[..], &[rule]].concat());
        let error = here.refused(&[&analyze[..], &[other]].concat(), 3);
        let (error, said) = (unwrapped(&error), format!("learned with tilts by `{rule}`"));
        assert!(error.contains(&said), "{error}");
    }
}

#[test]
fn too_few_patients_doubted_films_and_files_without_a_distribution_are_refused() {
    let here = cohort(4);
    let error = here.refused(&["learn-prior", "cases", "--out", "prior.json"], 3);
    assert!(error.contains("4 patients") && error.contains("at least 5"), "{error}");
    assert!(!here.path("prior.json").exists());

    here.add_phantom(&["--subject", "5"]);
    here.add_phantom(&["--subject", "6"]);
    // The erect film again, moved by five pixels, under the name of a bend.
    let doubted = "cases/phantom-rod-06.json";
    let mut case = here.json(doubted);
    let film = |case: &Value, posture: &str| {
        let mut films = case["films"].as_array().expect("films").iter();
        films.position(|film| film["posture"] == posture).expect("every posture")
    };
    let (erect, left) = (film(&case, "erect"), film(&case, "left_bending"));
    let mut again = case["films"][erect].clone();
    again["posture"] = "left_bending".into();
    again["image"]["file"] = case["films"][left]["image"]["file"].clone();
    for reading in again["readings"].as_array_mut().expect("readings") {
        for corners in reading["vertebrae"].as_object_mut().expect("vertebrae").values_mut() {
            for corner in corners.as_object_mut().expect("corners").values_mut() {
                if let Some([column, _]) = corner.as_array_mut().map(Vec::as_mut_slice) {
                    *column = (column.as_f64().expect("a number") + 5.0).into();
                }
            }
        }
    }
    case["films"][left] = again;
    here.write(doubted, case.to_string());
    let error = here.refused(&["learn-prior", "cases", "--out", "prior.json"], 3);
    assert!(error.contains("may not show what it is named after"), "{error}");
    fs::remove_file(here.path("prior.json")).expect("of the others");
    fs::remove_file(here.path(doubted)).expect("the doubted one");
    here.done(&["learn-prior", "cases", "--out", "prior.json"]);
    let mut file = here.json("prior.json");
    file["prior"]["covariance_deg2"][0][0] = (-1.0).into();
    here.write("broken.json", file.to_string());
    let error = here.refused(&["analyze", "other", "--rotation-prior", "broken.json"], 3);
    assert!(error.contains("broken.json") && error.contains("positive definite"), "{error}");
    assert!(error.contains("learn-prior"), "{error}");
}

#[test]
fn a_bad_case_and_a_patient_twice_are_reported_and_left_out() {
    let here = cohort(5);
    fs::copy(here.path(CASE), here.path("again.json")).expect("a copy");
    here.write("bad.json", "{}");
    let asked = ["learn-prior", "cases", "again.json", "bad.json", "--out", "prior.json"];
    let (said, error, code) = here.run(&asked);
    assert_eq!(code, 3, "{error}");
    assert!(error.contains("bad.json") && error.contains("was given already"), "{error}");
    assert!(said.contains("5 patients"), "{said}");
}
