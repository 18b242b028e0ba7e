//! Permissions per study.

use axum::http::StatusCode;
use serde_json::json;
use spineline_server::User;
use spineline_store::{NewCase, Role, Store, Study};

use crate::browser::{App, by, name};

const GRANTS: &str = "/api/studies/S-1/grants";

#[test]
fn admins_add_and_remove_grants() {
    let app = App::with_accounts();
    let lead = app.account("lead");
    let both =
        json!([{ "name": "editor", "role": "editor" }, { "name": "reader", "role": "reader" }]);
    assert_eq!(lead.get(GRANTS).json(), both);
    for who in ["editor", "reader"] {
        let answer = app.account(who).get(GRANTS);
        assert_eq!((answer.status, answer.code().as_str()), (StatusCode::FORBIDDEN, "not_allowed"));
    }
    let one = json!([{ "name": "ungranted", "role": "reader" }]);
    assert_eq!(lead.put(GRANTS, &one).json(), one);
    assert_eq!(app.account("ungranted").get(GRANTS).status, StatusCode::FORBIDDEN, "now there");
    assert_eq!(app.account("editor").get(GRANTS).status, StatusCode::NOT_FOUND, "gone");
    for bad in [
        json!([{ "name": "stranger", "role": "reader" }]),
        json!([{ "name": "editor", "role": "admin" }]),
        json!([{ "name": "not a name", "role": "reader" }]),
    ] {
        assert_eq!(lead.put(GRANTS, &bad).status, StatusCode::UNPROCESSABLE_ENTITY, "{bad}");
    }
    assert_eq!(lead.get(GRANTS).json(), one, "refused as a whole");
    assert_eq!(lead.put(GRANTS, &both).json(), both, "and granted again");
    assert_eq!(lead.get("/api/studies/S-99/grants").status, StatusCode::NOT_FOUND);
    let store = Store::view(&app.store_path()).expect("a store");
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn the_role_in_a_study_is_the_lower_of_account_and_grant() {
    let app = App::with_accounts();
    let mut store = Store::open(&app.store_path()).expect("a store");
    let study = name("S-1");
    store.grant(&study, &name("reader"), Role::Editor, &by("lead")).expect("a grant");
    let user = |who: &str, role| User { name: name(who), role };
    let on = |store: &Store, who, role| user(who, role).on_study(store, &study).ok();
    assert_eq!(on(&store, "reader", Role::Reader), Some(Role::Reader));
    assert_eq!(on(&store, "editor", Role::Editor), Some(Role::Editor));
    assert_eq!(on(&store, "ungranted", Role::Editor), None);
    assert_eq!(on(&store, "lead", Role::Admin), Some(Role::Admin));
    let reader = user("reader", Role::Reader);
    assert!(reader.need_on_study(&store, &study, Role::Reader).is_ok());
    assert!(reader.need_on_study(&store, &study, Role::Editor).is_err());
    let seen = reader.studies(&store).expect("studies");
    assert_eq!(seen.len(), 1);
    assert_eq!((seen[0].0.id.as_str(), seen[0].1), ("S-1", Role::Reader));
    assert_eq!(user("lead", Role::Admin).studies(&store).expect("studies").len(), 2);
}

#[test]
fn the_creator_of_a_study_may_edit_it() {
    let app = App::with_accounts();
    let mut store = Store::open(&app.store_path()).expect("a store");
    let study = Study::new(name("S-3"), None, true);
    store.add_own_case(&NewCase::of(study.clone()), &by("ungranted")).expect("a study");
    let maker = User { name: name("ungranted"), role: Role::Editor };
    assert_eq!(maker.on_study(&store, &study.id), Ok(Role::Editor));
    store.revoke(&study.id, &name("ungranted"), &by("lead")).expect("taken back");
    assert!(maker.on_study(&store, &study.id).is_err());
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn a_reader_of_a_study_cannot_place_landmarks() {
    let app = App::with_accounts();
    let begun =
        |who: &str| app.account(who).post("/api/films/1/readings", &json!({ "repeat": 1 })).status;
    assert_eq!(begun("reader"), StatusCode::FORBIDDEN);
    let event = json!({ "kind": "note", "text": "not by me" });
    let body = json!({ "expected_revision": 0, "events": [event] });
    // The reading of another observer in a study that they do not see.
    let answer = app.account("reader").post("/api/readings/1/events", &body);
    assert_eq!(answer.status, StatusCode::NOT_FOUND);
}

#[test]
fn observers_of_a_plan_need_accounts_that_may_edit() {
    let app = App::with_accounts();
    let lead = app.account("lead");
    let plan = |observer: &str| {
        let body = json!({ "observers": [observer], "repeats": 1, "washout_days": 0 });
        lead.post("/api/studies/S-1/plan", &body)
    };
    for (observer, why) in [
        ("stranger", "has no account"),
        ("reader", "may not place landmarks"),
        ("ungranted", "may not place landmarks"),
    ] {
        let answer = plan(observer);
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{observer}");
        assert_eq!(answer.code(), "observer");
        assert!(answer.text().contains(why), "{}", answer.text());
    }
    let refused = app.account("editor").post("/api/studies/S-1/plan", &json!({}));
    assert_ne!(refused.status, StatusCode::OK, "plans are made by admins");
    assert_eq!(plan("editor").status, StatusCode::OK);
}
