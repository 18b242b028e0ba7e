//! Marking by two clicks and by proposals.

use axum::http::StatusCode;
use serde_json::{Value, json};

use crate::demo::{app_with_demo, demo};
use crate::films::{add_unread_study, begin, record};

#[test]
fn a_vertebra_is_marked_by_its_walls_and_its_expected_corners_are_accepted() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let study = demo(&browser);
    let film = study["summary"]["films"][0]["film"].as_i64().expect("a number");
    let reading = begin(&browser, film);
    let wall = |level: &str, side: &str, column: f64, row: f64| json!({ "kind": "place_wall", "level": level, "side": side, "column_px": column, "row_px": row });
    // The patient's left is on the left of this picture.
    let walls = [
        wall("L4", "left", 900.0, 2060.0),
        wall("L4", "right", 1130.0, 2060.0),
        wall("L3", "left", 905.0, 1880.0),
        wall("L3", "right", 1125.0, 1880.0),
    ];
    let marked = record(&browser, reading, 0, json!(walls)).json()["reading"].clone();
    assert_eq!(marked["next_by_walls"], json!({ "kind": "wall", "level": "L2", "side": "left" }));
    assert_eq!(marked["next"]["level"], "L4", "no corner is placed");
    assert_eq!(marked["vertebrae"][0]["walls"]["left_px"], json!([900.0, 2060.0]));
    let proposals = marked["proposals"].as_array().expect("proposals");
    let levels: Vec<&str> = proposals.iter().filter_map(|one| one["level"].as_str()).collect();
    assert_eq!(levels[..3], ["L4", "L3", "L2"]);
    let sd = |index: usize| proposals[index]["sd_percent"].as_f64().expect("a number");
    assert!(sd(0) > 0.0 && sd(0) < sd(2), "{} and {}", sd(0), sd(2));

    let accepted: Vec<Value> = proposals[..2].iter().map(accepted_vertebra).collect();
    let event = json!([{ "kind": "accept_corners", "vertebrae": accepted }]);
    let whole = record(&browser, reading, 4, event).json()["reading"].clone();
    let origins = |reading: &Value, vertebra: usize| -> Vec<String> {
        let corners = reading["vertebrae"][vertebra]["corners"].as_array().expect("corners");
        let text = |corner: &Value| corner["origin"].as_str().expect("an origin").to_owned();
        corners.iter().map(text).collect()
    };
    assert_eq!(origins(&whole, 1), ["accepted"; 4]);
    assert_eq!(whole["vertebrae"][1]["complete"], true);
    assert_eq!(whole["undoable"], 5, "acceptance is one change");
    let moved = json!([{ "kind": "move_corner", "level": "L3", "corner": "superior_left", "column_px": 906.0, "row_px": 1820.0 }]);
    let moved = record(&browser, reading, 5, moved).json()["reading"].clone();
    assert_eq!(origins(&moved, 0), ["accepted"; 4]);
    // Around the body from the patient's superior left, which was moved.
    assert_eq!(origins(&moved, 1), ["adjusted", "accepted", "accepted", "accepted"]);

    let mut short = accepted[0].clone();
    short["corners"].as_object_mut().expect("corners").remove("superior_left");
    let refused =
        record(&browser, reading, 6, json!([{ "kind": "accept_corners", "vertebrae": [short] }]));
    assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", refused.text());
}

/// A proposal in the form of an accepted vertebra.
fn accepted_vertebra(proposal: &Value) -> Value {
    let corners = proposal["corners"].as_array().expect("corners").iter();
    let named =
        corners.map(|one| (one["corner"].as_str().expect("a name").to_owned(), one["px"].clone()));
    json!({ "level": proposal["level"], "corners": named.collect::<serde_json::Map<_, _>>() })
}

/// The events that mark the crests as another reading has them.
fn crests_of(reading: &Value) -> Value {
    json!(["left", "right"].map(|side| {
        let place = &reading["crests"][format!("{side}_px")];
        json!({ "kind": "place_iliac_crest", "side": side, "column_px": place[0], "row_px": place[1] })
    }))
}

#[test]
fn vertebrae_are_found_in_the_picture_and_accepted_with_their_deviation() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let study = demo(&browser);
    let film = study["summary"]["films"][0]["film"].as_i64().expect("a number");
    let reading = begin(&browser, film);
    let found = browser.post(&format!("/api/readings/{reading}/detection"), &json!(null)).json();
    // The networks were not trained on drawn films: the film may be refused, or else its levels are doubted.
    if let Some(refused) = found["refused"].as_str() {
        assert!(refused.contains("no frontal spine") && found["proposals"] == json!([]), "{found}");
        return;
    }
    assert_eq!(found["are_levels_doubtful"], true, "{found}");
    let proposals = found["proposals"].as_array().expect("proposals");
    assert!(proposals.len() >= 12);
    assert_eq!(browser.get(&format!("/api/readings/{reading}")).json()["revision"], 0);
    let read = study["summary"]["films"][0]["readings"][0]["reading"].as_i64().expect("a number");
    let events = crests_of(&browser.get(&format!("/api/readings/{read}")).json());
    assert_eq!(record(&browser, reading, 0, events).status, StatusCode::OK);
    let with = browser.post(&format!("/api/readings/{reading}/detection"), &json!(null)).json();
    let percent = |found: &Value| -> u32 {
        let levels = found["levels"].as_str().expect("a text");
        levels.split(' ').next().and_then(|text| text.parse().ok()).expect("percent")
    };
    assert!(percent(&with) > percent(&found), "crests name the vertebrae: {with}");
    let sd = proposals[0]["sd_share"].as_f64().expect("a deviation");
    let mut accepted = accepted_vertebra(&proposals[0]);
    accepted["sd_share"] = sd.into();
    let event = json!([{ "kind": "accept_corners", "vertebrae": [accepted] }]);
    let whole = record(&browser, reading, 2, event).json()["reading"].clone();
    assert_eq!(whole["vertebrae"][0]["corners"][0]["origin"], "accepted");
}

#[test]
fn a_plan_without_proposals_shows_none_and_takes_none() {
    let app = app_with_demo();
    let lead = app.observer("Ann");
    add_unread_study(&app);
    let plan = json!({ "observers": ["Bob"], "repeats": 1, "washout_days": 0, "proposals": false });
    assert_eq!(lead.post("/api/studies/blind/plan", &plan).status, StatusCode::OK);
    let reader = app.observer("Bob");
    let detail = reader.get("/api/studies/blind").json();
    let code = detail["plan"]["next"]["code"].as_str().expect("a code");
    let begun = reader.post(&format!("/api/codes/{code}/readings"), &Value::Null).json();
    let reading = begun["reading"].as_i64().expect("a number");
    assert_eq!(begun["proposals_allowed"], false);
    let place = |name: &str, column: f64, row: f64| json!({ "kind": "place_corner", "level": "L4", "corner": name, "column_px": column, "row_px": row });
    let corners = [
        place("superior_left", 900.0, 2000.0),
        place("superior_right", 1130.0, 2000.0),
        place("inferior_left", 900.0, 2120.0),
        place("inferior_right", 1130.0, 2120.0),
    ];
    let marked = record(&reader, reading, 0, json!(corners)).json()["reading"].clone();
    assert_eq!(marked["proposals"], json!([]));
    assert_eq!(marked["next_by_walls"], Value::Null);
    let wall = json!([{ "kind": "place_wall", "level": "L3", "side": "left", "column_px": 900.0, "row_px": 1880.0 }]);
    assert_eq!(record(&reader, reading, 4, wall).status, StatusCode::UNPROCESSABLE_ENTITY);
    let found = reader.post(&format!("/api/readings/{reading}/detection"), &Value::Null);
    assert_eq!(found.status, StatusCode::FORBIDDEN);
}

#[test]
fn a_bend_is_completed_from_ten_clicks_and_the_erect_film() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let study = demo(&browser);
    let films = study["summary"]["films"].as_array().expect("films");
    let bend = films.iter().find(|film| film["posture"] == "left_bending").expect("a bend");
    // A finished reading of the bend by another reader.
    let truth = browser.get(&format!("/api/readings/{}", bend["readings"][0]["reading"])).json();
    let corner = |level: &Value, name: String, axis: usize| {
        let vertebrae = truth["vertebrae"].as_array().expect("vertebrae");
        let body = vertebrae.iter().find(|one| one["level"] == *level).expect("a vertebra");
        let corners = body["corners"].as_array().expect("corners");
        let own = corners.iter().find(|one| one["corner"] == *name).expect("a corner");
        own["px"][axis].as_f64().expect("a number")
    };
    let reading = begin(&browser, bend["film"].as_i64().expect("a number"));
    let mut marked = browser.get(&format!("/api/readings/{reading}")).json();
    assert!(marked["erect"].is_i64(), "{marked}");
    let mut asked = Vec::new();
    for click in 0..10 {
        let next = marked["next_by_walls"].clone();
        let side = next["side"].as_str().expect("a side");
        let middle = |axis| {
            let at = |end: &str| corner(&next["level"], format!("{end}_{side}"), axis);
            f64::midpoint(at("superior"), at("inferior"))
        };
        let wall = json!([{ "kind": "place_wall", "level": next["level"], "side": side,
            "column_px": middle(0), "row_px": middle(1) }]);
        marked = record(&browser, reading, click, wall).json()["reading"].clone();
        asked.push(next["level"].as_str().expect("a level").to_owned());
    }
    asked.dedup();
    assert_eq!(asked, ["L4", "L1", "T9", "T5", "T2"]);
    let proposals = marked["proposals"].as_array().expect("proposals");
    let sure: Vec<&Value> = proposals.iter().filter(|one| one["is_sure"] == true).collect();
    assert_eq!(sure.len(), 10);
    let height = |level: &Value| {
        let at = |end: &str, axis| corner(level, format!("{end}_left"), axis);
        let [across, along] = [0, 1].map(|axis| at("superior", axis) - at("inferior", axis));
        across.hypot(along)
    };
    for one in &sure {
        for own in one["corners"].as_array().expect("corners") {
            let name = own["corner"].as_str().expect("a name");
            let [across, along] = [0, 1].map(|axis| {
                own["px"][axis].as_f64().expect("a number")
                    - corner(&one["level"], name.to_owned(), axis)
            });
            assert!(across.hypot(along) < 0.2 * height(&one["level"]), "{one}");
        }
    }
    let misfits = browser.post(&format!("/api/readings/{reading}/misfits"), &json!(null)).json();
    assert_eq!(misfits, json!({ "levels": [] }), "the drawn bend shows its vertebrae");
    let accepted: Vec<Value> = sure.into_iter().map(accepted_vertebra).collect();
    let event = json!([{ "kind": "accept_corners", "vertebrae": accepted }]);
    let whole = record(&browser, reading, 10, event).json()["reading"].clone();
    let widths = whole["vertebrae"].as_array().expect("vertebrae").iter();
    let widths: Vec<f64> = widths.filter_map(|one| one["erect_width_percent"].as_f64()).collect();
    assert!(widths.len() == 10 && widths.iter().all(|width| (85.0..115.0).contains(width)));

    let found = browser.post(&format!("/api/readings/{reading}/detection"), &json!(null)).json();
    let matched = found["levels"].as_str().expect("a match");
    assert!(matched.starts_with("matched to the erect film; second best puts"), "{matched}");
    assert_eq!(record(&browser, reading, 11, crests_of(&truth)).status, StatusCode::OK);
    let found = browser.post(&format!("/api/readings/{reading}/detection"), &json!(null)).json();
    let matched = found["levels"].as_str().expect("a match");
    assert!(matched.starts_with("matched to the erect film and the crests; second"), "{matched}");
}
