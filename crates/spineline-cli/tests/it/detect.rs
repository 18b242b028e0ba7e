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
fn a_synthetic_film_becomes_a_case_of_unreviewed_corners() {
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
    let text = done(here.path(), &["detect", film, "--posture", "erect", "--out", "found"]);
    // The networks were not trained on drawn films: the levels are not certain.
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
    assert!(checked.contains("no person has accepted or moved them"), "{checked}");
    // The same film, the same bytes.
    done(here.path(), &["detect", film, "--posture", "erect", "--out", "again"]);
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
    let line = [&["detect", "blank.png", film, "--posture", "erect", "--out", "found"][..], &side]
        .concat();
    let (out, error, code) = run(here.path(), &line);
    assert_eq!(code, 3, "{error}");
    assert!(error.contains("blank.png") && error.contains("no frontal spine"), "{error}");
    assert!(out.contains("detected-02.json"), "{out}");
    assert!(!here.path().join("found/detected-01.json").exists());
    // A picture does not say where the patient's left is, and it is not guessed.
    let (_, error, code) =
        run(here.path(), &["detect", "blank.png", "--posture", "erect", "--out", "other"]);
    assert_eq!(code, 3);
    assert!(error.contains("--patient-left"), "{error}");
}

#[test]
fn the_posture_of_a_film_is_stated_by_the_user_or_by_its_case() {
    let here = tempdir().expect("a folder");
    let films = ["--films", "--pixel-size", "2", "--subject", "1", "--out", "p"];
    done(here.path(), &[&["phantom"][..], &films].concat());
    let bend = "p/phantom-rod-01-left_bending.dcm";
    let (_, error, code) = run(here.path(), &["detect", bend, "--out", "found"]);
    assert!(code == 3 && error.contains("--posture"), "{code} {error}");
    done(here.path(), &["detect", bend, "--posture", "left-bending", "--out", "found"]);
    let read = |path: &str| -> Value {
        let text = fs::read_to_string(here.path().join(path)).expect("a case");
        serde_json::from_str(&text).expect("JSON")
    };
    assert_eq!(read("found/detected-01.json")["films"][0]["posture"], "left_bending");

    let chosen = [
        "--film",
        "erect=p/phantom-rod-01-erect.dcm",
        "--film",
        "left-bending=p/phantom-rod-01-left_bending.dcm",
    ];
    let import = ["import", "p", "--case-id", "P07", "--out", "p07"];
    done(here.path(), &[&import[..], &chosen].concat());
    done(here.path(), &["detect", "p07/case.json", "--out", "found"]);
    let case = read("found/P07.json");
    for film in case["films"].as_array().expect("films") {
        assert_eq!(film["readings"][0]["observer"], "spineline-detect", "{}", film["posture"]);
    }
    // Films with a reading are left as they are.
    let (_, error, code) = run(here.path(), &["detect", "p/phantom-rod-01.json", "--out", "none"]);
    assert!(code == 3 && error.contains("lacks a reading"), "{code} {error}");
}
