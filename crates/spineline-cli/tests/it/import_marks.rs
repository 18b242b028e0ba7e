//! `spineline import --landmarks`: which film a file of landmarks is of, and who made it.

use serde_json::{Value as Json, json};

use crate::import::put;
use crate::maker::Maker;
use crate::program::{Here, folder, unwrapped};

const CORNERS: [&str; 4] = ["superior_left", "superior_right", "inferior_left", "inferior_right"];
const FILMS: [(&str, &str); 3] =
    [("P07_standing", "erect"), ("P07_LB", "left-bending"), ("P07_RB", "right-bending")];

/// A folder with three films of one patient, each of other pixels; the patient's left is on the right of the picture.
fn three_films() -> Here {
    let here = folder();
    for (shade, (name, _)) in FILMS.iter().enumerate() {
        let mut film = Maker::new(250, 500, &vec![100 + shade as u16; 250 * 500]);
        film.text((0x20, 0x20), "CS", "L\\F").text((0x08, 0x18), "UI", &format!("1.2.3.{shade}"));
        put(&here, &format!("{name}.dcm"), &film);
    }
    here
}

/// The corners of the vertebrae from L4 to T2, tilted by `lean` columns per vertebra.
fn corners(lean: f64) -> Vec<(String, [[f64; 2]; 4])> {
    let names = (1..=4).rev().map(|i| format!("L{i}"));
    let names = names.chain((2..=12).rev().map(|i| format!("T{i}")));
    let body = |(i, name): (usize, String)| {
        let (x, y) = (125.25 + lean * i as f64, 460.25 - 26.0 * i as f64);
        (name, [[x + 13.0, y], [x - 13.0, y], [x + 13.0, y + 16.0], [x - 13.0, y + 16.0]])
    };
    names.enumerate().map(body).collect()
}

fn labelme(picture: &str, lean: f64) -> String {
    let shapes: Vec<Json> = corners(lean)
        .iter()
        .flat_map(|(name, places)| {
            CORNERS.iter().zip(places).map(move |(corner, place)| {
                json!({ "label": format!("{name}_{corner}"), "points": [place], "shape_type": "point" })
            })
        })
        .collect();
    json!({ "imagePath": picture, "imageWidth": 250, "imageHeight": 500, "shapes": shapes })
        .to_string()
}

/// One dataset of pictures, each with its lean.
fn coco(pictures: &[(&str, f64)]) -> String {
    let categories: Vec<Json> = corners(0.0)
        .iter()
        .enumerate()
        .map(|(id, (name, _))| json!({ "id": id, "name": name, "keypoints": CORNERS }))
        .collect();
    let (mut images, mut annotations) = (Vec::new(), Vec::new());
    for (image, (name, lean)) in pictures.iter().enumerate() {
        images.push(json!({ "id": image, "file_name": name, "width": 250, "height": 500 }));
        for (category, (_, places)) in corners(*lean).iter().enumerate() {
            let keypoints: Vec<f64> = places.iter().flat_map(|[x, y]| [*x, *y, 2.0]).collect();
            annotations.push(
                json!({ "image_id": image, "category_id": category, "keypoints": keypoints }),
            );
        }
    }
    json!({ "images": images, "categories": categories, "annotations": annotations }).to_string()
}

/// The arguments that make a case in the folder `out` of the three films.
fn arguments<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut all = vec![".", "--case-id", "P07", "--out", out];
    all.extend(["--film", "erect=./P07_standing.dcm", "--film", "left-bending=./P07_LB.dcm"]);
    all.extend(["--film", "right-bending=./P07_RB.dcm", "--patient-left", "image-right"]);
    all.extend(more);
    all
}

/// Column of the first corner of T2 by posture.
fn tops(case: &Json) -> Vec<(String, f64)> {
    let films = case["films"].as_array().expect("films");
    let top = |film: &Json| {
        let t2 = &film["readings"][0]["vertebrae"]["T2"]["superior_left"][0];
        Some((film["posture"].as_str()?.to_owned(), t2.as_f64()?))
    };
    films.iter().filter_map(top).collect()
}

#[test]
fn one_dataset_of_several_films_is_matched_by_the_names_of_its_pictures() {
    let here = three_films();
    let leans = [0.0, 3.0, -3.0];
    for (out, names) in [
        ("plain", ["P07_standing.png", "P07_LB.png", "P07_RB.png"]),
        (
            "paths",
            ["images/p07_standing.PNG", "C:\\study\\P07_LB.jpg", "/data/1/0a1b2c3d-P07_RB.png"],
        ),
        ("same", ["P07_standing.dcm", "P07_LB.dcm", "P07_RB.dcm"]),
    ] {
        let mut pictures: Vec<(&str, f64)> = names.into_iter().zip(leans).collect();
        // The order in the file does not matter, nor do films of another patient.
        pictures.rotate_left(1);
        pictures.push(("P08_standing.png", 0.0));
        here.write("coco.json", coco(&pictures));
        let (_, notes, code) = here.import(&arguments(out, &["--landmarks", "coco.json"]));
        assert_eq!(code, 0, "{notes}");
        assert!(notes.contains("passed over: P08_standing.png"), "{notes}");
        let tops = tops(&here.json(format!("{out}/case.json")));
        let right = |lean: f64| 125.25 + 13.0 + 14.0 * lean;
        assert_eq!(
            tops,
            [
                ("erect".to_owned(), right(0.0)),
                ("left_bending".to_owned(), right(3.0)),
                ("right_bending".to_owned(), right(-3.0))
            ]
        );
    }
    let numbers = [("000001.png", 0.0), ("000002.png", 3.0), ("000003.png", -3.0)];
    here.write("numbers.json", coco(&numbers));
    for option in ["numbers.json", "erect=numbers.json"] {
        let error = here.import_refused(&arguments("numbers", &["--landmarks", option]), 3);
        assert!(
            error.contains("000001.png") && error.contains("P07_LB.dcm (left bending)"),
            "{error}"
        );
    }
}

#[test]
fn a_file_whose_picture_is_another_film_is_refused_and_one_of_another_name_is_noted() {
    let here = three_films();
    here.write("erect.json", labelme("P07_LB.png", 0.0));
    here.write("other.json", labelme("..\\scan_17.png", 0.0));
    here.write("own.json", labelme("P07_standing.png", 0.0));
    let exchanged = arguments("a", &["--landmarks", "erect=erect.json"]);
    let error = here.import_refused(&exchanged, 3);
    assert!(error.contains("P07_LB.png, which belongs to the left bending film"), "{error}");
    let (_, notes, code) = here.import(&[&exchanged[..], &["--accept"]].concat());
    assert!(code == 0 && notes.contains("accepted by --accept"), "{notes}");
    let (_, notes, code) = here.import(&arguments("b", &["--landmarks", "erect=other.json"]));
    assert!(
        code == 0 && notes.contains("scan_17.png, and the film is P07_standing.dcm"),
        "{notes}"
    );
    let (_, notes, code) = here.import(&arguments("c", &["--landmarks", "own.json"]));
    assert!(code == 0 && !notes.contains("check that"), "{notes}");
    assert_eq!(tops(&here.json("c/case.json")).len(), 1);
}

#[test]
fn one_file_per_annotator_is_imported_with_their_names() {
    let here = three_films();
    for (file, lean) in [("raterA.json", 0.0), ("raterB.json", 0.1)] {
        here.write(file, labelme("P07_standing.png", lean));
    }
    let files = ["--landmarks", "erect=raterA.json", "--landmarks", "erect=raterB.json"];
    let error = here.import_refused(&arguments("a", &files), 3);
    assert!(error.contains("--reading FILE=OBSERVER:REPEAT"), "{error}");
    let named = |b: &'static str| {
        [&files[..], &["--reading", "./raterA.json=rater-A", "--reading", b]].concat()
    };
    here.imported(&arguments("b", &named("raterB.json=B:2")));
    let case = here.json("b/case.json");
    let ids: Vec<(&str, u64)> = case["films"][0]["readings"]
        .as_array()
        .expect("readings")
        .iter()
        .filter_map(|one| Some((one["observer"].as_str()?, one["repeat"].as_u64()?)))
        .collect();
    assert_eq!(ids, [("rater-A", 1), ("B", 2)]);
    for (wrong, words) in [
        ("raterB.json=Dr. B", "`Dr. B`, and must be 1 to 64 letters"),
        ("raterB.json=B:0", "whole number from 1"),
        ("raterB.json", "expected FILE=OBSERVER"),
    ] {
        let error = here.import_refused(&arguments("c", &named(wrong)), 2);
        assert!(error.contains(words), "{error}");
    }
    let error = here.import_refused(&arguments("c", &named("raterC.json=B")), 2);
    assert!(error.contains("raterC.json, which is not a given file"), "{error}");
    let (_, notes, code) = here.import(&arguments("d", &named("raterB.json=Rater_a")));
    assert!(code == 0 && notes.contains("`Rater_a` and `rater-A` count as 2 observers"), "{notes}");
}

#[test]
fn landmarks_of_a_film_that_was_not_chosen_are_named_with_their_file() {
    let here = three_films();
    here.write("own.json", labelme("P07_standing.png", 0.0));
    here.imported(&arguments("a", &["--landmarks", "own.json"]));
    let export = ["export", "a/case.json", "--to", "csv", "--posture", "erect"];
    here.done(&[&export[..], &["--out", "erect.csv"]].concat());
    let other = here.text("erect.csv").replace("erect,", "traction,");
    here.write("traction.csv", other);
    let files = ["--landmarks", "own.json", "--landmarks", "traction.csv"];
    let error = here.import_refused(&arguments("b", &files), 2);
    assert!(
        unwrapped(&error).contains("traction.csv: the landmarks are of the traction film"),
        "{error}"
    );
}

#[test]
fn a_folder_of_landmarks_is_refused_with_the_way_to_give_its_files() {
    let here = three_films();
    std::fs::create_dir(here.path("marks")).expect("a folder");
    here.write("marks/erect.json", labelme("P07_standing.png", 0.0));
    here.write("marks/left_bending.json", labelme("P07_LB.png", 3.0));
    here.write("marks/provenance.json", r#"{"format": "spineline-provenance", "version": 1}"#);
    let error = here.import_refused(&arguments("a", &["--landmarks", "marks"]), 3);
    let words = unwrapped(&error);
    assert!(words.contains("marks: it is a folder without filenames.csv"), "{error}");
    assert!(words.contains("one by one") && words.contains("--landmarks"), "{error}");
    // The list that `export` writes beside its files.
    let all = ["marks/erect.json", "marks/left_bending.json", "marks/provenance.json"];
    let given = all.map(|file| ["--landmarks", file]).concat();
    let (_, notes, code) = here.import(&arguments("b", &given));
    assert!(code == 0 && notes.contains("marks/provenance.json is passed over"), "{notes}");
    assert_eq!(tops(&here.json("b/case.json")).len(), 2);
    // A shell gives the option the first file of `marks/*`.
    let (_, notes, code) = here.import(&arguments("c", &[&["--landmarks"], &all[..]].concat()));
    assert_eq!(code, 0, "{notes}");
    for file in &all[1..] {
        assert!(notes.contains(&format!("note: {file} is passed over as a film")), "{notes}");
    }
}

#[test]
fn a_table_states_its_observers_and_a_reading_contradicts_it() {
    let here = three_films();
    let cells = |places: &[[f64; 2]; 4]| {
        places.iter().flatten().map(f64::to_string).collect::<Vec<_>>().join(",")
    };
    let heading: Vec<String> =
        CORNERS.iter().map(|c| format!("{c}_column_px,{c}_row_px")).collect();
    let rows = |observer: &str| -> String {
        let rows =
            corners(0.0).into_iter().map(|(name, p)| format!("{observer},{name},{}\n", cells(&p)));
        format!("observer,vertebra,{}\n{}", heading.join(","), rows.collect::<String>())
    };
    here.write("named.csv", rows("B"));
    here.write("doctor.csv", rows("Dr. A. B."));
    let error = here.import_refused(
        &arguments("a", &["--landmarks", "erect=named.csv", "--reading", "named.csv=C"]),
        3,
    );
    assert!(error.contains("named.csv") && error.contains("states observer B"), "{error}");
    let error = here.import_refused(&arguments("a", &["--landmarks", "erect=doctor.csv"]), 3);
    assert!(
        error.contains("doctor.csv: line 2, column `observer`") && error.contains("`Dr. A. B.`"),
        "{error}"
    );
}

#[test]
fn suggestions_of_the_command_line_name_no_other_side_posture_or_value() {
    let here = folder();
    for (arguments, suggested) in [
        (&["x", "--patient-right", "image-left"][..], None),
        (&["x", "--case-id", "A", "--out", "o", "--patient-anterior", "image-lefft"], None),
        (&["x", "--case-id", "A", "--out", "o", "--film", "standing=1"], None),
        (&["x", "--landmark", "a.json"], Some("--landmarks")),
        (&["x", "--pacient-left", "image-left"], Some("--patient-left")),
    ] {
        let error = here.import_refused(arguments, 2);
        match suggested {
            None => assert!(!error.contains("similar"), "{error}"),
            Some(option) => assert!(error.contains(&format!("'{option}'")), "{error}"),
        }
    }
    let error =
        here.import_refused(&["x", "--case-id", "A", "--out", "o", "--film", "standing=1"], 2);
    assert!(error.contains("erect, left_bending, right_bending, neutral, traction"), "{error}");
}
