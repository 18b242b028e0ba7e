//! Lengths and angles that are drawn on a film.

use axum::http::StatusCode;
use serde_json::{Value, json};

use crate::browser::Browser;
use crate::demo::{app_with_demo, demo};

fn film(browser: &Browser<'_>) -> (i64, f64) {
    let film = &demo(browser)["summary"]["films"][0];
    (film["film"].as_i64().expect("a film"), film["row_mm"].as_f64().expect("a scale"))
}

fn length(rows: f64) -> Value {
    json!({ "kind": "length", "from_px": [100.0, 100.0], "to_px": [100.0, 100.0 + rows] })
}

#[test]
fn a_drawn_length_is_in_the_patients_millimetres_and_is_stored_nowhere() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let (film, row_mm) = film(&browser);
    let study = || browser.get("/api/studies/demo-rod-01").text();
    let before = study();
    let path = format!("/api/films/{film}/drawn");
    let view = browser.post(&path, &length(500.0)).succeeded().json();
    let text = view["text"].as_str().expect("a text");
    assert!(text.starts_with(&format!("{:.1} ± ", 500.0 * row_mm)), "{view}");
    assert!(view["note"].as_str().is_some_and(|note| note.starts_with("mm (patient)")), "{view}");
    let angle = json!({ "kind": "angle", "first_from_px": [10.0, 10.0], "first_to_px": [210.0, 10.0],
        "second_from_px": [10.0, 300.0], "second_to_px": [210.0, 100.0] });
    let view = browser.post(&path, &angle).json();
    assert!(view["text"].as_str().is_some_and(|text| text.starts_with("45.0 ± ")), "{view}");
    assert_eq!(study(), before);
}

#[test]
fn a_line_that_measures_nothing_is_refused_with_its_limit() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let (film, _) = film(&browser);
    let path = format!("/api/films/{film}/drawn");
    for (rows, limit) in [(1.0, "the minimum is 5.0"), (-500.0, "outside of the")] {
        let refused = browser.post(&path, &length(rows));
        assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert!(refused.text().contains(limit), "{}", refused.text());
    }
}

#[test]
fn pixels_come_with_the_windows_of_a_dicom_file() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let (film, _) = film(&browser);
    let pixels = browser.get(&format!("/api/films/{film}/pixels"));
    let [center, width] =
        ["center", "width"].map(|part| pixels.header(&format!("x-spineline-window-{part}")));
    assert_eq!(pixels.header("x-spineline-file-windows"), format!("{center} {width}"));
}
