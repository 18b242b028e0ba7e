//! `spineline detect`: films to cases of proposals, and films that show no spine.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use crate::program::{done, run};

/// A grey picture without anything in it.
fn blank(columns: u32, rows: u32) -> Vec<u8> {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, columns, rows);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("into memory");
    writer.write_image_data(&vec![90; (columns * rows) as usize]).expect("all pixels");
    writer.finish().expect("into memory");
    png
}

#[test]
fn a_synthetic_film_becomes_a_case_of_corners_that_nobody_has_reviewed() {
    let here = tempdir().expect("a folder");
    done(
        here.path(),
        &[
            "phantom",
            "--scenario",
            "rod",
            "--subject",
            "1",
            "--films",
            "--pixel-size",
            "2",
            "--out",
            "p",
        ],
    );
    let film = "p/phantom-rod-01-erect.dcm";
    let text = done(here.path(), &["detect", film, "--out", "found"]);
    // A drawn film is none of those that the networks were trained on: its levels are not taken for sure.
    assert!(text.contains("found/detected-01.json") && text.contains("check the levels"), "{text}");
    let file = fs::read_to_string(here.path().join("found/detected-01.json")).expect("a case");
    assert!(!file.contains("phantom-rod"), "the case names no film");
    let case: Value = serde_json::from_str(&file).expect("JSON");
    let vertebrae = case["films"][0]["readings"][0]["vertebrae"].as_object().expect("vertebrae");
    assert!(vertebrae.len() >= 12, "{}", vertebrae.len());
    for vertebra in vertebrae.values() {
        assert_eq!(vertebra["origins"], serde_json::json!(vec!["detected"; 4]));
        assert!(vertebra["sd_share"].as_f64().is_some_and(|sd| sd > 0.0));
        let confidence = vertebra["confidence"][0].as_f64().expect("a confidence");
        assert!((0.0..=1.0).contains(&confidence));
    }
    let checked = done(here.path(), &["check", "found/detected-01.json"]);
    assert!(checked.contains("nobody has accepted or moved them"), "{checked}");
    // The same film, the same bytes.
    done(here.path(), &["detect", film, "--out", "again"]);
    let again = fs::read_to_string(here.path().join("again/detected-01.json")).expect("a case");
    assert_eq!(file, again);
}

#[test]
fn a_film_without_a_spine_is_refused_and_the_others_are_kept() {
    let here = tempdir().expect("a folder");
    done(
        here.path(),
        &[
            "phantom",
            "--scenario",
            "rod",
            "--subject",
            "1",
            "--films",
            "--pixel-size",
            "2",
            "--out",
            "p",
        ],
    );
    fs::write(here.path().join("blank.png"), blank(300, 700)).expect("a picture");
    let film = "p/phantom-rod-01-erect.dcm";
    let side = ["--patient-left", "image-left"];
    let line = [&["detect", "blank.png", film, "--out", "found"][..], &side].concat();
    let (out, error, code) = run(here.path(), &line);
    assert_eq!(code, 3, "{error}");
    assert!(error.contains("blank.png") && error.contains("no frontal spine"), "{error}");
    assert!(out.contains("detected-02.json"), "{out}");
    assert!(!here.path().join("found/detected-01.json").exists());
    // A picture does not say where the patient's left is, and it is not guessed.
    let (_, error, code) = run(here.path(), &["detect", "blank.png", "--out", "other"]);
    assert_eq!(code, 3);
    assert!(error.contains("--patient-left"), "{error}");
}
