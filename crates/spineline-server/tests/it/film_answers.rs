//! What a person says about an uploaded film, beside what its file says.

use axum::http::StatusCode;
use serde_json::json;

use crate::demo::app_with_demo;
use crate::films::{demo_film, upload, uploaded_film};

#[test]
fn an_answer_that_contradicts_the_file_is_refused_until_confirmed() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let view = upload(&browser, demo_film(&app, 0)).succeeded().json();
    assert_eq!(view["patient_left"], "image_left", "by its Patient Orientation");
    let twice = json!({ "kind": "stated", "column_mm": 1.0, "row_mm": 2.0, "plane": "pixels" });
    let square = json!({ "kind": "stated", "column_mm": 1.0, "row_mm": 1.0, "plane": "pixels" });
    for (id, key, value, doubt) in [
        ("S-0", "scale", square, None),
        ("S-1", "patient_left", json!("image_right"), Some("patient's left on the left")),
        ("S-2", "posture", json!("neutral"), Some("the patient was erect")),
        ("S-3", "posture", json!("lateral"), Some("this is a frontal view")),
        ("S-4", "scale", twice, Some("angles depend on it")),
    ] {
        let uploaded = upload(&browser, demo_film(&app, 0)).json()["upload"].clone();
        let mut film = uploaded_film(&uploaded, "erect");
        film[key] = value;
        let mut new = json!({ "id": id, "label": null, "films": [film] });
        let Some(doubt) = doubt else {
            browser.post("/api/studies", &new).succeeded();
            continue;
        };
        let refused = browser.post("/api/studies", &new);
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY, "{id}: {}", refused.text());
        assert_eq!(refused.code(), "doubtful_film", "{id}: {}", refused.text());
        assert!(refused.text().contains(doubt), "{id}: {}", refused.text());
        if key == "posture" {
            // A study of such a film alone has no results.
            continue;
        }
        new["accept_doubtful_films"] = true.into();
        browser.post("/api/studies", &new).succeeded();
    }
}
