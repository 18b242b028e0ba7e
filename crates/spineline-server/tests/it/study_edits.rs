//! Studies that are renamed, archived and extended, and who may withdraw a reading.

use axum::http::StatusCode;
use serde_json::{Value, json};
use spineline::anatomy::Posture;
use spineline_store::{Role, Store};

use crate::browser::{Answer, App, Browser, by, changed_options, name};
use crate::demo::{app_with_demo, demo};
use crate::films::{add_unread_study, begin, demo_film, upload, uploaded_film};

fn edit(browser: &Browser<'_>, study: &str, revision: u64, edit: Value) -> Answer {
    let body = json!({ "expected_revision": revision, "edit": edit });
    browser.post(&format!("/api/studies/{study}/edits"), &body)
}

#[test]
fn a_study_is_renamed_archived_and_restored_by_who_may_edit_it() {
    let app = App::with_accounts();
    let (editor, reader) = (app.account("editor"), app.account("reader"));
    let label = json!({ "kind": "label", "label": "before brace" });
    assert_eq!(edit(&reader, "S-1", 0, label.clone()).status, StatusCode::FORBIDDEN);
    let renamed = edit(&editor, "S-1", 0, label);
    assert_eq!(renamed.json()["summary"]["label"], "before brace", "{}", renamed.text());
    let stale = edit(&editor, "S-1", 0, json!({ "kind": "archived", "archived": true }));
    assert_eq!((stale.status, stale.code().as_str()), (StatusCode::CONFLICT, "conflict"));
    let lost = editor.get("/api/studies/S-1").json()["conflicts"].clone();
    assert_eq!(lost[0]["text"], "study archived");
    let archived = edit(&editor, "S-1", 1, json!({ "kind": "archived", "archived": true }));
    assert_eq!(archived.json()["summary"]["archived"], true);
    let refused = editor.post("/api/films/1/readings", &json!({ "repeat": 1 }));
    assert_eq!((refused.status, refused.code().as_str()), (StatusCode::CONFLICT, "archived"));
    assert_eq!(editor.get("/api/studies").json()[0]["archived"], true);
    assert_eq!(editor.get("/api/cohort").json()["rows"], json!([]));
    let options = editor.get("/api/studies/S-1/options").json();
    assert_eq!(options["may_change"], false);
    edit(&editor, "S-1", 2, json!({ "kind": "archived", "archived": false }));
    assert_eq!(editor.get("/api/cohort").json()["rows"].as_array().map(Vec::len), Some(1));
}

#[test]
fn a_reading_is_withdrawn_by_its_observer_or_an_admin() {
    let app = App::with_accounts();
    let (lead, editor) = (app.account("lead"), app.account("editor"));
    let mut store = Store::open(&app.store_path()).expect("a store");
    store.grant(&name("S-2"), &name("editor"), Role::Editor, &by("lead")).expect("a grant");
    let image = json!({ "columns": 10, "rows": 10, "patient_left": "image_left" });
    let added = store.add_film(&name("S-2"), Posture::Neutral, b"a film", &image, &by("lead"));
    let film = added.expect("a film").0;
    let begin_repeat = |browser: &Browser<'_>, film: i64, repeat: u32| {
        let path = format!("/api/films/{film}/readings");
        let begun = browser.post(&path, &json!({ "repeat": repeat })).json();
        begun["reading"].as_i64().expect("a number")
    };
    let withdraw = |browser: &Browser<'_>, reading: i64| {
        let reason = json!({ "reason": "another patient" });
        browser.post(&format!("/api/readings/{reading}/withdrawal"), &reason)
    };
    let (own, other) = (begin_repeat(&editor, film, 1), begin_repeat(&lead, film, 1));
    assert_eq!(withdraw(&editor, other).status, StatusCode::FORBIDDEN);
    let withdrawn = withdraw(&editor, own);
    assert_eq!(withdrawn.json()["withdrawn"]["reason"], "another patient");
    assert_eq!(withdraw(&lead, own).code(), "withdrawn");
    let second = begin_repeat(&editor, film, 2);
    assert_eq!(withdraw(&lead, second).json()["withdrawn"]["who"], "lead");
}

#[test]
fn films_are_added_to_a_study_once_and_not_to_a_planned_one() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    demo(&browser);
    let film = |number: usize, posture: &str| {
        uploaded_film(&upload(&browser, demo_film(&app, number)).json()["upload"], posture)
    };
    let new = json!({ "id": "S-1", "label": null, "films": [film(0, "erect")] });
    assert_eq!(browser.post("/api/studies", &new).status, StatusCode::OK);
    let add = |films: Value| browser.post("/api/studies/S-1/films", &json!({ "films": films }));
    let twice = add(json!([film(1, "erect")]));
    assert_eq!(twice.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert!(twice.text().contains("the study has two erect films"), "{}", twice.text());
    let same = add(json!([film(0, "neutral")]));
    assert!(same.text().contains("are the same picture"), "{}", same.text());
    assert!(add(json!([])).text().contains("has no film"));
    let added = add(json!([film(1, "left_bending"), film(2, "right_bending")])).succeeded();
    let films = added.json()["summary"]["films"].as_array().expect("films").len();
    assert_eq!(films, 3);

    add_unread_study(&app);
    let plan = json!({ "observers": ["Bob"], "repeats": 1, "washout_days": 0, "proposals": false });
    assert_eq!(browser.post("/api/studies/blind/plan", &plan).status, StatusCode::OK);
    let late = json!({ "films": [film(3, "neutral")] });
    let refused = browser.post("/api/studies/blind/films", &late);
    assert!(refused.text().contains("has a reading plan"), "{}", refused.text());
}

#[test]
fn the_side_of_the_patient_is_corrected_before_a_film_is_read_and_a_scale_is_entered() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    add_unread_study(&app);
    let film = browser.get("/api/studies/blind").json()["summary"]["films"][0].clone();
    let number = film["film"].as_i64().expect("a number");
    let edit = |revision: u64, edit: Value| {
        let body = json!({ "expected_revision": revision, "edit": edit });
        browser.post(&format!("/api/films/{number}/edits"), &body)
    };
    let side = &film["image"]["patient_left"];
    let other = if side == "image_left" { "image_right" } else { "image_left" };
    let side = json!({ "kind": "patient_left", "patient_left": other });
    assert_eq!(edit(0, side.clone()).json()["image"]["patient_left"], other);
    let stated =
        |mm: f64| json!({ "kind": "stated", "column_mm": mm, "row_mm": mm, "plane": "patient" });
    assert_eq!(edit(1, stated(0.25)).json()["row_mm"], 0.25);
    assert_eq!(edit(2, stated(2000.0)).status, StatusCode::UNPROCESSABLE_ENTITY);
    begin(&browser, number);
    let refused = edit(2, side);
    assert_eq!((refused.status, refused.code().as_str()), (StatusCode::CONFLICT, "has_reading"));
    assert_eq!(edit(2, stated(0.2)).json()["row_mm"], 0.2, "a scale holds for all readings");
}

#[test]
fn a_lost_change_of_model_options_is_shown_with_the_study() {
    let app = App::with_accounts();
    let editor = app.account("editor");
    let change = |options: &[(&str, &str)]| {
        editor.put("/api/studies/S-1/options", &changed_options(0, options))
    };
    change(&[("support", "free")]).succeeded();
    for options in [&[("fit", "ferguson"), ("support", "free")][..], &[("support", "frontal")]] {
        assert_eq!(change(options).code(), "conflict");
    }
    let lost = editor.get("/api/studies/S-1").json()["conflicts"].clone();
    assert_eq!(lost[0]["text"], "model options: Support: free; Fitted to: ferguson");
    assert_eq!((&lost[0]["who"], &lost[0]["base_revision"]), (&json!("editor"), &json!(0)));
    assert_eq!(lost[1]["text"], "all model options at their defaults");
}

#[test]
fn a_lost_shape_of_pixels_is_not_told_in_millimetres() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    add_unread_study(&app);
    let film = browser.get("/api/studies/blind").json()["summary"]["films"][0]["film"].clone();
    let edit = |edit: Value| {
        let body = json!({ "expected_revision": 0, "edit": edit });
        browser.post(&format!("/api/films/{film}/edits"), &body)
    };
    edit(json!({ "kind": "inverted", "inverted": true })).succeeded();
    for (column, row, plane) in [(1.0, 2.0, "pixels"), (0.2, 0.25, "patient")] {
        let stated =
            json!({ "kind": "stated", "column_mm": column, "row_mm": row, "plane": plane });
        assert_eq!(edit(stated).code(), "conflict");
    }
    let lost = browser.get("/api/studies/blind").json()["conflicts"].clone();
    assert_eq!(lost[0]["text"], "erect film: pixels 2.000 times as high as wide");
    assert_eq!(lost[1]["text"], "erect film: scale to 0.200 mm × 0.250 mm per pixel");
}
