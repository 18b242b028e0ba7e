//! The report of a study as a file.

use axum::http::StatusCode;
use serde_json::Value;
use spineline_store::Store;

use crate::browser::{App, name};
use crate::films::decoding;

const STUDY: &str = "demo-rod-01";

#[test]
fn a_report_is_saved_and_logged_and_changes_nothing() {
    let app = App::with_token().restarted(decoding());
    let lead = app.observer("Ann");
    let made = lead.post("/api/studies/demo", &Value::Null);
    assert_eq!(made.status, StatusCode::OK, "{}", made.text());
    let seen = || lead.get(&format!("/api/studies/{STUDY}")).json()["summary"].clone();
    let before = seen();
    let curve = before["curve"]["size_deg"].as_f64().expect("a measured curve");

    let report = lead.get(&format!("/api/studies/{STUDY}/report"));
    assert_eq!(report.status, StatusCode::OK, "{}", report.text());
    assert_eq!(report.header("content-type"), "text/html; charset=utf-8");
    assert_eq!(
        report.header("content-disposition"),
        format!("attachment; filename=\"{STUDY}.html\"")
    );
    let text = report.text();
    assert!(text.starts_with("<!DOCTYPE html>") && text.contains("Synthetic data"));
    assert!(text.contains("data:image/png;base64,"), "the films are in it");
    // The curve is that of the list of studies.
    assert!(text.contains(STUDY) && text.contains(&format!("{curve:.1}")), "{curve}");

    let store = Store::view(&app.store_path()).expect("a store");
    let log = store.audit_log().expect("a log");
    let last = log.last().expect("entries");
    assert_eq!(
        (last.actor.as_str(), last.action.as_str(), last.object.as_str()),
        ("Ann", "report", "study/demo-rod-01")
    );
    assert!(store.verify(None).expect("verifiable").is_clean());
    assert_eq!(seen(), before, "the study is not changed");
    let result = store.last_result_change(&name(STUDY)).expect("a change");
    assert!(result.sequence < last.sequence);
}

#[test]
fn a_study_without_results_has_no_report() {
    let app = App::with_accounts();
    let answer = app.account("lead").get("/api/studies/S-1/report");
    assert_eq!((answer.status, answer.code().as_str()), (StatusCode::CONFLICT, "not_ready"));
    let store = Store::view(&app.store_path()).expect("a store");
    let log = store.audit_log().expect("a log");
    assert!(log.iter().all(|entry| entry.action != "report"));
}
