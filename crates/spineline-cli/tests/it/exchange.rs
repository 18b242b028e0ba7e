//! Landmarks of several readings, and of sets of pictures, into cases.

use std::fs;

use serde_json::{Value, json};

use crate::maker::{EXPLICIT, Maker};
use crate::program::folder;

/// An empty DICOM film, as large as the picture of a case says and with the same side to the left.
fn film(image: &Value) -> Vec<u8> {
    let size = |key: &str| {
        u16::try_from(image[key].as_u64().expect("a size")).expect("a picture of a film")
    };
    let (columns, rows) = (size("columns"), size("rows"));
    let mut maker = Maker::new(columns, rows, &vec![7; usize::from(columns) * usize::from(rows)]);
    let left = if image["patient_left"] == "image_left" { "R\\F" } else { "L\\F" };
    maker.text((0x20, 0x20), "CS", left).text((0x28, 0x30), "DS", "0.1\\0.1");
    maker.file(EXPLICIT)
}

#[test]
fn reports_of_several_readings_are_imported_together() {
    let here = folder();
    here.done(&["phantom", "--subject", "1", "--out", "p", "--noise", "2"]);
    let mut case = here.json("p/phantom-rod-01.json");
    let erect = &mut case["films"][0];
    here.write("p/erect.dcm", film(&erect["image"]));
    erect["image"]["file"] = "erect.dcm".into();
    let mut second = erect["readings"][0].clone();
    second["observer"] = json!("other");
    erect["readings"].as_array_mut().expect("readings").truncate(1);
    erect["readings"].as_array_mut().expect("readings").push(second);
    here.write("p/two.json", case.to_string());
    let export = ["export", "p/two.json", "--to", "dicom-sr", "--posture", "erect", "--out", "sr"];
    here.done(&export);
    let import = |out: &str, reports: [&str; 2]| {
        let [first, second] = reports;
        let mut line = vec!["import", "p/erect.dcm", "--case-id", "A", "--out", out];
        line.extend(["--film", "erect=1"]);
        line.extend(["--landmarks", first, "--landmarks", second]);
        here.run(&line)
    };
    let (_, error, code) = import("both", ["sr/erect-1.dcm", "sr/erect-2.dcm"]);
    assert_eq!(code, 0, "{error}");
    let found = here.json("both/case.json");
    let readings = found["films"][0]["readings"].as_array().expect("readings");
    let observers: Vec<&str> = readings.iter().filter_map(|one| one["observer"].as_str()).collect();
    assert_eq!(readings.len(), 2, "{found}");
    assert!(observers.contains(&"other"), "{observers:?}");
    let (_, error, code) = import("twice", ["sr/erect-1.dcm", "sr/erect-1.dcm"]);
    assert!(code == 3 && error.contains("has landmarks already"), "{error}");
}

/// Landmarks of a straight spine, as parts of the picture's size: 68 columns, then 68 rows.
fn straight() -> String {
    let mut numbers = vec![String::new(); 136];
    for vertebra in 0..17 {
        let top = 0.05 + 0.05 * f64::from(vertebra);
        for (corner, (column, row)) in
            [(0.4, top), (0.6, top), (0.4, top + 0.035), (0.6, top + 0.035)].into_iter().enumerate()
        {
            let place = 4 * usize::try_from(vertebra).expect("few") + corner;
            numbers[place] = format!("{column:.5}");
            numbers[68 + place] = format!("{row:.5}");
        }
    }
    numbers.join(",")
}

#[test]
fn sizes_of_a_set_of_pictures_are_read_from_the_pictures() {
    let here = folder();
    for folder in ["set/labels/training", "set/data/training"] {
        fs::create_dir_all(here.path(folder)).expect("a folder");
    }
    here.write("set/labels/training/filenames.csv", "a.png\nb.png\n");
    let rows = format!("{}\n{}\n", straight(), straight());
    here.write("set/labels/training/landmarks.csv", rows);
    for (name, columns, rows) in [("a.png", 400, 1000), ("b.png", 300, 900)] {
        let file = fs::File::create(here.path("set/data/training").join(name)).expect("a file");
        let mut encoder = png::Encoder::new(file, columns, rows);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().expect("a header");
        let size = usize::try_from(columns * rows).expect("small");
        writer.write_image_data(&vec![90; size]).expect("pixels");
    }
    let line =
        ["import", "set/labels/training", "--aasce", "--patient-left", "image-right", "--out", "c"];
    here.done(&line);
    let size = |name: &str| {
        let case = here.json(name);
        let image = &case["films"][0]["image"];
        (image["columns"].as_u64(), image["rows"].as_u64())
    };
    // Lines of the tables count from 1.
    assert_eq!(size("c/training-0001.json"), (Some(400), Some(1000)));
    assert_eq!(size("c/training-0002.json"), (Some(300), Some(900)));
    let verdicts = here.text("c/training-verdicts.csv");
    assert!(verdicts.contains("\n1,training-0001,clean"), "{verdicts}");
    fs::remove_file(here.path("set/data/training/b.png")).expect("a file");
    let (_, error, code) = here.run(&line.map(|word| if word == "c" { "d" } else { word }));
    assert!(code == 3 && error.contains("filenames.csv, line 2"), "{error}");
    assert!(error.contains("--pictures"), "{error}");
    here.write("wrong.csv", "name,width_px,height_px\na.png,400,1000\n");
    let line = line.map(|word| if word == "c" { "e" } else { word });
    let error = here.refused(&[&line[..], &["--sizes", "wrong.csv"]].concat(), 3);
    let place = "error: wrong.csv: the sizes of the pictures, line 1: the column `filename`";
    assert!(error.starts_with(place), "{error}");
}
