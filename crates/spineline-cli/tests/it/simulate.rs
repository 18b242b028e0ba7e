//! `spineline simulate` as its users call it.

use std::fs;

use serde_json::{Value, json};

use crate::program::{self, Here, assert_says, split, unwrapped};

/// A folder with the model of a phantom, `model.json`.
fn folder() -> Here {
    let here = program::folder();
    here.done(&["phantom", "--scenario", "rod", "--subject", "1", "--out", "."]);
    here.done(&["analyze", "phantom-rod-01.json", "--model", "model.json"]);
    here
}

/// The JSON of a simulation, and the exit code.
fn simulate(here: &Here, arguments: &[&str]) -> (Value, i32) {
    let line = [&["simulate", "model.json", "--json", "-"], arguments].concat();
    let (text, error, code) = here.run(&line);
    (serde_json::from_str(&text).unwrap_or_else(|_| panic!("no JSON: {error}")), code)
}

fn number(json: &Value, pointer: &str) -> f64 {
    json.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer}"))
}

/// The codes of the warnings.
fn codes(json: &Value) -> Vec<&str> {
    let warnings = json["warnings"].as_array().expect("a list").iter();
    warnings.filter_map(|warning| warning["code"].as_str()).collect()
}

/// Keys in the JSON of every simulation.
const POINTERS: [&str; 24] = [
    "/generator",
    "/case_id",
    "/equilibria/0/factor",
    "/equilibria/0/on_erect_branch",
    "/equilibria/0/limit_points",
    "/equilibria/0/branch_points",
    "/equilibria/0/residual_rad",
    "/equilibria/0/smallest_singular_value",
    "/equilibria/0/midpoints_mm/T2/2",
    "/equilibria/0/axes/T2/2/2",
    "/equilibria/0/hinges_rad/T3~1T2/0",
    "/equilibria/0/spring_forces",
    "/equilibria/0/rod_reactions",
    "/equilibria/0/cobb_deg/main_thoracic",
    "/equilibria/0/ferguson_deg/main_thoracic",
    "/events",
    "/path/0/timing",
    "/path/0/factor",
    "/path/0/arc_rad",
    "/path/0/lateral_tilt_right_deg",
    "/path/0/residual_rad",
    "/path/0/iterations",
    "/warnings/0/code",
    "/erect/cobb_deg/main_thoracic",
];

#[test]
fn a_force_gives_a_report_and_complete_files() {
    let here = folder();
    let line = ["simulate", "model.json", "--push", "left", "--force", "20"];
    let files = ["--json", "out/s.json", "--csv", "out/s.csv", "--svg", "out/s.svg"];
    let all: Vec<&str> = line.iter().chain(&files).copied().collect();
    let text = here.done(&all);
    assert_says(
        &text,
        &[
            "SYNTHETIC",
            "relative units, not newtons",
            "relative to the nominal stiffness, not newtons: no force was measured",
            "CONVERGED",
            "Cobb, main thoracic",
            "convex right",
            "left",
        ],
    );
    let json = here.json("out/s.json");
    for pointer in POINTERS {
        assert!(json.pointer(pointer).is_some_and(|value| !value.is_null()), "{pointer}");
    }
    assert_eq!((&json["format"], &json["version"]), (&json!("spineline-simulation"), &json!(1)));
    assert_eq!(
        (&json["synthetic"], &json["absolute"], &json["status"]),
        (&json!(true), &json!(false), &json!("converged"))
    );
    assert_eq!(
        (&json["force_unit"], &json["loads"][0]["force"]),
        (&json!("relative"), &json!([0.0, 20.0, 0.0]))
    );
    // A key with a newton belongs to a measured force.
    for name in ["out/s.json", "model.json"] {
        let named = here.text(name);
        let newtons = ["_n\"", "_nmm\"", "n_per_mm", "\"stiffness_nmm"];
        newtons.iter().for_each(|key| assert!(!named.contains(key), "{name}: {key}"));
    }
    let rows = here.text("out/s.csv");
    let columns: Vec<usize> = rows.lines().map(|row| row.split(',').count()).collect();
    assert!(columns.len() > 3 && columns.iter().all(|n| *n == columns[0]), "{columns:?}");
    assert_eq!(columns.len(), 1 + json["path"].as_array().expect("a list").len());
    assert!(
        rows.contains("lateral_tilt_right_deg")
            && rows.contains("cobb_main_thoracic_convex_left_deg")
    );
    let svg = here.text("out/s.svg");
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    let said = ["synthetic data", "relative units, not newtons", "Seen from behind", "LEFT"];
    assert_says(&svg, &said);
}

#[test]
fn the_load_of_a_film_gives_the_shape_of_the_analysis() {
    // Oracle: the march inside of the analysis.
    let here = folder();
    let (text, _, _) = here.run(&["analyze", "phantom-rod-01.json", "--json", "-"]);
    let analysis = program::json(&text);
    for film in ["left_bending", "traction"] {
        let (json, code) = simulate(&here, &["--posture", film]);
        assert_eq!(code, 0);
        let there = &analysis["models"]["inflection_line"]["postures"][film];
        let force = there["force"].as_f64().expect("a force");
        let sent = json["loads"][0]["force"].as_array().expect("a vector");
        let size: f64 = sent.iter().map(|part| part.as_f64().expect("a part").powi(2)).sum();
        assert!((size.sqrt() - force.abs()).abs() < 1e-9 * force.abs());
        let main = |json: &Value, pointer: &str| number(json, pointer);
        let error = main(there, "/ferguson_error_deg/main_thoracic");
        let film_deg =
            number(&analysis, &format!("/clinical/curves/main_thoracic/ferguson_deg/{film}"));
        let simulated = main(&json, "/equilibria/0/ferguson_deg/main_thoracic");
        assert!(
            ((simulated - film_deg).abs() - error.abs()).abs() < 1e-7,
            "{simulated} {film_deg} {error}"
        );
    }
    let (json, _) = simulate(&here, &["--posture", "right_bending", "--force", "10"]);
    let along = number(&json, "/loads/0/force/2");
    assert!(along < 0.0, "the right bend's force is caudal, and 10 of it too");
}

#[test]
fn an_amplitude_is_found_for_either_direction_of_the_loads() {
    let here = folder();
    let tilt = ["--amplitude", "20", "--towards"];
    let with =
        |push: &str, side: &str| simulate(&here, &[&["--push", push], &tilt[..], &[side]].concat());
    let ((left, code), (against, _), (right, _)) =
        (with("left", "left"), with("right", "left"), with("left", "right"));
    assert_eq!(code, 0);
    let factor = |json: &Value| number(json, "/equilibria/0/factor");
    assert!(factor(&left) > 0.0 && (factor(&left) + factor(&against)).abs() < 1e-9 * factor(&left));
    assert_eq!(against["equilibria"][0]["direction"], "against");
    assert!(factor(&right) < 0.0);
    assert!((number(&left, "/equilibria/0/lateral_tilt_right_deg") + 20.0).abs() < 1e-7);
    assert!((number(&right, "/equilibria/0/lateral_tilt_right_deg") - 20.0).abs() < 1e-7);
    assert_eq!(left["equilibria"][0]["verdict"], "reached");
    // All shapes with this lateral tilt are reported, with reasons.
    let line = split("simulate model.json --posture traction --amplitude 3 --towards left");
    let text = unwrapped(&here.done(&line));
    let all = ["SEVERAL EQUILIBRIA", "chosen: smallest factor", "not chosen", "against their"];
    assert_says(&text, &all);
}

/// Makes a model its mirror image: what was left is right.
fn mirror(json: &mut Value) {
    let flip = |value: &mut Value| *value = json!(-value.as_f64().expect("a number"));
    for vertebra in json["vertebrae"].as_array_mut().expect("a list") {
        flip(&mut vertebra["midpoint_mm"][1]);
        // The mirror turns right-handed axes: S R S with S = diag(1, -1, 1).
        for (axis, part) in [(0, 1), (1, 0), (1, 2), (2, 1)] {
            flip(&mut vertebra["axes"][axis][part]);
        }
    }
    for joint in json["joints"].as_array_mut().expect("a list") {
        flip(&mut joint["centre_mm"][1]);
    }
    for region in json["regions"].as_array_mut().expect("a list") {
        flip(&mut region["endplate_difference_deg"]);
    }
}

#[test]
fn a_mirrored_model_has_the_mirrored_response() {
    let here = folder();
    let (left, _) =
        simulate(&here, &["--push", "left", "--force", "30", "--level", "T8", "--follow"]);
    here.change("model.json", mirror);
    let (right, _) =
        simulate(&here, &["--push", "right", "--force", "30", "--level", "T8", "--follow"]);
    for pointer in [
        "lateral_tilt_right_deg",
        "cobb_deg/main_thoracic",
        "ferguson_deg/proximal_thoracic",
        "midpoints_mm/T2/1",
    ] {
        let of = |json: &Value| number(json, &format!("/equilibria/0/{pointer}"));
        assert!((of(&left) + of(&right)).abs() < 1e-8, "{pointer}");
    }
}

#[test]
fn weight_and_a_pad_come_from_a_file() {
    let here = folder();
    let load = json!({ "format": "spineline-load", "version": 1, "loads": [
        { "kind": "gravity", "body_weight": 20 },
        { "kind": "pad", "level": "T9", "direction": [0, 1, 0], "force_per_mm": 2, "advance_mm": 20 },
        { "kind": "strap", "level": "T4", "anchor_mm": [0, 200, 320], "force_per_mm": 1, "shortening_mm": -30 } ] });
    here.write("load.json", load.to_string());
    let (json, code) = simulate(&here, &["--load", "load.json"]);
    assert_eq!(code, 0);
    assert!(number(&json, "/equilibria/0/spring_forces/0/force") > 0.0);
    assert_eq!(json["equilibria"][0]["spring_forces"][0]["load"], 2);
    let codes = codes(&json);
    for code in ["relative_forces", "weight_on_top", "springs_stick", "strap_pushes"] {
        assert!(codes.contains(&code), "{code} is missing in {codes:?}");
    }
    assert_eq!(json["path"][0]["timing"], "held");
}

#[test]
fn a_model_that_its_films_reject_says_so_wherever_it_is_used() {
    // Oracle: the phantom's line is the inflection line, and the test of `analyze` rejects the iliac one.
    let here = folder();
    fs::remove_file(here.path("model.json")).expect("removed");
    let make = ["analyze", "phantom-rod-01.json", "--model", "model.json", "--model-line", "iliac"];
    here.done(&make);
    let doubt = "the bends reject a single force along the iliac line";
    let (json, _) = simulate(&here, &["--push", "left", "--force", "1"]);
    let warnings = json["warnings"].as_array().expect("a list");
    let doubted: Vec<&Value> = warnings.iter().filter(|w| w["code"] == "model_doubted").collect();
    assert!(doubted[0]["message"].as_str().is_some_and(|text| text.contains(doubt)), "{json}");
    // Two multipliers of three are at their bounds, and these fix the third.
    let says = |words: &str| {
        doubted.iter().any(|w| w["message"].as_str().is_some_and(|text| text.contains(words)))
    };
    assert!(doubted.len() == 4 && says("all others reached their limits"), "{doubted:?}");
    for format in ["osim", "mjcf", "urdf"] {
        let exported = here.done(&["export", "model.json", "--to", format]);
        assert!(exported.contains(&format!("DOUBT: {doubt}")), "{format}: {exported}");
    }
}

#[test]
fn a_whole_body_weight_that_folds_the_spine_has_no_result() {
    let here = folder();
    let load =
        r#"{"format":"spineline-load","version":1,"loads":[{"kind":"gravity","body_weight":700}]}"#;
    here.write("weight.json", load);
    let line = ["simulate", "model.json", "--load", "weight.json", "--json", "w.json"];
    let (text, _, code) = here.run(&line);
    assert_eq!(code, 4, "{text}");
    assert!(text.contains("BEYOND HUMAN RANGE · NO RESULT"), "{text}");
    assert!(text.contains("a body with the weight 700 relative units"), "{text}");
    assert!(!text.contains("Cobb"), "no angle of a folded spine: {text}");
    let json = here.json("w.json");
    assert_eq!(json["status"], "beyond_human_range");
    let codes = codes(&json);
    assert!(codes.contains(&"beyond_human_range"), "{codes:?}");
}

#[test]
fn a_missing_result_ends_with_4_and_is_labelled_everywhere() {
    let here = folder();
    let line = split("simulate model.json --push caudal --force 1500 --svg s.svg --json s.json");
    let (text, _, code) = here.run(&line);
    assert_eq!(code, 4);
    assert!(text.contains("NO RESULT") && !text.contains("Cobb"), "{text}");
    assert!(here.text("s.svg").contains("not a result (beyond_human_range)"));
    assert!(here.text("s.json").contains("\"status\": \"beyond_human_range\""));
    let line = ["--push", "left", "--amplitude", "80", "--towards", "left"];
    assert_eq!(simulate(&here, &line).1, 4);
}

#[test]
fn a_model_of_the_standing_patient_says_what_its_springs_carry_already() {
    let here = folder();
    let reference = ["--reference", "loaded:50", "--model", "model.json", "--overwrite"];
    here.done(&[&["analyze", "phantom-rod-01.json"], &reference[..]].concat());
    let (_, error, code) = here.run(&["simulate", "model.json", "--posture", "left_bending"]);
    assert_eq!(code, 3, "{error}");
    assert!(error.contains("no loads of films: it was made with `--reference loaded`"), "{error}");
    let load =
        r#"{"format":"spineline-load","version":1,"loads":[{"kind":"gravity","body_weight":5}]}"#;
    here.write("weight.json", load);
    let (json, _) = simulate(&here, &["--load", "weight.json"]);
    let warnings = json["warnings"].as_array().expect("a list").iter();
    let mut on_top = warnings.filter(|warning| warning["code"] == "weight_on_top");
    let message = on_top.next().expect("warned")["message"].to_string();
    assert!(
        message.contains("already counts the weight of the trunk of a body of 50 kg"),
        "{message}"
    );
    let exported = here.done(&["export", "model.json", "--to", "mjcf"]);
    let erect = "erect posture, in balance with the weight of the trunk of a body of 50 kg";
    assert!(exported.contains(erect), "{exported}");
}

#[test]
fn bad_loads_and_models_end_with_3_and_wrong_usage_with_2() {
    let here = folder();
    let bad = r#"{"format":"spineline-load","version":1,"loads":[{"kind":"moment","level":"T1","moment":[1,0,0]}]}"#;
    here.write("bad.json", bad);
    for (arguments, expected, words) in [
        (
            &["model.json", "--load", "bad.json"][..],
            3,
            "load 1 (moment, T1): T1 is not in the model",
        ),
        (&["model.json", "--load", "model.json"], 3, "should be `spineline-load`"),
        (&["phantom-rod-01.json", "--posture", "neutral"], 3, "should be `spineline-model`"),
        (&["model.json", "--posture", "erect"], 3, "left_bending"),
        (&["model.json"], 2, "--push"),
        (&["model.json", "--push", "left"], 2, "--force"),
        (&["model.json", "--push", "left", "--posture", "neutral"], 2, "cannot be used"),
        (&["model.json", "--push", "left", "--force=-3"], 2, "above zero"),
        (
            &["model.json", "--push", "left", "--force", "3", "--largest-factor", "1e300"],
            2,
            "not above 0 and at most 1e9",
        ),
        (&["model.json", "--push", "left", "--force", "3", "--amplitude", "5"], 2, "--towards"),
        (&["model.json", "--load", "bad.json", "--force", "3"], 2, "cannot be used"),
        (
            &["model.json", "--push", "left", "--force", "3", "--json", "-", "--csv", "-"],
            2,
            "only one",
        ),
    ] {
        let (_, error, code) = here.run(&[&["simulate"], arguments].concat());
        assert_eq!(code, expected, "{arguments:?}: {error}");
        assert!(error.contains(words), "{words} is missing in {error}");
    }
}

#[test]
fn a_model_without_regions_is_measured_at_default_levels_with_a_note() {
    let here = folder();
    here.change("model.json", |model| {
        model.as_object_mut().expect("an object").remove("regions");
    });
    let (json, code) = simulate(&here, &["--push", "left", "--force", "5"]);
    assert_eq!(code, 0);
    assert_eq!(json["warnings"][0]["code"], "usual_regions");
    let angles = &json["equilibria"][0];
    assert!(angles["tilt_range_deg"]["main_thoracic"].is_number());
    // Without its regions a model does not say how its endplates lie.
    assert_eq!(angles["cobb_deg"], json!({}));
}
