//! Replicates in the background: progress, cancel, intervals, and their place in exports.

use std::thread::sleep;
use std::time::Duration;

use axum::http::StatusCode;
use serde_json::{Value, json};

use crate::browser::{App, Browser};
use crate::films::decoding;

const PATH: &str = "/api/studies/demo-rod-01/replicates";

/// What the program says when it is no longer running.
fn ended(lead: &Browser<'_>) -> Value {
    for _ in 0..1200 {
        let view = lead.get(PATH).json();
        if view["state"] != "running" {
            return view;
        }
        sleep(Duration::from_millis(100));
    }
    panic!("the replicates do not end");
}

#[test]
fn replicates_are_computed_and_shown_and_cancelled() {
    let app = App::with_token().restarted(decoding());
    let lead = app.observer("Ann");
    assert_eq!(lead.post("/api/studies/demo", &Value::Null).status, StatusCode::OK);
    assert_eq!(lead.get(PATH).json()["state"], "none");
    for count in [0, 2001] {
        let refused = lead.post(PATH, &json!({ "count": count }));
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
    }

    let begun = lead.post(PATH, &json!({ "count": 5 }));
    assert_eq!((begun.status, &begun.json()["asked"]), (StatusCode::OK, &json!(5)));
    let done = ended(&lead);
    assert_eq!((&done["state"], &done["done"]), (&json!("done"), &json!(5)), "{done}");
    let intervals = done["intervals"].as_array().expect("intervals");
    let has = |word: &str| {
        intervals.iter().any(|one| one["label"].as_str().is_some_and(|l| l.contains(word)))
    };
    assert!(has("Cobb angle") && has("multiplier") && has("force"), "{done}");
    assert!(
        intervals.iter().all(|one| one["interval"].as_str().is_some_and(|i| i.contains(" to ")))
    );
    let report = lead.get("/api/studies/demo-rod-01/exports/report").text();
    assert!(report.contains("Effect of landmark noise on the results"));

    assert_eq!(lead.post(PATH, &json!({ "count": 2000 })).status, StatusCode::OK);
    let twice = lead.post(PATH, &json!({ "count": 10 }));
    assert_eq!((twice.status, twice.code().as_str()), (StatusCode::CONFLICT, "running"));
    assert_eq!(lead.delete(PATH).status, StatusCode::OK);
    let cancelled = ended(&lead);
    assert_eq!(cancelled["state"], "cancelled");
    assert!(cancelled["done"].as_u64().is_some_and(|done| done < 2000), "{cancelled}");
}
