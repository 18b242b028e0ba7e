//! Blinded readings over HTTP: access after a role was removed, and the view of an observer.

use axum::http::{Method, StatusCode};
use serde_json::{Value, json};
use spineline::anatomy::Posture;
use spineline_store::{Access, Account, AccountChange, PasswordHash, Role, Store, Study};

use crate::browser::{App, Browser, PASSWORD, by, name};

const STUDY: &str = "/api/studies/B-1";
const LABEL: &str = "ZqLabelCanary";
/// A column that is in one finished reading only.
const COLUMN_PX: f64 = 123.4567;

/// A study of two films that `anna` and `ben` read once each, with `lead` as its admin.
fn app() -> App {
    let app = App::new(Access::Accounts, |store| {
        for (who, role) in [("lead", Role::Admin), ("anna", Role::Editor), ("ben", Role::Editor)] {
            let account = Account { name: name(who), role, enabled: true };
            let password = PasswordHash::new(PASSWORD, &account.name).expect("a password");
            store.add_account(&account, &password, &by("lead")).expect("an account");
        }
        let study = Study::new(name("B-1"), Some(LABEL.to_owned()), true);
        store.add_study(&study, &by("lead")).expect("a study");
        let image = json!({
            "columns": 1000, "rows": 2500, "column_spacing_mm": 0.2, "row_spacing_mm": 0.2,
            "spacing_plane": "patient", "patient_left": "image_left"
        });
        for posture in [Posture::Erect, Posture::LeftBending] {
            let bytes = posture.to_string();
            store
                .add_film(&study.id, posture, bytes.as_bytes(), &image, &by("lead"))
                .expect("a film");
        }
        for who in ["anna", "ben"] {
            store.grant(&study.id, &name(who), Role::Editor, &by("lead")).expect("a grant");
        }
    });
    let plan = json!({ "observers": ["anna", "ben"], "repeats": 1, "washout_days": 0 });
    app.account("lead").post(&format!("{STUDY}/plan"), &plan).succeeded();
    app
}

fn next(browser: &Browser<'_>) -> Value {
    browser.get(STUDY).json()["plan"]["next"].clone()
}

fn code(browser: &Browser<'_>) -> String {
    next(browser)["code"].as_str().expect("a code").to_owned()
}

/// Begins the next film; returns its reading.
fn begin(browser: &Browser<'_>) -> i64 {
    let begun =
        browser.post(&format!("/api/codes/{}/readings", code(browser)), &Value::Null).succeeded();
    begun.json()["reading"].as_i64().expect("a number")
}

/// Corners of L4, with their columns and rows.
fn corners(revision: u64, corners: &[(&str, f64, f64)]) -> Value {
    let event = |&(corner, column_px, row_px): &(&str, f64, f64)| {
        json!({ "kind": "place_corner", "level": "L4", "corner": corner,
            "column_px": column_px, "row_px": row_px })
    };
    let events: Vec<Value> = corners.iter().map(event).collect();
    json!({ "expected_revision": revision, "events": events })
}

fn click(revision: u64) -> Value {
    corners(revision, &[("superior_left", COLUMN_PX, 5.0)])
}

/// Marks the four corners of L4 in a reading without events; its revision is then 4.
fn mark(browser: &Browser<'_>, reading: i64) {
    let rest = [
        ("superior_right", 323.0, 5.0),
        ("inferior_right", 323.0, 125.0),
        ("inferior_left", COLUMN_PX, 125.0),
    ];
    let path = format!("/api/readings/{reading}/events");
    browser.post(&path, &click(0)).succeeded();
    browser.post(&path, &corners(1, &rest)).succeeded();
}

fn revision(revision: u64) -> Value {
    json!({ "expected_revision": revision })
}

/// Reads the next film: one vertebra, an undo and a redo, and the finish.
fn read(browser: &Browser<'_>) -> i64 {
    let reading = begin(browser);
    let path = format!("/api/readings/{reading}");
    mark(browser, reading);
    let back =
        json!({ "expected_revision": 4, "events": [{ "kind": "undo" }, { "kind": "redo" }] });
    assert_eq!(browser.post(&format!("{path}/events"), &back).status, StatusCode::OK);
    let done = browser.post(&format!("{path}/finish"), &revision(6));
    assert_eq!((done.status, &done.json()["finished"]), (StatusCode::OK, &json!(true)));
    reading
}

/// Ways in which an admin removes `anna`'s access, and restores it.
fn takings() -> Vec<(&'static str, [Value; 2])> {
    let grants = |all: &[(&str, &str)]| {
        let one = |(name, role): &(&str, &str)| json!({ "name": name, "role": role });
        Value::from(all.iter().map(one).collect::<Vec<_>>())
    };
    let both = grants(&[("anna", "editor"), ("ben", "editor")]);
    let (account, granted) = ("/api/accounts/anna", "/api/studies/B-1/grants");
    vec![
        (account, [json!({ "role": "reader" }), json!({ "role": "editor" })]),
        (account, [json!({ "enabled": false }), json!({ "enabled": true })]),
        (granted, [grants(&[("anna", "reader"), ("ben", "editor")]), both.clone()]),
        (granted, [grants(&[("ben", "editor")]), both]),
    ]
}

#[test]
fn an_observer_whose_role_was_taken_reads_no_further() {
    for has_begun in [false, true] {
        for (path, [taken, back]) in takings() {
            let app = app();
            let (lead, mut anna) = (app.account("lead"), app.account("anna"));
            let code = code(&anna);
            let reading = if has_begun { begin(&anna) } else { 1 };
            assert_eq!(lead.put(path, &taken).status, StatusCode::OK, "{path} {taken}");
            let at = format!("/api/readings/{reading}");
            let finish = format!("{at}/finish");
            for (path, body) in [
                (format!("{at}/events"), click(0)),
                (finish.clone(), revision(0)),
                (format!("{at}/detection"), Value::Null),
                (format!("/api/codes/{code}/readings"), Value::Null),
            ] {
                let status = anna.post(&path, &body).status;
                assert!(
                    [401, 403, 404].contains(&status.as_u16()),
                    "{status} for {path} after {taken}"
                );
            }
            assert!(!anna.get(STUDY).text().contains(&code), "the next film after {taken}");
            let store = Store::view(&app.store_path()).expect("the store");
            let readings = store.readings(&name("B-1")).expect("readings");
            assert_eq!(readings.len(), usize::from(has_begun), "{taken}");
            assert!(readings.iter().all(|reading| reading.finished_at.is_none()), "{taken}");
            assert_eq!(lead.put(path, &back).status, StatusCode::OK);
            if anna.get("/api/session").status != StatusCode::OK {
                anna = app.account("anna");
            }
            let reading = if has_begun { reading } else { begin(&anna) };
            mark(&anna, reading);
            let done = anna.post(&format!("/api/readings/{reading}/finish"), &revision(4));
            assert_eq!(done.status, StatusCode::OK, "the same again after {back}");
        }
    }
}

#[test]
fn a_role_that_is_taken_while_a_click_comes_is_gone() {
    let changes = [
        AccountChange { role: Some(Role::Reader), ..AccountChange::default() },
        AccountChange { enabled: Some(false), ..AccountChange::default() },
    ];
    for change in changes {
        let app = app();
        let anna = app.account("anna");
        let reading = begin(&anna);
        let path = format!("/api/readings/{reading}/events");
        let head = anna.request(Method::POST, &path).header("content-type", "application/json");
        let answer = app.ask_slowly(head, click(0).to_string().into_bytes(), || {
            let mut store = Store::open(&app.store_path()).expect("the store");
            store.edit_account(&name("anna"), &change, &by("lead")).expect("an edit");
        });
        assert!([401, 403].contains(&answer.status.as_u16()), "{}", answer.text());
        let store = Store::view(&app.store_path()).expect("the store");
        let state = store.reading_state(spineline_store::ReadingId(reading)).expect("a reading");
        assert_eq!(state.revision, 0, "{change:?}");
    }
}

#[test]
fn a_blinded_observer_does_not_see_what_they_have_finished() {
    let app = app();
    let (anna, ben) = (app.account("anna"), app.account("ben"));
    let own = read(&anna);
    let at = format!("/api/readings/{own}");
    let current = begin(&anna);
    for path in
        [at.clone(), format!("{at}/pixels"), format!("{at}/thumbnail"), format!("{at}/live")]
    {
        let answer = anna.get(&path);
        assert_eq!((answer.status, answer.code().as_str()), (StatusCode::FORBIDDEN, "blinded"));
    }
    let preview = json!({ "events": [], "turn_axis": null });
    let posts = [
        (format!("{at}/preview"), preview),
        (format!("{at}/detection"), Value::Null),
        (format!("{at}/events"), click(0)),
        (format!("{at}/events"), click(6)),
        (format!("{at}/finish"), revision(1)),
    ];
    for (path, body) in posts {
        let answer = anna.post(&path, &body);
        assert!([403, 409].contains(&answer.status.as_u16()), "{path}: {}", answer.text());
        assert!(!answer.text().contains("123.4"), "{path}: {}", answer.text());
    }
    // The acknowledgement was lost: the same request again.
    let again = anna.post(&format!("{at}/finish"), &revision(6));
    let closed = json!({ "finished": true, "revision": 6, "reading": null });
    assert_eq!((again.status, again.json()), (StatusCode::OK, closed));
    let seen = anna.get(&format!("/api/readings/{current}"));
    assert_eq!(seen.status, StatusCode::OK, "what is being read");
    mark(&anna, current);
    assert_eq!(anna.post(&format!("/api/readings/{current}/finish"), &revision(4)).status, 200);
    assert_eq!(anna.get(&at).status, StatusCode::FORBIDDEN, "ben has not read");
    read(&ben);
    read(&ben);
    for browser in [&anna, &ben] {
        let open = browser.get(&at);
        assert_eq!((open.status, &open.json()["finished"]), (StatusCode::OK, &json!(true)));
    }
}

#[test]
fn a_blinded_observer_sees_no_label_and_no_time_of_others() {
    let app = app();
    let (lead, anna, ben) = (app.account("lead"), app.account("anna"), app.account("ben"));
    let answers = |browser: &Browser<'_>| {
        let all = ["/api/studies", STUDY, "/api/cohort"].map(|path| browser.get(path));
        all.map(|answer| answer.text()).concat()
    };
    let before = answers(&anna);
    assert!(!before.contains(LABEL), "{before}");
    assert!(answers(&lead).contains(LABEL));
    read(&ben);
    assert_eq!(answers(&anna), before, "other observers see no change");
    read(&anna);
    read(&anna);
    read(&ben);
    assert!(answers(&anna).contains(LABEL), "the plan is complete");
}

#[test]
fn films_do_not_change_while_a_plan_runs() {
    let app = app();
    let (lead, anna, ben) = (app.account("lead"), app.account("anna"), app.account("ben"));
    let edits = [
        json!({ "kind": "inverted", "inverted": true }),
        json!({ "kind": "posture", "posture": "traction" }),
        json!({ "kind": "scale", "from_px": [10.0, 10.0], "to_px": [10.0, 410.0],
            "length_mm": 100.0, "length_sd_mm": 0.1, "calibrator": "ball" }),
    ];
    let edit = |edit: &Value| {
        lead.post("/api/films/1/edits", &json!({ "expected_revision": 0, "edit": edit }))
    };
    for one in &edits {
        let refused = edit(one);
        assert_eq!(refused.status, StatusCode::CONFLICT, "{one}: {}", refused.text());
        assert_eq!(refused.code(), "plan_runs");
    }
    for browser in [&anna, &anna, &ben, &ben] {
        read(browser);
    }
    assert_eq!(edit(&edits[0]).status, StatusCode::OK);
}

#[test]
fn a_planned_reading_without_a_vertebra_or_with_an_open_error_is_not_finished() {
    let app = app();
    let anna = app.account("anna");
    let reading = begin(&anna);
    let at = format!("/api/readings/{reading}");
    let refused = |number: u64, code: &str, part: &str| {
        let answer = anna.post(&format!("{at}/finish"), &revision(number));
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", answer.text());
        assert!(answer.code() == code && answer.text().contains(part), "{}", answer.text());
    };
    refused(0, "no_landmarks", "no vertebra is marked");
    // The patient's left is on the left of the picture, and the left corners are on the right.
    let exchanged = [
        ("superior_left", 323.0, 5.0),
        ("superior_right", 123.0, 5.0),
        ("inferior_right", 123.0, 125.0),
        ("inferior_left", 323.0, 125.0),
    ];
    anna.post(&format!("{at}/events"), &corners(0, &exchanged)).succeeded();
    refused(4, "landmark_errors", "L4: ");
    let stale = anna.post(&format!("{at}/finish"), &revision(3));
    assert_eq!(stale.status, StatusCode::CONFLICT, "{}", stale.text());
    let right = exchanged.map(|(corner, column, row)| (corner, 446.0 - column, row));
    let remove = json!({ "expected_revision": 4,
        "events": [{ "kind": "remove_vertebra", "level": "L4" }] });
    anna.post(&format!("{at}/events"), &remove).succeeded();
    anna.post(&format!("{at}/events"), &corners(5, &right)).succeeded();
    anna.post(&format!("{at}/finish"), &revision(9)).succeeded();
    // A film that shows none.
    let next = begin(&anna);
    let nothing = json!({ "expected_revision": 0, "nothing_to_mark": true });
    anna.post(&format!("/api/readings/{next}/finish"), &nothing).succeeded();
}
