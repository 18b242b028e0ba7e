//! Studies that are renamed, archived and extended, and who may withdraw a reading.

use axum::http::StatusCode;
use serde_json::{Value, json};

use crate::browser::{Answer, App, Browser, by, name};
use crate::demo::{app_with_demo, demo};
use crate::films::{add_unread_study, demo_film, upload};

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
    let mut store = spineline_store::Store::open(&app.store_path()).expect("a store");
    store
        .grant(&name("S-2"), &name("editor"), spineline_store::Role::Editor, &by("lead"))
        .expect("a grant");
    let begun = editor.post("/api/films/1/readings", &json!({ "repeat": 1 })).json();
    let own = begun["reading"].as_i64().expect("a number");
    let withdraw = |browser: &Browser<'_>, reading: i64| {
        let reason = json!({ "reason": "another patient" });
        browser.post(&format!("/api/readings/{reading}/withdrawal"), &reason)
    };
    // Reading 1 is of the lead.
    assert_eq!(withdraw(&editor, 1).status, StatusCode::FORBIDDEN);
    let withdrawn = withdraw(&editor, own);
    assert_eq!(withdrawn.json()["withdrawn"]["reason"], "another patient");
    assert_eq!(withdraw(&lead, own).code(), "withdrawn");
    assert_eq!(withdraw(&lead, 1).status, StatusCode::OK);
    let own = lead.post("/api/films/1/readings", &json!({ "repeat": 1 })).json();
    assert_eq!(withdraw(&lead, own["reading"].as_i64().expect("a number")).status, StatusCode::OK);
}

#[test]
fn films_are_added_to_a_study_once_and_not_to_a_planned_one() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    demo(&browser);
    let film = |number: usize, posture: &str| {
        let view = upload(&browser, demo_film(&app, number)).json();
        json!({ "upload": view["upload"], "posture": posture, "patient_left": "image_left",
            "scale": { "kind": "file" } })
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
    let added = add(json!([film(1, "left_bending"), film(2, "right_bending")]));
    assert_eq!(added.status, StatusCode::OK, "{}", added.text());
    let films = added.json()["summary"]["films"].as_array().expect("films").len();
    assert_eq!(films, 3);

    add_unread_study(&app);
    let plan = json!({ "observers": ["Bob"], "repeats": 1, "washout_days": 0, "proposals": false });
    assert_eq!(browser.post("/api/studies/blind/plan", &plan).status, StatusCode::OK);
    let late = json!({ "films": [film(3, "neutral")] });
    let refused = browser.post("/api/studies/blind/films", &late);
    assert!(refused.text().contains("has a reading plan"), "{}", refused.text());
}
