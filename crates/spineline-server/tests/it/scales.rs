//! Implausible scales.

use axum::http::StatusCode;
use serde_json::json;

use crate::demo::{app_with_demo, demo};

#[test]
fn implausible_lengths_and_films_are_refused_with_their_limits() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let made = demo(&browser);
    let film = made["summary"]["films"][0]["film"].as_i64().expect("a film");
    for (calibrator, to_px, length_mm, limit) in [
        ("ball", 200.0, 254.0, "1 to 200 mm"),
        ("ruler", 200.0, 2540.0, "1 to 2000 mm"),
        ("ruler", 110.0, 190.0, "from 0.01 to 5 mm"),
        ("ruler", 300.0, 440.0, "no film of a spine is more than 2500 mm"),
    ] {
        let edit = json!({ "kind": "scale", "from_px": [100.0, 100.0], "to_px": [to_px, 100.0],
            "length_mm": length_mm, "length_sd_mm": 0.05, "calibrator": calibrator });
        let change = json!({ "expected_revision": 0, "edit": edit });
        let refused = browser.post(&format!("/api/films/{film}/edits"), &change);
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY, "{length_mm}");
        assert!(refused.text().contains(limit), "{}", refused.text());
    }
}
