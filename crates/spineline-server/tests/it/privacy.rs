//! No answer names a patient, a folder or a home: every route with output is searched, packed parts included.

use axum::http::StatusCode;
use serde_json::json;
use spineline_server::openapi;

use crate::browser::{Answer, App, Browser};
use crate::demo::app_with_demo;
use crate::films::{begin, film_of, upload, uploaded_film};
use crate::unpacked::{holds, wrapped};

/// The name in the demonstration's films, the one in the uploaded film, and the label of its study.
const PATIENTS: [&str; 3] = ["PHANTOM^ROD01", "DOE^JANE SMIT", "ZqLabelCanary"];

/// Every GET path, except for the endless stream of changes.
fn downloads() -> Vec<String> {
    let description = serde_json::to_value(openapi()).expect("JSON");
    let paths = description["paths"].as_object().expect("paths");
    let asked = paths.iter().filter(|(_, operations)| operations["get"].is_object());
    let asked = asked.map(|(path, _)| path.clone()).filter(|path| !path.ends_with("/changes"));
    asked.collect()
}

/// A path with the numbers and names of one study; a new kind of parameter needs its value here.
fn filled(path: &str, study: &str, [film, reading]: [i64; 2], upload: &str) -> String {
    let part = |part: &str| match part {
        "{id}" | "{study}" => study.to_owned(),
        "{film}" => film.to_string(),
        "{reading}" => reading.to_string(),
        "{upload}" => upload.to_owned(),
        "{computation}" => "identifiability".to_owned(),
        "{export}" => "tables_csv".to_owned(),
        "{line}" => "inflection_line".to_owned(),
        "{format}" => "osim".to_owned(),
        part => {
            assert!(!part.starts_with('{'), "no value for {part}");
            part.to_owned()
        }
    };
    path.split('/').map(part).collect::<Vec<_>>().join("/")
}

/// Paths of this machine: the store, this program, and the home.
fn places(app: &App) -> Vec<String> {
    let folder = app.store_path().parent().expect("a folder").to_owned();
    let program = std::env::current_exe().expect("this program");
    let mut places = vec![folder, program.parent().expect("a folder").to_owned()];
    places.extend(std::env::var_os("HOME").map(Into::into));
    let texts = places.into_iter().map(|place| place.display().to_string());
    texts.filter(|place| place.len() > 2).collect()
}

fn check(answer: &Answer, path: &str, canaries: &[&str]) {
    let head = format!("{:?}", answer.headers);
    for canary in canaries {
        assert!(!head.contains(canary), "{canary} in the head of {path}: {head}");
        assert!(!holds(&answer.body, canary), "{canary} in {path}: {}", answer.text());
    }
}

/// A study of one uploaded film, with a reading; its film and reading.
fn uploaded_study(browser: &Browser<'_>, bytes: Vec<u8>) -> [i64; 2] {
    let view = upload(browser, bytes).succeeded();
    let film = uploaded_film(&view.json()["upload"], "erect");
    let new = json!({ "id": "S-17", "label": PATIENTS[2], "films": [film] });
    let made = browser.post("/api/studies", &new).succeeded();
    let film = made.json()["summary"]["films"][0]["film"].as_i64().expect("a number");
    [film, begin(browser, film)]
}

#[test]
fn no_download_names_a_patient_or_a_place() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let bytes = film_of(&app);
    assert!(holds(&bytes, PATIENTS[1]), "the film has a name");
    let own = uploaded_study(&browser, bytes.clone());
    let demo = browser.get("/api/studies/demo-rod-01").json();
    let film = demo["summary"]["films"][0]["film"].as_i64().expect("a number");
    let begun = browser.post(&format!("/api/films/{film}/readings"), &json!({ "repeat": 1 }));
    let reading = begun.json()["reading"].as_i64().expect("a number");
    let staged = upload(&browser, bytes).json()["upload"].as_str().expect("a name").to_owned();
    let places = places(&app);
    let places: Vec<&str> = places.iter().map(String::as_str).collect();
    let downloads = downloads();
    assert!(downloads.len() > 15, "{downloads:?}");
    let mut with_content = 0;
    for (study, numbers) in [("demo-rod-01", [film, reading]), ("S-17", own)] {
        for path in &downloads {
            let path = filled(path, study, numbers, &staged);
            let answer = browser.get(&path);
            assert_ne!(answer.status, StatusCode::INTERNAL_SERVER_ERROR, "{path}");
            with_content += usize::from(answer.status == StatusCode::OK);
            check(&answer, &path, &places);
            // A label is shown to users of the study, and is in no file.
            let is_file = !answer.header("content-disposition").is_empty();
            check(&answer, &path, if is_file { &PATIENTS } else { &PATIENTS[..2] });
        }
    }
    assert!(with_content > 25, "only {with_content} answers had a content");
    for file in ["case", "exports/analysis"] {
        let answer = browser.get(&format!("/api/studies/demo-rod-01/{file}"));
        assert!(answer.header("content-disposition").starts_with("attachment"), "{file}");
        assert!(!answer.json().is_null(), "{file}");
    }
}

#[test]
fn an_analysis_file_names_its_program_and_no_command_line() {
    let app = app_with_demo();
    let browser = app.observer("Ann");
    let file = browser.get("/api/studies/demo-rod-01/exports/analysis").json();
    assert_eq!(file["provenance"]["command"], json!(["spineline", "serve"]));
    assert_eq!(file["provenance"]["inputs"], json!([]));
}

#[test]
fn canaries_are_found_in_what_is_packed() {
    for (kind, bytes) in wrapped(PATIENTS[2]) {
        assert!(holds(&bytes, PATIENTS[2]), "{kind}");
    }
}
