//! Loads that users put on a model: the page shows what `spineline simulate` computes from the saved files.

use serde_json::{Value, json};
use spineline_files::{Simulated, parse_load, parse_model, results_text, to_text};
use spineline_phantom::{Readers, Scenario, generate};

use super::server::{Running, add_read_study, assert_numbers, phantom, serve};

const PATH: &str = "/api/studies/S1/loads/inflection_line";

fn running() -> Running {
    serve(|store| add_read_study(store, "S1", &phantom().case))
}

fn file(loads: &Value) -> Value {
    json!({ "format": "spineline-load", "version": 1, "loads": loads })
}

/// All examples of the menu.
fn examples(running: &Running) -> Vec<Value> {
    let menu = running.get(PATH);
    assert_numbers(&menu, "menu");
    let kinds = menu["kinds"].as_array().expect("kinds");
    kinds.iter().map(|kind| kind["example"].clone()).collect()
}

fn without_provenance(mut file: Value) -> Value {
    let parts = file.as_object_mut().expect("an object");
    assert!(parts.shift_remove("provenance").is_some());
    file
}

#[test]
fn the_saved_files_give_the_command_line_the_same_simulation() {
    let running = running();
    let model = running.get(&format!("{PATH}/model"));
    let stored = parse_model(&model.to_string()).expect("a model of this program").model;
    let pad_and_traction = [examples(&running)[0].clone(), examples(&running)[3].clone()];
    for loads in [json!(pad_and_traction), json!([examples(&running)[5]])] {
        let text = to_text(&file(&loads));
        let saved = running.post(&format!("{PATH}/simulation"), &file(&loads));
        // As the command line does.
        let loads = parse_load(&text).expect("a load file");
        let own = Simulated::at_full_load(stored.clone(), loads);
        let own = own.expect("sound loads").file(saved["generator"].as_str().expect("a program"));
        assert_eq!(saved["status"], "converged");
        let saved = without_provenance(saved);
        assert_eq!(results_text(&saved), results_text(&own));
    }
}

#[test]
fn each_example_has_a_result_with_angles_before_and_after() {
    let running = running();
    for load in examples(&running) {
        let answer = running.post(PATH, &file(&json!([load])));
        assert_numbers(&answer, "answer");
        assert_eq!(answer["faults"], json!([]), "{load}");
        let simulation = &answer["simulation"];
        assert_eq!(simulation["converged"], true, "{load}: {}", simulation["texts"]);
        let ending = simulation["texts"][0].as_str().expect("an ending");
        assert!(ending.starts_with("CONVERGED · "), "{ending}");
        let rows = simulation["angles"]["rows"].as_array().expect("rows");
        let of = |name: &str| {
            let named = |row: &&Value| row[0].as_str().is_some_and(|text| text.starts_with(name));
            rows.iter().filter(named).count()
        };
        assert_eq!((of("Cobb"), of("Ferguson")), (3, 3));
        let tilt = of("Lateral tilt of L4-T2 against L4's axis");
        assert_eq!((tilt, of("T2 from the axis of L4")), (1, 1));
        assert_eq!((of("Tilt of T2 against L4"), of("Coronal balance: T2 from")), (1, 1));
        let steps = simulation["steps"].as_array().expect("steps");
        assert!(steps.len() > 2 && steps.len() <= 42);
        assert_eq!(steps.last().expect("steps")["label"], "All loads: the result");
    }
}

#[test]
fn a_pull_on_both_sides_moves_the_spine_to_both_sides() {
    let running = running();
    let y_mm = |force: f64| {
        let load = json!([{ "kind": "force_at_point", "level": "T6", "force": [0.0, force, 0.0] }]);
        let answer = running.post(PATH, &file(&load));
        let steps = answer["simulation"]["steps"].as_array().expect("steps").clone();
        let last = steps.last().expect("the result");
        let arrow = &last["arrows"][0];
        assert_eq!((arrow["load"].as_u64(), arrow["part"].as_f64()), (Some(0), Some(1.0)));
        assert_eq!(arrow["vector"][1].as_f64(), Some(force));
        let at = |step: &Value| step["shape"]["midpoints_mm"][10][1].as_f64().expect("a number");
        at(last) - at(&steps[0])
    };
    let (left, right) = (y_mm(15.0), y_mm(-15.0));
    assert!(left > 1.0 && right < -1.0, "{left} {right}");
}

/// The phantom stands upright on its film: T2 moves along the horizontal as much as in the frame of L4, except for L4's
/// tilt.
#[test]
fn the_balance_changes_as_the_uppermost_vertebra_moves() {
    let running = running();
    let load = json!([{ "kind": "force_at_point", "level": "T2", "force": [0.0, 12.0, 0.0] }]);
    let answer = running.post(PATH, &file(&load));
    let rows = answer["simulation"]["angles"]["rows"].as_array().expect("rows");
    let change_mm = |name: &str| {
        let named = |row: &&Value| row[0].as_str().is_some_and(|text| text.starts_with(name));
        let cells = rows.iter().find(named).expect("a row").as_array().expect("cells");
        let left_mm = |cell: &Value| {
            let text = cell.as_str().expect("text");
            let size: f64 = text.split(' ').next().and_then(|n| n.parse().ok()).expect("a number");
            if text.ends_with("right") { -size } else { size }
        };
        // Rounded to a tenth of a millimetre each.
        assert!((left_mm(&cells[3]) - (left_mm(&cells[2]) - left_mm(&cells[1]))).abs() < 0.151);
        left_mm(&cells[3])
    };
    let (balance, offset) = (change_mm("Coronal balance"), change_mm("T2 from the axis of L4"));
    assert!(offset > 5.0 && balance > 0.8 * offset && balance < 1.2 * offset, "{balance} {offset}");
}

#[test]
fn faults_name_their_load_and_all_of_them() {
    let running = running();
    let loads = json!([
        { "kind": "pad", "level": "T8", "direction": [0.0, 0.5, 0.0], "force_per_mm": 2.0, "advance_mm": 5.0 },
        { "kind": "force_at_point", "level": "T6", "force": [0.0, 5.0, 0.0] },
        { "kind": "gravity", "body_weight": -3.0 },
        { "kind": "moment", "level": "L4", "moment": [100.0, 0.0, 0.0] },
    ]);
    let answer = running.post(PATH, &file(&loads));
    assert_eq!(answer["simulation"], Value::Null);
    assert_eq!(answer["loads"].as_array().map(Vec::len), Some(4));
    let faults = answer["faults"].as_array().expect("faults");
    let of: Vec<u64> = faults.iter().filter_map(|fault| fault["load"].as_u64()).collect();
    assert_eq!(of, [0, 2, 3]);
    assert!(faults[1]["text"].as_str().is_some_and(|text| text.contains("must be positive")));
    assert!(
        faults[2]["text"].as_str().is_some_and(|text| text.contains("L4 is the fixed vertebra"))
    );
}

#[test]
fn a_file_that_is_no_load_file_is_refused_with_its_line() {
    let running = running();
    let misspelt = json!([{ "kind": "pad", "levle": "T8" }]);
    for (body, code, word) in [
        (file(&misspelt), 422, "did you mean `level`?"),
        (file(&json!([])), 422, "load"),
        (json!({ "format": "spineline-model" }), 422, "spineline-load"),
        (file(&json!(vec![json!({ "kind": "gravity", "body_weight": 1.0 }); 101])), 422, "101"),
    ] {
        let (status, problem) = running.ask("POST", PATH, Some(&body));
        assert_eq!(status, code, "{problem}");
        assert!(problem["message"].as_str().is_some_and(|text| text.contains(word)), "{problem}");
        assert!(problem["help"].as_str().is_some_and(|help| !help.is_empty()), "{problem}");
    }
}

#[test]
fn loads_that_fold_the_spine_end_by_name_without_angles() {
    let running = running();
    let load = json!([{ "kind": "force_at_point", "level": "T2", "force": [0.0, 0.0, -9000.0] }]);
    let answer = running.post(PATH, &file(&load));
    let simulation = &answer["simulation"];
    assert_eq!(simulation["converged"], false);
    let ending = simulation["texts"][0].as_str().expect("an ending");
    let names = ["LIMIT POINT", "BRANCH POINT", "BEYOND HUMAN RANGE"];
    assert!(
        names.iter().any(|name| ending.starts_with(&format!("{name} · NO RESULT"))),
        "{ending}"
    );
    for table in ["angles", "forces", "numbers"] {
        assert_eq!(simulation[table]["rows"], json!([]), "{table}");
    }
    assert_eq!(simulation["films"], json!([]));
    let steps = simulation["steps"].as_array().expect("steps");
    assert!(steps.iter().all(|step| step["label"] != "All loads: the result"));
}

/// The force that the analysis found for the traction film gives the shape that the analysis compares with it.
#[test]
fn the_traction_of_the_film_gives_the_errors_of_the_analysis() {
    /// The path and the search for the force end within this of each other.
    const SAME_MM: f64 = 1e-3;
    let case = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists").case;
    let running = serve(|store| add_read_study(store, "S1", &case));
    let menu = running.get(PATH);
    let films = menu["films"].as_array().expect("films");
    let traction = films.iter().find(|film| film["posture"] == "traction").expect("a film");
    assert_eq!(traction["doubt"], Value::Null);
    let answer = running.post(PATH, &file(&json!([traction["load"]])));
    let compared = answer["simulation"]["films"].as_array().expect("films").clone();
    let own = compared.iter().find(|film| film["posture"] == "traction").expect("compared");
    let model = running.get("/api/studies/S1/model");
    let line = model["lines"].as_array().expect("lines").iter();
    let line = line.clone().find(|line| line["kind"] == "inflection_line").expect("a line");
    let film = line["postures"].as_array().expect("films").iter();
    let film = film.clone().find(|film| film["posture"] == "traction").expect("a film");
    let number = |value: &Value| value.as_f64().expect("a number");
    assert!((number(&own["mean_mm"]) - number(&film["mean_error_mm"])).abs() < SAME_MM);
    assert_eq!(own["errors"].as_array().map(Vec::len), Some(14));
}
