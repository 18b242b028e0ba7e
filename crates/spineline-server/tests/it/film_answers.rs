//! What a person says about an uploaded film, beside what its file says, and films that are too small.

use axum::http::StatusCode;
use serde_json::json;
use spineline::anatomy::Posture;
use spineline_films::Encoding;

use crate::demo::app_with_demo;
use crate::films::{app, demo_film, upload, uploaded_film};
use crate::repeated_films::film_of_size;

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

#[test]
fn a_picture_in_which_no_vertebra_can_be_marked_is_refused_with_the_limit() {
    let app = app();
    let browser = app.observer("Ann");
    let of_size = |size: [u32; 2]| film_of_size(size, Posture::Erect, 0, Encoding::Plain);
    for size in [[1, 1], [63, 900], [900, 63]] {
        let refused = upload(&browser, of_size(size));
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY, "{}", refused.text());
        assert_eq!(refused.code(), "film");
        let [columns, rows] = size;
        let said = format!("{columns} × {rows} pixels; a film has at least 64 on each side");
        assert!(refused.text().contains(&said), "{}", refused.text());
    }
    upload(&browser, of_size([64, 64])).succeeded();
}
