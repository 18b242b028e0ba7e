//! A study as files, each with an entry in the log.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};

use axum::http::StatusCode;
use serde_json::Value;
use spineline_landmarks::{LandmarkHint, parse_landmarks, read_sr};
use spineline_store::Store;
use zip::ZipArchive;

use crate::browser::{Answer, App, Browser, name};
use crate::demo::{STUDY, app_with_demo};

/// A download, which must be named after the study.
fn taken(lead: &Browser<'_>, path: &str, ending: &str) -> Answer {
    let answer = lead.get(&format!("/api/studies/{STUDY}/{path}"));
    assert_eq!(answer.status, StatusCode::OK, "{path}: {}", answer.text());
    assert_eq!(
        answer.header("content-disposition"),
        format!("attachment; filename=\"{STUDY}{ending}\"")
    );
    answer
}

fn unpacked(archive: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let mut archive = ZipArchive::new(Cursor::new(archive)).expect("an archive");
    let mut files = BTreeMap::new();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).expect("a file");
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).expect("its bytes");
        files.insert(file.name().expect("a name").into_owned(), bytes);
    }
    let list: Value = serde_json::from_slice(&files["provenance.json"]).expect("JSON");
    assert_eq!(list["of"].as_array().expect("a list").len(), files.len() - 1);
    assert_eq!(list["provenance"]["films"], "synthetic");
    files
}

/// Actions of the last entries on the study, the last one last.
fn logged(app: &App, count: usize) -> Vec<String> {
    let store = Store::view(&app.store_path()).expect("a store");
    assert!(store.verify(None).expect("verifiable").is_clean());
    let log = store.audit_log().expect("a log");
    let last = &log[log.len() - count..];
    assert!(last.iter().all(|one| one.actor == "Ann" && one.object == "study/demo-rod-01"));
    last.iter().map(|one| one.action.clone()).collect()
}

#[test]
fn a_report_is_saved_and_logged_and_changes_nothing() {
    let app = app_with_demo();
    let lead = app.observer("Ann");
    let seen = || lead.get(&format!("/api/studies/{STUDY}")).json()["summary"].clone();
    let before = seen();
    let curve = before["curve"]["size_deg"].as_f64().expect("a measured curve");

    let report = taken(&lead, "exports/report", ".html");
    assert_eq!(report.header("content-type"), "text/html; charset=utf-8");
    let text = report.text();
    assert!(text.starts_with("<!DOCTYPE html>") && text.contains("Synthetic data"));
    assert!(text.contains("data:image/png;base64,"), "the films are in it");
    // The curve is the one in the list of studies.
    assert!(text.contains(STUDY) && text.contains(&format!("{curve:.1}")), "{curve}");

    assert_eq!(logged(&app, 1), ["export_report"]);
    assert_eq!(seen(), before, "the study is not changed");
    let store = Store::view(&app.store_path()).expect("a store");
    let last = store.audit_log().expect("a log").len();
    let result = store.last_result_change(&name(STUDY)).expect("a change");
    assert!(usize::try_from(result.sequence).expect("a number") < last);
}

#[test]
fn analysis_tables_and_figures_are_those_of_the_command_line() {
    let app = app_with_demo();
    let lead = app.observer("Ann");
    let analysis = taken(&lead, "exports/analysis", "-analysis.json");
    spineline_files::parse_analysis(&analysis.text()).expect("an analysis that can be repeated");

    let csv = unpacked(&taken(&lead, "exports/tables_csv", "-tables-csv.zip").body);
    let vertebrae = String::from_utf8(csv["vertebrae.csv"].clone()).expect("text");
    assert!(vertebrae.starts_with("case_id,") && vertebrae.lines().count() > 15, "{vertebrae}");
    assert!(csv.contains_key("dictionary.csv"), "{:?}", csv.keys());

    let parquet = unpacked(&taken(&lead, "exports/tables_parquet", "-tables-parquet.zip").body);
    assert_eq!(parquet.len(), csv.len(), "the same tables");
    assert!(parquet["vertebrae.parquet"].starts_with(b"PAR1"));

    let figures = unpacked(&taken(&lead, "exports/figures", "-figures.zip").body);
    let has = |ending: &str| figures.keys().filter(|name| name.ends_with(ending)).count();
    assert!(has(".svg") > 3 && has(".svg") == has(".png"), "{:?}", figures.keys());
    let all = ["analysis", "tables_csv", "tables_parquet", "figures"];
    assert_eq!(logged(&app, 4), all.map(|one| format!("export_{one}")));
}

#[test]
fn landmarks_and_models_are_read_back() {
    let app = app_with_demo();
    let lead = app.observer("Ann");
    let slicer = unpacked(&taken(&lead, "exports/slicer", "-slicer.zip").body);
    assert_eq!(slicer.len(), 1 + 5, "five films");
    parse_landmarks(&slicer["erect.mrk.json"], &LandmarkHint::default()).expect("a point list");

    let reports = unpacked(&taken(&lead, "exports/dicom_sr", "-dicom-sr.zip").body);
    read_sr(&reports["erect-1.dcm"]).expect("a DICOM report");

    for (format, ending, mark) in [
        ("mjcf", "-inflection_line.xml", "<mujoco"),
        ("osim", "-inflection_line.osim", "<OpenSimDocument"),
        ("sto", "-inflection_line.sto", "endheader"),
        ("loads", "-inflection_line.loads.xml", "<ExternalLoads"),
        ("urdf", "-inflection_line.urdf", "<robot"),
        ("vtp", "-inflection_line.vtp", "<VTKFile"),
        ("gltf", "-inflection_line.gltf", "\"asset\""),
    ] {
        let model = taken(&lead, &format!("models/inflection_line/{format}"), ending);
        assert!(model.text().contains(mark), "{format}");
    }
    assert!(lead.get(&format!("/api/studies/{STUDY}/case")).status.is_success());
    let all = ["slicer", "dicom_sr", "mjcf", "osim", "sto", "loads", "urdf", "vtp", "gltf", "case"];
    assert_eq!(logged(&app, 10), all.map(|one| format!("export_{one}")));
}

#[test]
fn the_menu_has_what_this_build_writes() {
    let app = App::with_token();
    let menu = app.observer("Ann").get("/api/exports").json();
    let names: Vec<&str> = menu["files"]
        .as_array()
        .expect("files")
        .iter()
        .filter_map(|one| one["name"].as_str())
        .collect();
    assert_eq!(names.contains(&"pdf"), cfg!(feature = "pdf"));
    assert!(names.contains(&"report") && names.contains(&"dicom_sr"), "{names:?}");
    assert_eq!(menu["models"].as_array().expect("models").len(), 7);
}

#[test]
fn a_study_without_results_is_not_taken_out() {
    let app = App::with_accounts();
    let lead = app.account("lead");
    for path in ["exports/report", "exports/figures", "models/inflection_line/osim"] {
        let answer = lead.get(&format!("/api/studies/S-1/{path}"));
        assert_eq!((answer.status, answer.code().as_str()), (StatusCode::CONFLICT, "not_ready"));
    }
    assert_eq!(lead.get("/api/studies/S-1/exports/nothing").status, StatusCode::NOT_FOUND);
    let store = Store::view(&app.store_path()).expect("a store");
    let log = store.audit_log().expect("a log");
    assert!(log.iter().all(|entry| !entry.action.starts_with("export_")));
}
