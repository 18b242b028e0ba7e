//! Pads in the background: progress, cancel, and a map whose numbers hold when its pads are applied.

use axum::http::StatusCode;
use serde_json::{Value, json};
use spineline_store::Access;

use super::server::{READER, add_read_study, phantom};
use crate::browser::{App, Browser};

const LOADS: &str = "/api/studies/S1/loads/inflection_line";
const PATH: &str = "/api/studies/S1/loads/inflection_line/pad-map";

#[test]
fn pads_are_tried_shown_and_cancelled() {
    let app = App::new(Access::Token, |store| add_read_study(store, "S1", &phantom().case));
    let lead = app.observer(READER);
    assert_eq!(lead.get(PATH).json()["state"], "none");
    for (force, stiffness) in [(0.0, 2.0), (40.0, -1.0), (1e9, 2.0)] {
        let request = json!({ "largest_force": force, "force_per_mm": stiffness });
        assert_eq!(lead.post(PATH, &request).status, StatusCode::UNPROCESSABLE_ENTITY);
    }
    let request = json!({ "largest_force": 30.0, "force_per_mm": 2.0 });
    let begun = lead.post(PATH, &request);
    assert_eq!((begun.status, begun.json()["asked"].as_u64()), (StatusCode::OK, Some(112)));
    let done = lead.ended(PATH);
    assert_eq!((&done["state"], &done["done"]), (&json!("done"), &json!(112)), "{done}");
    let rows = done["rows"].as_array().expect("rows");
    assert_eq!(
        (rows.len(), &rows[0]["level"], &rows[13]["level"]),
        (14, &json!("T2"), &json!("L3"))
    );
    assert_eq!(done["columns"].as_array().map(Vec::len), Some(8));
    assert_eq!(done["columns"][7], json!({ "towards": "left", "force": "30" }));

    let best = best_cell(&done);
    check_cell(&lead, &best, &[]);

    // The next pad beside the first one.
    let first = best["load"].clone();
    let request = json!({ "largest_force": 20.0, "force_per_mm": 2.0, "beside": [first] });
    assert_eq!(lead.post(PATH, &request).status, StatusCode::OK);
    let done = lead.ended(PATH);
    assert!(done["texts"].to_string().contains("beside the one load that the plan had"), "{done}");
    check_cell(&lead, &best_cell(&done), &[first]);
}

#[test]
fn loads_that_cannot_stand_beside_a_pad_are_refused() {
    let app = App::new(Access::Token, |store| add_read_study(store, "S1", &phantom().case));
    let lead = app.observer(READER);
    let force = |level: &str, up: f64| {
        let beside = json!({ "kind": "force_at_point", "level": level, "force": [0.0, 0.0, up],
            "point_in_vertebra_mm": [0.0, 0.0, 0.0] });
        json!({ "largest_force": 20.0, "force_per_mm": 2.0, "beside": [beside] })
    };
    let refused = lead.post(PATH, &force("L4", 1.0));
    assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert!(refused.text().contains("L4"), "{}", refused.text());
    assert_eq!(lead.post(PATH, &force("T2", -1e6)).status, StatusCode::OK);
    let failed = lead.ended(PATH);
    assert_eq!(failed["state"], "failed", "{failed}");
    assert!(failed["texts"][0].as_str().is_some_and(|text| text.contains("no result")), "{failed}");
}

/// The cell that corrects most.
fn best_cell(done: &Value) -> Value {
    let rows = done["rows"].as_array().expect("rows");
    let cells = rows.iter().flat_map(|row| row["cells"].as_array().expect("cells"));
    let best = cells.filter(|cell| cell["part"].is_number());
    let best =
        best.min_by(|a, b| a["part"].as_f64().partial_cmp(&b["part"].as_f64()).expect("numbers"));
    let best = best.expect("a cell with a result");
    assert!(best["part"].as_f64().is_some_and(|part| part < 0.0), "some pad corrects the curve");
    best.clone()
}

/// The pad of a cell, applied as a spring, changes the curve as the cell says.
fn check_cell(lead: &Browser<'_>, cell: &Value, others: &[Value]) {
    let loads: Vec<&Value> = others.iter().chain([&cell["load"]]).collect();
    let file = json!({ "format": "spineline-load", "version": 1, "loads": loads });
    let answer = lead.post(LOADS, &file).json();
    let steps = answer["simulation"]["steps"].as_array().expect("steps").clone();
    let after = steps.last().expect("the result")["text"].as_str().expect("text");
    // Such as `30 to the patient's left on T8: Main thoracic Cobb angle 31.2° instead of 34.4°`.
    let title = cell["title"].as_str().expect("a title");
    let (_, told) = title.split_once(": ").expect("pad and angles");
    let (told, _) = told.split_once(" instead of ").expect("both angles");
    assert!(after.starts_with(told), "{after} does not begin with {told}");
    let forces = answer["simulation"]["forces"]["rows"].to_string();
    assert!(forces.contains("30.0 ") || !title.starts_with("30 "), "{forces}");
}

#[test]
fn a_cancelled_map_shows_no_numbers() {
    let app = App::new(Access::Token, |store| add_read_study(store, "S1", &phantom().case));
    let lead = app.observer(READER);
    let request = json!({ "largest_force": 60.0, "force_per_mm": 2.0 });
    assert_eq!(lead.post(PATH, &request).status, StatusCode::OK);
    assert_eq!(lead.delete(PATH).status, StatusCode::OK);
    let view = lead.ended(PATH);
    // On a fast machine it may have finished before.
    if view["state"] == "cancelled" {
        assert_eq!((&view["rows"], &view["columns"]), (&json!([]), &json!([])));
    } else {
        assert_eq!(view["done"], view["asked"]);
    }
}
