//! Messages that say what is wrong and what to do, without an answer to another question.

use axum::http::StatusCode;
use serde_json::{Value, json};

use crate::browser::App;
use crate::demo::app_with_demo;
use crate::films::add_unread_study;

fn texts(problem: &Value) -> String {
    format!("{} {}", problem["message"], problem["help"])
}

#[test]
fn a_missing_number_of_replicates_and_an_endless_arrow_are_called_so() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let replicates = "/api/studies/demo-rod-01/computations/replicates";
    let missing = browser.post(replicates, &json!({ "count": null }));
    assert_eq!(missing.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", missing.text());
    let said = texts(&missing.json());
    assert!(said.contains("is missing") && !said.contains("0 replicates;"), "{said}");
    for (length, part) in [(1e300, "too long to be measured"), (1e5, "mm long")] {
        let load =
            json!({ "kind": "inflection_line", "level": "T8", "tip_mm": [0.0, length, 0.0] });
        let refused = browser.post("/api/studies/demo-rod-01/load", &load);
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", refused.text());
        let said = texts(&refused.json());
        assert!(said.contains(part) && said.contains("limit is 5000 mm"), "{said}");
        assert!(!said.contains('–'), "{said}");
    }
}

#[test]
fn a_reading_or_a_plan_that_is_there_needs_no_other_name() {
    let app = App::with_accounts();
    let lead = app.account("lead");
    let plan = json!({ "observers": ["lead"], "repeats": 1, "washout_days": 0 });
    let read = lead.post("/api/studies/S-2/plan", &plan);
    let said = texts(&read.json());
    assert!(said.contains("without readings") && said.contains("new study"), "{said}");
    let begun = lead.post("/api/films/2/readings", &json!({ "repeat": 1 }));
    assert_eq!((begun.status, begun.code().as_str()), (StatusCode::CONFLICT, "exists"));
    let said = texts(&begun.json());
    assert!(said.contains("continue that reading") && !said.contains("name"), "{said}");
    lead.post("/api/studies/S-1/plan", &plan).succeeded();
    let twice = lead.post("/api/studies/S-1/plan", &plan);
    assert_eq!((twice.status, twice.code().as_str()), (StatusCode::CONFLICT, "exists"));
    let said = texts(&twice.json());
    assert!(said.contains("changes the plan") && !said.contains("another name"), "{said}");
}

#[test]
fn a_new_study_has_work_to_do_and_no_warnings() {
    let app = app_with_demo();
    add_unread_study(&app);
    let browser = app.observer("Ann");
    let studies = browser.get("/api/studies").json();
    let mut studies = studies.as_array().expect("studies").iter();
    let study = studies.find(|study| study["id"] == "blind").expect("the unread study");
    assert_eq!(study["status"], "to_mark");
    assert_eq!((&study["warnings"], &study["contradictions"]), (&json!(0), &json!(0)), "{study}");
}
