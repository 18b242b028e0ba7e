//! `spineline simulate --replicates`: intervals of what is measured under loads.

use serde_json::{Value, json};
use spineline::number::interval;

use crate::program::{CASE, Here, assert_says, unwrapped, with_phantom};

const PUSH: [&str; 6] = ["simulate", "model.json", "--push", "left", "--force", "10"];

/// A folder with the case of a phantom and its model, `model.json`.
fn folder() -> Here {
    let here = with_phantom(&[]);
    here.done(&["analyze", CASE, "--model", "model.json"]);
    here
}

fn simulate<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    PUSH.iter().chain(arguments).copied().collect()
}

/// A number of the uncertainty in the JSON of a simulation.
fn number<'a>(found: &'a Value, quantity: &str, region: Option<&str>, state: &str) -> &'a Value {
    let numbers = found["uncertainty"]["numbers"].as_array().expect("numbers");
    let is_it = |one: &&Value| {
        one["quantity"] == quantity && one["region"].as_str() == region && one["state"] == state
    };
    numbers.iter().find(is_it).expect("it is measured")
}

#[test]
fn text_json_and_csv_have_the_interval_beside_the_number_for_any_number_of_threads() {
    let here = folder();
    let replicates = ["--case", CASE, "--replicates", "40", "--noise", "2", "--seed", "5"];
    let files = |threads| {
        let line =
            [&replicates[..], &["--threads", threads, "--measures", "measures.csv"]].concat();
        let line = [&line[..], &["--json", "simulation.json", "--overwrite"]].concat();
        let text = here.done(&simulate(&line));
        (text, here.text("measures.csv"), here.json("simulation.json"))
    };
    let (text, rows, found) = files("1");
    let (other_text, other_rows, other_found) = files("2");
    assert_eq!((&text, &rows), (&other_text, &other_rows));
    assert_eq!(found["uncertainty"], other_found["uncertainty"]);

    // The number equals the number of the simulation, and lies in its interval.
    let cobb = number(&found, "cobb", Some("main_thoracic"), "loaded");
    let ends: Vec<f64> =
        cobb["interval_95"].as_array().expect("two").iter().filter_map(Value::as_f64).collect();
    let value = cobb["value"].as_f64().expect("a number");
    assert_eq!(cobb["value"], found["equilibria"][0]["cobb_deg"]["main_thoracic"]);
    assert!(ends[0] < value && value < ends[1] && ends[1] - ends[0] < 20.0, "{cobb}");
    let counts = &found["uncertainty"];
    assert_eq!((&counts["replicates"], &counts["done"]), (&json!(40), &json!(40)));
    assert_eq!(
        (&counts["seed"], &counts["noise"]["erect"]["source"]),
        (&json!(5), &json!("given"))
    );
    let without: u64 =
        counts["endings"].as_object().expect("codes").values().filter_map(Value::as_u64).sum();
    assert_eq!(counts["usable"].as_u64().expect("a count") + without, 40);
    assert_eq!(found["provenance"]["replicates"]["count"], 40);

    // The same in words and rows.
    assert!(ends[0] * ends[1] > 0.0, "{cobb}");
    let (small, large) = (ends[0].abs().min(ends[1].abs()), ends[0].abs().max(ends[1].abs()));
    let interval = format!("{small:.1}° to {large:.1}°");
    assert!(text.contains(&interval), "{interval} is missing in\n{text}");
    let said = unwrapped(&text);
    assert_says(
        &said,
        &[
            "95 % intervals: the central 95 % of the Monte Carlo replicates with a result, 40 of 40 (seed 5)",
            "corners 2.00 × 2.00 px",
            "They do not cover the errors of the model, of the loads",
            "Coronal balance: T2 from",
        ],
    );
    let row = rows.lines().find(|row| row.contains(",cobb,main_thoracic,loaded,")).expect("a row");
    let cells: Vec<f64> = row.split(',').skip(7).filter_map(|cell| cell.parse().ok()).collect();
    // JSON has ten significant digits.
    for (cell, number) in [cells[0], cells[3], cells[4]].into_iter().zip([value, ends[0], ends[1]])
    {
        assert!((cell - number).abs() < 1e-9 * number.abs(), "{row}");
    }
    assert_eq!(cells[5..], [counts["usable"].as_f64().expect("a count"), 40.0], "{row}");
}

#[test]
fn an_amplitude_gives_the_interval_of_its_factor() {
    let here = folder();
    let line =
        ["simulate", "model.json", "--push", "left", "--amplitude", "8", "--towards", "left"];
    let more = ["--case", CASE, "--replicates", "60", "--json", "s.json"];
    let text = here.done(&[&line[..], &more].concat());
    let found = here.json("s.json");
    let factor = number(&found, "factor", None, "loaded");
    assert_eq!(factor["value"], found["equilibria"][0]["factor"]);
    let ends = factor["interval_95"].as_array().expect("an interval");
    let ends: Vec<f64> = ends.iter().filter_map(Value::as_f64).collect();
    assert!(text.contains(&interval([ends[0], ends[1]], 4)), "{text}");
    // The target does not vary.
    let tilt = number(&found, "lateral_tilt", None, "loaded");
    assert!(tilt["sd"].as_f64().is_some_and(|sd| sd < 1e-6), "{tilt}");
}

#[test]
fn without_replicates_the_measures_have_no_interval() {
    let here = folder();
    let text = here.done(&simulate(&["--measures", "measures.csv", "--json", "s.json"]));
    assert!(!text.contains("95 %"), "{text}");
    assert_eq!(here.json("s.json")["uncertainty"], Value::Null);
    let rows = here.text("measures.csv");
    let row = rows.lines().find(|row| row.contains(",top_offset,,change,mm,")).expect("a row");
    assert!(row.ends_with(",,,,,,"), "{row}");
    // Three sizes and Ferguson angles, two tilts and an offset in three states, and the heading: no case, so no vertical.
    assert_eq!(rows.lines().count(), 1 + 3 * 9);
}

#[test]
fn a_plan_that_some_replicates_do_not_bear_counts_them() {
    let here = folder();
    // Just below what this model bears.
    let bears = |down: f64| {
        let down = down.to_string();
        let line = ["simulate", "model.json", "--push", "caudal", "--force", &down];
        here.run(&line).2 == 0
    };
    let (mut low, mut high) = (1.0, 1000.0);
    for _ in 0..9 {
        let middle = (low + high) / 2.0;
        if bears(middle) { low = middle } else { high = middle }
    }
    let down = low.to_string();
    let line = ["simulate", "model.json", "--push", "caudal", "--force", &down];
    let more = ["--case", CASE, "--replicates", "24", "--json", "s.json"];
    let text = unwrapped(&here.done(&[&line[..], &more].concat()));
    let counts = here.json("s.json")["uncertainty"].clone();
    let usable = counts["usable"].as_u64().expect("a count");
    assert!((1..24).contains(&usable), "{counts}");
    let counted = format!("with a result, {usable} of 24 (seed 1); a 95 % interval needs 40");
    assert!(text.contains(&counted), "{text}");
    for (code, count) in counts["endings"].as_object().expect("codes") {
        assert!(text.contains(&format!("`{code}` in {count} of 24")), "{text}");
    }
    let numbers = counts["numbers"].as_array().expect("numbers");
    assert!(numbers.iter().all(|one| one["count"].as_u64() == Some(usable)), "{numbers:?}");
}

#[test]
fn replicates_that_are_not_possible_are_refused_with_what_to_do() {
    let here = folder();
    let error = here.refused(&simulate(&["--replicates", "5"]), 2);
    assert!(error.contains("--replicates needs --case CASE"), "{error}");
    for arguments in [&["--case", CASE][..], &["--seed", "3"], &["--threads", "2"]] {
        let error = here.refused(&simulate(arguments), 2);
        assert!(error.contains("--replicates"), "{error}");
    }
    let with = |case: &'static str| simulate(&["--replicates", "5", "--case", case]);

    // Another patient, other landmarks, a model without provenance, and one that was changed.
    here.add_phantom(&["--scenario", "rod", "--subject", "2"]);
    let error = unwrapped(&here.refused(&with("cases/phantom-rod-02.json"), 3));
    assert!(error.contains("the model belongs to the case phantom-rod-01"), "{error}");
    let mut other = here.json(CASE);
    let corner = &mut other["films"][0]["readings"][0]["vertebrae"]["T6"]["superior_left"][0];
    *corner = json!(corner.as_f64().expect("a column") + 3.0);
    here.write("other.json", other.to_string());
    let error = unwrapped(&here.refused(&with("other.json"), 3));
    assert!(error.contains("differ from the model that the case gives now"), "{error}");
    let model = here.json("model.json");
    let change = |change: &dyn Fn(&mut Value)| {
        let mut model = model.clone();
        change(&mut model);
        here.write("model.json", model.to_string());
        unwrapped(&here.refused(&with(CASE), 3))
    };
    let error = change(&|model| {
        let stiffness = &mut model["joints"][3]["stiffness"][0];
        *stiffness = json!(1.01 * stiffness.as_f64().expect("a number"));
    });
    assert!(error.contains("the springs of the model file differ"), "{error}");
    let error = change(&|model| {
        model.as_object_mut().expect("keys").remove("provenance");
    });
    assert!(error.contains("does not say with which options"), "{error}");
    assert!(error.contains("help: write the model again: `spineline analyze"), "{error}");
}

#[test]
fn the_case_may_come_from_an_analysis_and_the_model_may_have_other_options() {
    let here = folder();
    let options = ["--support", "frontal", "--model-line", "iliac"];
    let line = ["analyze", CASE, "--json", "analysis.json", "--model", "model.json", "--overwrite"];
    here.done(&[&line[..], &options].concat());
    let line = simulate(&["--case", "analysis.json", "--replicates", "4", "--json", "s.json"]);
    here.done(&line);
    let found = here.json("s.json");
    assert_eq!(found["uncertainty"]["usable"], 4);
    assert_eq!(found["provenance"]["options"]["support"], "frontal");
    assert_eq!(found["provenance"]["inputs"].as_array().map(Vec::len), Some(2));
}
