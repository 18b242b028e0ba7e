//! `spineline detect`: films to cases of proposals, and films that show no spine.

use crate::maker::{EXPLICIT, Maker, ramp};
use crate::program::{CASE, Here, json, with_phantom};

/// The erect film of the phantom.
const ERECT: &str = "cases/phantom-rod-01-erect.dcm";

/// A folder with the phantom and its films.
fn with_films() -> Here {
    with_phantom(&["--subject", "1", "--films", "--pixel-size", "2"])
}

/// A grey picture without anything in it.
pub fn blank(columns: u32, rows: u32) -> Vec<u8> {
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
    let here = with_films();
    let text = here.done(&["detect", ERECT, "--posture", "erect", "--out", "found"]);
    // The networks were not trained on drawn films: the levels are not certain.
    assert!(text.contains("found/detected-01.json") && text.contains("check the levels"), "{text}");
    let file = here.text("found/detected-01.json");
    assert!(!file.contains("phantom-rod"), "the case names no film");
    let case = json(&file);
    assert_eq!(case["synthetic"], true, "the film says that it is a phantom's");
    let vertebrae = case["films"][0]["readings"][0]["vertebrae"].as_object().expect("vertebrae");
    assert!(vertebrae.len() >= 12, "{}", vertebrae.len());
    for vertebra in vertebrae.values() {
        assert_eq!(vertebra["origins"], serde_json::json!(vec!["detected"; 4]));
        assert!(vertebra["sd_share"].as_f64().is_some_and(|sd| sd > 0.0));
        let confidence = vertebra["confidence"][0].as_f64().expect("a confidence");
        assert!((0.0..=1.0).contains(&confidence));
    }
    let checked = here.done(&["check", "found/detected-01.json"]);
    assert!(checked.contains("no person has accepted or moved them"), "{checked}");
    // The same film, the same bytes.
    here.done(&["detect", ERECT, "--posture", "erect", "--out", "again"]);
    assert_eq!(file, here.text("again/detected-01.json"));
}

#[test]
fn a_film_without_a_spine_is_refused_and_the_others_are_kept() {
    let here = with_films();
    here.write("blank.png", blank(300, 700));
    let side = ["--patient-left", "image-left"];
    let line = [&["detect", "blank.png", ERECT, "--posture", "erect", "--out", "found"][..], &side]
        .concat();
    let (out, error, code) = here.run(&line);
    assert_eq!(code, 3, "{error}");
    assert!(error.contains("blank.png") && error.contains("no frontal spine"), "{error}");
    assert!(out.contains("detected-02.json"), "{out}");
    assert!(!here.path("found/detected-01.json").exists());
    // A picture does not say where the patient's left is, and it is not guessed.
    let error = here.refused(&["detect", "blank.png", "--posture", "erect", "--out", "other"], 3);
    assert!(error.contains("--patient-left"), "{error}");
}

#[test]
fn options_that_a_film_or_a_case_contradicts_are_refused() {
    let here = with_films();
    let mut film = Maker::new(60, 40, &ramp(60, 40));
    film.text((0x20, 0x20), "CS", "L\\F");
    here.write("front.dcm", film.file(EXPLICIT));
    film.text((0x20, 0x20), "CS", "P\\F");
    here.write("side.dcm", film.file(EXPLICIT));
    let of =
        |film, side| ["detect", film, "--posture", "erect", "--out", "o", "--patient-left", side];
    let error = here.refused(&of("front.dcm", "image-left"), 3);
    assert!(error.contains("Patient Orientation puts the patient's left on the right"), "{error}");
    let error = here.refused(&of("side.dcm", "image-left"), 3);
    assert!(error.contains("lateral view"), "{error}");
    for option in [["--posture", "erect"], ["--patient-left", "image-left"]] {
        let error = here.refused(&[&["detect", CASE, "--out", "o"], &option[..]].concat(), 2);
        assert!(error.contains("is a case, which states both"), "{error}");
    }
}

#[test]
fn the_posture_of_a_film_is_stated_by_the_user_or_by_its_case() {
    let here = with_films();
    let bend = "cases/phantom-rod-01-left_bending.dcm";
    let (_, error, code) = here.run(&["detect", bend, "--out", "found"]);
    assert!(code == 3 && error.contains("--posture"), "{code} {error}");
    here.done(&["detect", bend, "--posture", "left-bending", "--out", "found"]);
    assert_eq!(here.json("found/detected-01.json")["films"][0]["posture"], "left_bending");

    let [erect, left] = [format!("erect={ERECT}"), format!("left-bending={bend}")];
    let chosen = ["--film", erect.as_str(), "--film", left.as_str()];
    let import = ["cases", "--case-id", "P07", "--out", "p07"];
    here.imported(&[&import[..], &chosen].concat());
    here.done(&["detect", "p07/case.json", "--out", "found"]);
    let case = here.json("found/P07.json");
    for film in case["films"].as_array().expect("films") {
        assert_eq!(film["readings"][0]["observer"], "spineline-detect", "{}", film["posture"]);
    }
    // Films with a reading are left as they are.
    let (_, error, code) = here.run(&["detect", CASE, "--out", "none"]);
    assert!(code == 3 && error.contains("lacks a reading"), "{code} {error}");
}
