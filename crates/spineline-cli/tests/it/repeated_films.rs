//! One film in two postures is noticed, in whatever files and formats it comes.

use std::fs;

use serde_json::{Value, json};

use crate::detect::blank;
use crate::maker::{DEFLATED, EXPLICIT, Maker, Syntax, ramp};
use crate::program::{Here, finish, folder, spineline, split, succeeded, unwrapped};

/// A film with an identifier, whose pixels depend on `number`.
fn film(number: u16, uid: &str, syntax: Syntax) -> Vec<u8> {
    let pixels = ramp(COLUMNS, ROWS).into_iter().map(|grey| (grey + number) % 4096);
    let mut maker = Maker::new(COLUMNS, ROWS, &pixels.collect::<Vec<u16>>());
    maker.text((0x08, 0x18), "UI", uid).text((0x20, 0x0D), "UI", "1.2.4");
    maker.file(syntax)
}

/// A synthetic case whose erect and neutral films lie beside it, as pictures of one size.
fn case(here: &Here, erect: &[u8], neutral: &[u8]) {
    if !here.path(CASE).exists() {
        here.done(&split("phantom --subject 1 --out . --noise 0 --pixel-size 8"));
    }
    here.change(CASE, |case| {
        for film in case["films"].as_array_mut().expect("films") {
            let posture = film["posture"].as_str().expect("a posture").to_owned();
            film["image"]["columns"] = COLUMNS.into();
            film["image"]["rows"] = ROWS.into();
            film["image"]["file"] = format!("{posture}.dcm").into();
        }
    });
    // A store refuses a case with a missing film.
    for (number, posture) in [(11, "left_bending"), (12, "right_bending"), (13, "traction")] {
        let other = film(number, &format!("1.2.3.{number}"), EXPLICIT);
        here.write(format!("{posture}.dcm"), other);
    }
    here.write("erect.dcm", erect);
    here.write("neutral.dcm", neutral);
}

const CASE: &str = "phantom-rod-01.json";

/// Size of all films, at least as large as the phantom's. Films of different sizes are never one picture.
const COLUMNS: u16 = 420;
const ROWS: u16 = 600;

/// Every command that reads a case, with its arguments.
fn readers(here: &Here) -> Vec<Vec<&'static str>> {
    let store = here.path("s.db");
    if store.exists() {
        fs::remove_file(&store).expect("removed");
    }
    here.done(&["study", "create", "s.db"]);
    vec![
        vec!["check", CASE],
        vec!["analyze", CASE, "--json", "a.json"],
        vec!["report", CASE, "--out", "r.html"],
        vec!["study", "add", "s.db", CASE],
    ]
}

#[test]
fn one_picture_in_two_files_is_refused_for_two_postures() {
    let here = folder();
    // Other bytes, another identifier, another compression, and the same pixels.
    case(&here, &film(1, "1.2.3.1", EXPLICIT), &film(1, "1.2.3.2", DEFLATED));
    for command in readers(&here) {
        let error = here.refused(&command, 3);
        for part in ["erect film", "neutral film", "the same picture", CASE] {
            assert!(error.contains(part), "{command:?}: no {part} in {error}");
        }
    }
    assert!(!here.path("a.json").exists() && !here.path("r.html").exists());
    // The picture of a frontal film is not a lateral one either.
    case(&here, &film(1, "1.2.3.1", EXPLICIT), &film(2, "1.2.3.2", EXPLICIT));
    here.change(CASE, |with| {
        with["lateral"] = json!({ "image": {
            "columns": COLUMNS, "rows": ROWS, "patient_anterior": "image_left", "file": "side.dcm",
        } });
    });
    here.write("side.dcm", film(2, "1.2.3.9", EXPLICIT));
    let error = here.refused(&["check", CASE], 3);
    assert!(error.contains("neutral film") && error.contains("lateral film"), "{error}");
}

#[test]
fn landmarks_of_one_film_are_refused_for_two_postures_by_every_command() {
    let here = folder();
    case(&here, &film(1, "1.2.3.1", EXPLICIT), &film(2, "1.2.3.2", EXPLICIT));
    here.change(CASE, |copied| {
        let films = copied["films"].as_array_mut().expect("films");
        let of = |name: &str| films.iter().position(|film| film["posture"] == name);
        let [erect, neutral] = ["erect", "neutral"].map(|name| of(name).expect("a film"));
        films[neutral]["readings"] = films[erect]["readings"].clone();
    });
    for command in readers(&here) {
        let error = here.refused(&command, 3);
        assert!(error.contains("the same landmarks"), "{command:?}: {error}");
    }
}

#[test]
fn two_pictures_of_one_identifier_are_warned_about() {
    let here = folder();
    for (uid, expected) in [("1.2.3.2", false), ("1.2.3.1", true)] {
        case(&here, &film(1, "1.2.3.1", EXPLICIT), &film(2, uid, EXPLICIT));
        for command in readers(&here) {
            let (out, error, code) = here.run(&command);
            assert_eq!(code, 0, "{command:?}: {error}");
            if command[0] != "report" {
                let found = unwrapped(&format!("{out}{error}"));
                assert_eq!(found.contains("SOP Instance UID"), expected, "{command:?}: {found}");
            }
        }
        for (file, code) in [("a.json", "identifier_repeated"), ("r.html", "SOP Instance UID")] {
            assert_eq!(here.text(file).contains(code), expected, "{file}");
        }
        // An analysis holds no films, and is the same without them.
        fs::create_dir_all(here.path("alone")).expect("a folder");
        fs::copy(here.path("a.json"), here.path("alone/a.json")).expect("a copy");
        succeeded(finish(spineline(&here.path("alone")).args(["rerun", "a.json"])));
        fs::remove_file(here.path("a.json")).expect("removed");
        fs::remove_file(here.path("r.html")).expect("removed");
    }
}

#[test]
fn a_film_of_another_patient_or_part_of_the_body_is_noticed_by_every_command() {
    let here = folder();
    let neutral = |tag: (u16, u16), vr: &'static str, value: &str| {
        let mut maker = Maker::new(COLUMNS, ROWS, &ramp(COLUMNS, ROWS));
        maker.text((0x08, 0x18), "UI", "1.2.3.2").text((0x20, 0x0D), "UI", "1.2.4");
        maker.text((0x10, 0x20), "LO", "SOMEONE-1").text(tag, vr, value);
        maker.file(EXPLICIT)
    };
    let mut erect = Maker::new(COLUMNS, ROWS, &[7; COLUMNS as usize * ROWS as usize]);
    erect.text((0x08, 0x18), "UI", "1.2.3.1").text((0x20, 0x0D), "UI", "1.2.4");
    erect.text((0x10, 0x20), "LO", "SOMEONE-1");
    let erect = erect.file(EXPLICIT);
    for (tag, vr, value, expected, code) in [
        ((0x18, 0x15), "CS", "LEG", "(LEG)", "other_body_part"),
        ((0x08, 0x60), "CS", "MG", "(BREAST)", "other_body_part"),
        ((0x10, 0x20), "LO", "SOMEONE-2", "Patient ID differs", "patient_differs"),
    ] {
        case(&here, &erect, &neutral(tag, vr, value));
        for command in readers(&here) {
            let (out, error, ending) = here.run(&command);
            let said = unwrapped(&format!("{out}{error}"));
            assert!(!said.contains("SOMEONE"), "{command:?}: {said}");
            // A store takes such a film only when told to; the other commands warn.
            if command[0] == "study" {
                assert_eq!(ending, 3, "{command:?}: {said}");
                assert!(said.contains(expected) && said.contains("--accept"), "{said}");
                let out = here.done(&[&command[..], &["--accept"]].concat());
                assert!(out.contains("neutral film") && out.contains(expected), "{out}");
                continue;
            }
            assert_eq!(ending, 0, "{command:?}: {said}");
            if command[0] != "report" {
                assert!(said.contains("neutral film") && said.contains(expected), "{said}");
            }
        }
        assert!(here.text("a.json").contains(code), "{code}");
        here.done(&["rerun", "a.json"]);
        for file in ["a.json", "r.html"] {
            fs::remove_file(here.path(file)).expect("removed");
        }
    }
}

#[test]
fn a_picture_other_than_the_one_with_the_landmarks_is_noticed_by_every_command() {
    let here = folder();
    here.done(&["phantom", "--subject", "1", "--out", ".", "--noise", "0", "--pixel-size", "2"]);
    let image = here.json(CASE)["films"][0]["image"].clone();
    let [columns, rows] =
        ["columns", "rows"].map(|key| image[key].as_u64().expect("a size") as u16);
    let picture = Maker::new(columns, rows, &vec![7; usize::from(columns) * usize::from(rows)]);
    let bytes = picture.file(EXPLICIT);
    here.write("erect.dcm", &bytes);
    let own = spineline_files::sha256_hex(&bytes);
    let other = spineline_files::sha256_hex(b"another film");
    let (by_hash, by_size) = ("(different SHA-256)", "but the film with the landmarks");
    for (sha256, more_columns, expected) in
        [(Some(&own), 0, None), (Some(&other), 0, Some(by_hash)), (None, 10, Some(by_size))]
    {
        here.change(CASE, |case| {
            let image = &mut case["films"][0]["image"];
            image["file"] = "erect.dcm".into();
            image["columns"] = (columns + more_columns).into();
            image["sha256"] = json!(sha256);
        });
        for command in [&["check", CASE][..], &["analyze", CASE, "--json", "a.json"]] {
            let (out, error, code) = here.run(command);
            let said = unwrapped(&format!("{out}{error}"));
            assert_eq!(code, 0, "{command:?}: {said}");
            if command[0] == "check" {
                let is_said = |words: &str| said.contains(words);
                assert_eq!(
                    [by_hash, by_size].map(is_said),
                    [by_hash, by_size].map(|words| expected == Some(words)),
                    "{said}"
                );
            }
        }
        assert_eq!(here.text("a.json").contains("picture_differs"), expected.is_some());
        let (_, error, _) = here.run(&["report", CASE, "--out", "r.html"]);
        let is_hidden = unwrapped(&error).contains("picture of the erect film is not shown");
        assert_eq!(is_hidden, expected.is_some(), "{error}");
        let export = ["export", CASE, "--to", "dicom-sr", "--posture", "erect", "--out", "r.dcm"];
        match expected {
            None => drop(here.done(&export)),
            Some(by_hash_or_size) => {
                let error = here.refused(&export, 3);
                assert!(error.contains("erect film"), "{error}");
                assert_eq!(error.contains(by_hash), by_hash_or_size == by_hash, "{error}");
            }
        }
        for file in ["a.json", "r.html"] {
            fs::remove_file(here.path(file)).expect("removed");
        }
    }
}

#[test]
fn a_file_that_is_not_a_film_or_has_another_size_is_noticed_without_a_stated_hash() {
    let here = folder();
    case(&here, &film(1, "1.2.3.1", EXPLICIT), &film(2, "1.2.3.2", EXPLICIT));
    here.done(&["study", "create", "s.db"]);
    for (file, expected) in [
        (b"notes of a week".to_vec(), "not a radiograph"),
        (Vec::new(), "the file is empty"),
        (blank(30, 20), "it has 30 × 20 pixels"),
    ] {
        here.write("erect.dcm", file);
        let said = unwrapped(&here.done(&["check", CASE]));
        assert!(said.contains("erect film") && said.contains(expected), "{said}");
        let error = unwrapped(&here.refused(&["study", "add", "s.db", CASE, "--accept"], 3));
        assert!(error.contains("erect film") && error.contains(expected), "{error}");
    }
    here.write("erect.dcm", blank(COLUMNS.into(), ROWS.into()));
    here.done(&["study", "add", "s.db", CASE]);
}

/// Corners of T9 and T8 by name: column and row.
fn corners(down: f64) -> Vec<(String, [f64; 2])> {
    let mut all = Vec::new();
    for (level, top) in [("T9", 101.0), ("T8", 71.0)] {
        for (endplate, row) in [("superior", top + down), ("inferior", top + down + 20.0)] {
            for (side, column) in [("left", 45.0), ("right", 15.0)] {
                all.push((format!("{level}_{endplate}_{side}"), [column, row]));
            }
        }
    }
    all
}

fn labelme(picture: &str, corners: &[(String, [f64; 2])]) -> String {
    let shape = |(name, [column, row]): &(String, [f64; 2])| json!({ "label": name, "points": [[column + 0.5, row + 0.5]], "shape_type": "point" });
    let shapes: Vec<Value> = corners.iter().map(shape).collect();
    json!({ "shapes": shapes, "imagePath": picture }).to_string()
}

fn coco(picture: &str, corners: &[(String, [f64; 2])]) -> String {
    let names: Vec<&String> = corners.iter().map(|(name, _)| name).collect();
    let places: Vec<Value> =
        corners.iter().flat_map(|(_, [x, y])| [json!(x), json!(y), json!(2)]).collect();
    json!({
        "images": [{ "id": 1, "file_name": picture }],
        "categories": [{ "id": 1, "name": "spine", "keypoints": names }],
        "annotations": [{ "image_id": 1, "category_id": 1, "keypoints": places }],
    })
    .to_string()
}

fn csv(posture: &str, corners: &[(String, [f64; 2])]) -> String {
    let mut text = "posture,observer,repeat,vertebra".to_owned();
    for corner in ["superior_left", "superior_right", "inferior_left", "inferior_right"] {
        text.push_str(&format!(",{corner}_column_px,{corner}_row_px"));
    }
    for body in corners.chunks(4) {
        let level = body[0].0.split('_').next().expect("a level");
        text.push_str(&format!("\n{posture},B,1,{level}"));
        for (_, [column, row]) in body {
            text.push_str(&format!(",{column},{row}"));
        }
    }
    text + "\n"
}

/// Imports an erect and a neutral film with a file of landmarks each.
fn import(erect: &str, neutral: &str) -> (String, i32) {
    let here = folder();
    for (name, rows) in [("a.dcm", 400), ("b.dcm", 401)] {
        let mut maker = Maker::new(60, rows, &ramp(60, rows));
        maker.text((0x20, 0x20), "CS", "L\\F").text((0x28, 0x30), "DS", "1\\1");
        here.write(name, maker.file(EXPLICIT));
    }
    here.write("erect.marks", erect);
    here.write("neutral.marks", neutral);
    let films = ["--film", "erect=1", "--film", "neutral=2", "--secret", "secret", "--accept"];
    let marks = ["--landmarks", "erect=erect.marks", "--landmarks", "neutral=neutral.marks"];
    let to = ["import", "a.dcm", "b.dcm", "--case-id", "A", "--out", "out"];
    let (_, error, code) = here.run(&[&to[..], &films, &marks].concat());
    assert_eq!(here.path("out/case.json").exists(), code == 0);
    (unwrapped(&error), code)
}

#[test]
fn landmarks_of_one_film_are_refused_for_two_postures_in_any_format() {
    let same = corners(0.0);
    let formats = |posture: &str, picture: &str, corners: &[(String, [f64; 2])]| {
        [labelme(picture, corners), coco(picture, corners), csv(posture, corners)]
    };
    for erect in formats("erect", "a.png", &same) {
        for neutral in formats("neutral", "b.png", &same) {
            let (error, code) = import(&erect, &neutral);
            assert_eq!(code, 3, "{error}");
            for part in ["erect film", "neutral film", "the same landmarks"] {
                assert!(error.contains(part), "no {part} in {error}");
            }
        }
        for neutral in formats("neutral", "b.png", &corners(5.0)) {
            let (error, code) = import(&erect, &neutral);
            assert_eq!(code, 0, "{error}");
            assert!(!error.contains("note:"), "{error}");
        }
    }
}

#[test]
fn landmarks_that_name_one_picture_for_two_postures_are_reported() {
    let neutral = [labelme("x.png", &corners(5.0)), coco("x.png", &corners(5.0))];
    for neutral in neutral {
        let (error, code) = import(&labelme("x.png", &corners(0.0)), &neutral);
        assert_eq!(code, 0, "{error}");
        assert!(error.contains("name one picture, x.png"), "{error}");
    }
}

#[test]
fn implausible_landmarks_are_reported_on_import() {
    let mut odd = corners(5.0);
    // The left side of T9 keeps a quarter of its height.
    odd[0].1[1] += 15.0;
    let (error, code) = import(&csv("erect", &corners(0.0)), &labelme("b.png", &odd));
    assert_eq!(code, 0, "{error}");
    assert!(error.contains("neutral film, T9") && error.contains("differ by a factor"), "{error}");
}
