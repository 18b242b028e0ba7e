//! Intervals under loads in the background: progress, cancel, their loads, and their place in the saved file.

use axum::http::StatusCode;
use serde_json::{Value, json};
use spineline::action::LineKind;
use spineline::uncertainty::{AppliedLoads, LandmarkNoise, MonteCarlo};
use spineline_files::{
    ModelSource, Simulated, parse_analysis, parse_load, parse_model, results_text,
};
use spineline_store::Access;

use super::server::{READER, add_read_study, phantom};
use crate::browser::{App, Browser, changed_options, options};

const LOADS: &str = "/api/studies/S1/loads/inflection_line";
const PATH: &str = "/api/studies/S1/loads/inflection_line/intervals";
const COUNT: u64 = 60;

/// The text of a load file with one force at T2.
fn push(left: f64, up: f64) -> String {
    let load = json!({ "kind": "force_at_point", "level": "T2", "force": [0.0, left, up] });
    json!({ "format": "spineline-load", "version": 1, "loads": [load] }).to_string()
}

fn request(count: u64, file: &str) -> Value {
    json!({ "count": count, "file": file })
}

fn app() -> App {
    App::new(Access::Token, |store| add_read_study(store, "S1", &phantom().case))
}

#[test]
fn intervals_are_computed_for_the_loads_that_were_sent_and_saved_with_no_others() {
    let app = app();
    let lead = app.observer(READER);
    let none = lead.get(PATH).json();
    assert_eq!((&none["state"], &none["file"]), (&json!("none"), &json!("")));
    let file = push(10.0, 0.0);
    for count in [0, 2001] {
        let refused = lead.post(PATH, &request(count, &file));
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
    }
    let begun = lead.post(PATH, &request(COUNT, &file)).json();
    assert_eq!((begun["asked"].as_u64(), begun["file"].as_str()), (Some(COUNT), Some(&*file)));
    let done = lead.ended(PATH);
    assert_eq!((&done["state"], &done["done"]), (&json!("done"), &json!(COUNT)), "{done}");

    // A row for each row of the table of angles, with an interval for each number.
    let answer = lead.post(LOADS, &serde_json::from_str::<Value>(&file).expect("JSON")).json();
    let table = answer["simulation"]["angles"]["rows"].as_array().expect("rows").clone();
    let rows = done["rows"].as_array().expect("rows");
    let labels = |rows: &[Value], key: &str| -> Vec<Value> {
        rows.iter().map(|row| row.pointer(key).expect("a label").clone()).collect()
    };
    assert_eq!(labels(rows, "/label"), labels(&table, "/0"));
    for row in rows {
        let intervals = row["intervals"].as_array().expect("intervals");
        assert_eq!(intervals.len(), 3);
        let is_interval = |one: &Value| one.as_str().is_some_and(|text| text.contains(" to "));
        assert!(intervals.iter().all(is_interval), "{row}");
    }
    let texts = done["texts"].to_string();
    assert!(texts.contains(&format!("with a result, {COUNT} of {COUNT} (seed 1)")), "{texts}");
    assert!(texts.contains("do not cover the errors of the model"), "{texts}");
    saved_with_the_intervals_of_the_command_line(&lead, &file);

    // Intervals of other loads or of another line are not saved.
    let other = serde_json::from_str(&push(11.0, 0.0)).expect("JSON");
    let saved = lead.post(&format!("{LOADS}/simulation"), &other).json();
    assert_eq!(saved["uncertainty"], Value::Null);
    let of_other_line = "/api/studies/S1/loads/iliac_line/intervals";
    assert_eq!(lead.get(of_other_line).json()["state"], "none");

    // They are kept over a restart, for these landmarks and options.
    let app = app.restarted(options(Access::Token));
    let lead = app.observer(READER);
    saved_with_the_intervals_of_the_command_line(&lead, &file);
    assert_eq!(lead.get(PATH).json(), done);
    assert_eq!(lead.get(of_other_line).json()["state"], "none");
    let change = changed_options(0, &[("support", "free")]);
    lead.put("/api/studies/S1/options", &change).succeeded();
    assert_eq!(lead.get(PATH).json()["state"], "none");
}

/// Oracle: the library with the files that are saved, as `simulate --replicates` does.
fn saved_with_the_intervals_of_the_command_line(lead: &Browser<'_>, file: &str) {
    let loads = serde_json::from_str::<Value>(file).expect("JSON");
    let saved = lead.post(&format!("{LOADS}/simulation"), &loads).json();
    assert_eq!(saved["provenance"]["replicates"]["count"], COUNT);
    let model = parse_model(&lead.get(&format!("{LOADS}/model")).text()).expect("a model");
    let analysis = lead.get("/api/studies/S1/exports/analysis").text();
    let case = parse_analysis(&analysis).expect("an analysis").case;
    let source = ModelSource::of(&model, &case).expect("the case of this model");
    assert_eq!(source.kind, LineKind::Inflection);
    let loads = parse_load(file).expect("loads");
    let own = Simulated::at_full_load(model.model, loads).expect("sound loads");
    let film = Some(&source.analysis.movement.erect().outline);
    let measures =
        spineline::response::loaded_measures(&own.model.spine, &own.places, film, &own.response);
    let applied = AppliedLoads {
        kind: source.kind,
        support: own.model.support,
        loading: &own.placed.loading,
        goal: spineline::multibody::Goal::FullLoad,
        largest_factor: None,
    };
    let noise = LandmarkNoise::Measured;
    let monte_carlo = MonteCarlo::new(&case, &source.analysis, noise, 1).expect("sound noise");
    let mut tally = monte_carlo.loaded_tally(&measures);
    (0..COUNT).for_each(|index| tally.add(&monte_carlo.loaded_replicate(index, &applied)));
    let own = own.file("test").with_uncertainty(&tally.finish(COUNT));
    let own: Value = serde_json::from_str(&results_text(&own)).expect("JSON");
    assert_eq!(saved["uncertainty"], own["uncertainty"]);
}

#[test]
fn intervals_are_cancelled_and_computed_once_at_a_time() {
    let app = app();
    let lead = app.observer(READER);
    let file = push(10.0, 0.0);
    assert_eq!(lead.post(PATH, &request(2000, &file)).status, StatusCode::OK);
    let twice = lead.post(PATH, &request(5, &push(5.0, 0.0)));
    assert_eq!((twice.status, twice.code().as_str()), (StatusCode::CONFLICT, "running"));
    assert_eq!(lead.delete(PATH).status, StatusCode::OK);
    let cancelled = lead.ended(PATH);
    assert_eq!((&cancelled["state"], &cancelled["rows"]), (&json!("cancelled"), &json!([])));
    assert!(cancelled["done"].as_u64().is_some_and(|done| done < 2000), "{cancelled}");
}

#[test]
fn loads_that_cannot_be_applied_are_refused_and_those_without_a_result_are_counted() {
    let app = app();
    let lead = app.observer(READER);
    let on_base = push(10.0, 0.0).replace("T2", "L4");
    for (file, words) in [("{}", "spineline-load"), (&on_base, "L4 is the fixed vertebra")] {
        let refused = lead.post(PATH, &request(5, file));
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert!(refused.text().contains(words), "{}", refused.text());
    }
    assert_eq!(lead.post(PATH, &request(4, &push(0.0, -9000.0))).status, StatusCode::OK);
    let done = lead.ended(PATH);
    assert_eq!((&done["state"], &done["rows"]), (&json!("done"), &json!([])), "{done}");
    let texts = done["texts"].to_string();
    assert!(texts.contains("with a result, 0 of 4"), "{texts}");
    assert!(texts.contains("Without a result, and in no interval: `"), "{texts}");
}
