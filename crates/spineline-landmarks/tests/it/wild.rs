//! Files as people bring them: what was not placed, spreadsheets, and files of other programs.

use spineline::anatomy::{ImageSide, Level, Posture};
use spineline::measure::{ImageGeometry, MeasureFault};
use spineline_landmarks::{
    ColumnHint, LandmarkError, LandmarkFile, LandmarkHint, LandmarkReadings, parse_coco, parse_csv,
    parse_labelme, parse_landmarks, parse_mat, parse_slicer,
};

use crate::count_vertebrae;
use crate::faults::{HEADING, hint, image};

const CORNERS: [&str; 4] = ["superior_left", "superior_right", "inferior_left", "inferior_right"];

/// Corners of a straight spine, whose left is on the right of the picture.
fn places(level: Level) -> [[f64; 2]; 4] {
    let top = 1800.5 - 100.0 * f64::from(level as u8);
    [[546.25, top], [454.0, top], [550.0, top + 60.0], [450.0, top + 60.0]]
}

fn row(level: Level) -> String {
    let cells: Vec<String> = places(level).iter().flatten().map(f64::to_string).collect();
    format!("erect,A,1,{level},{}", cells.join(","))
}

fn table() -> String {
    let rows: Vec<String> = Level::MODEL.into_iter().map(row).collect();
    format!("{HEADING}\n{}\n", rows.join("\n"))
}

fn read(text: &str) -> LandmarkFile {
    parse_landmarks(text.as_bytes(), &hint()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[track_caller]
fn refused(bytes: &[u8], parts: &[&str]) -> LandmarkError {
    let error = parse_landmarks(bytes, &hint()).expect_err("wrong on purpose");
    let words = format!("{error}; {}", error.help());
    for part in parts {
        assert!(words.contains(part), "`{words}` does not say {part}");
    }
    error
}

#[test]
fn tables_of_excel_are_read_as_the_plain_one() {
    let plain = read(&table());
    let semicolons = table().replace(',', ";").replace('.', ",");
    let capitals = table().replacen("vertebra", "Vertebra", 1).replacen("posture", " POSTURE ", 1);
    let spaced = table().replacen("superior_left_row_px", "Superior left row (px)", 1);
    let longer = table().replace('\n', ",,\n");
    let floats = table().replace(",A,1,", ",A,1.0,");
    let notes = table().replacen('\n', ",notes\n", 1).replace(".5\n", ".5,\n");
    for text in [
        format!("sep=;\r\n{}", semicolons.replace('\n', "\r\n")),
        format!("\u{feff}sep=,\n{}", table()),
        format!("\n{}", table()),
        capitals,
        spaced,
        longer,
        floats,
        notes,
    ] {
        assert_eq!(read(&text).films, plain.films, "{text}");
    }
    let tabs = table().replace(',', "\t");
    for (mark, unit) in
        [([0xff, 0xfe], u16::to_le_bytes as fn(u16) -> [u8; 2]), ([0xfe, 0xff], u16::to_be_bytes)]
    {
        let mut bytes = mark.to_vec();
        bytes.extend(tabs.encode_utf16().flat_map(unit));
        assert_eq!(parse_landmarks(&bytes, &hint()).expect("UTF-16").films, plain.films);
    }
    let full = table().replacen('\n', ",notes\n", 1).replace(".5\n", ".5,seen\n");
    refused(full.as_bytes(), &["line 1, column 13", "unknown column `notes`"]);
}

#[test]
fn an_empty_observer_or_repeat_is_that_of_the_caller_in_all_rows_or_none() {
    let plain = read(&table());
    for text in [
        table().replace(",A,1,", ",A,,"),
        table().replace(",A,1,", ",,1,"),
        table().replace(",A,1,", ",,,"),
    ] {
        assert_eq!(read(&text).films, plain.films);
    }
    let some = table().replacen(",A,1,L4", ",,1,L4", 1);
    refused(some.as_bytes(), &["line 3", "the observer, which other rows lack"]);
}

#[test]
fn mixed_decimal_marks_are_named_with_line_and_value() {
    let semicolons = table().replace(',', ";").replace('.', ",");
    let mixed = semicolons.replacen("L1;546,25", "L1;546.25", 1);
    let error = refused(
        mixed.as_bytes(),
        &["line 5", "`546.25` has a decimal point, and `546,25` on line 2 a decimal comma"],
    );
    assert!(!error.help().contains("option"), "{}", error.help());
}

#[test]
fn a_row_is_named_by_its_line_with_any_ends_of_lines() {
    for end in ["\n", "\r\n"] {
        let text = table().replacen("T12", "X12", 1).replace('\n', end);
        refused(text.as_bytes(), &["line 6", "X12"]);
    }
}

#[test]
fn a_table_from_memory_is_named_by_its_rows_with_film_vertebra_and_value() {
    let columns = ColumnHint { counts_rows: true, ..ColumnHint::default() };
    let hint = LandmarkHint { columns, ..hint() };
    let text = table().replacen("T12,546.25", "T12,-1e7", 1);
    let error = parse_landmarks(text.as_bytes(), &hint).expect_err("far outside");
    assert!(error.to_string().starts_with("row 5 of the table, column `"), "{error}");
    let place = error.place();
    assert_eq!((place.film, place.level), (Some(Posture::Erect.into()), Some(Level::T12)));
    assert_eq!((place.value, place.limit), (Some(-1e7), Some(-1e6)), "{error}");
    let mistyped = table().replacen("superior_left_row_px", "superior_left_rwo_px", 1);
    let error = parse_landmarks(mistyped.as_bytes(), &hint).expect_err("a typo").to_string();
    assert!(error.starts_with("the heading of the table"), "{error}");
}

#[test]
fn rows_without_numbers_are_not_placed_in_any_spelling() {
    for blank in ["", "NaN", "NA", "n/a", "-", "null", "None", "#N/A", "<NA>"] {
        let cells = [blank; 8].join(",");
        let text = table().replacen(&row(Level::T12), &format!("erect,A,1,T12,{cells}"), 1);
        let file = read(&text);
        assert_eq!(count_vertebrae(&file.films[0]), 14, "{blank}");
        assert!(file.remarks[0].contains("T12 of line 6"), "{:?}", file.remarks);
        let crests = format!("{}erect,,,iliac_crests,{cells}\n", table());
        assert_eq!(read(&crests).films[0].iliac_crests, None);
        let one = table().replacen("L1,546.25", &format!("L1,{blank}"), 1);
        refused(one.as_bytes(), &["line 5, L1", "missing: superior_left"]);
    }
}

#[test]
fn columns_of_other_names_are_read_and_columns_without_landmarks_skipped() {
    let notes = table().replacen('\n', ",Quality note\n", 1).replace(".5\n", ".5,good\n");
    let own = notes.replacen("vertebra", "Level", 1).replacen("observer", "Rater (code)", 1);
    let columns = |renamed: &[(&str, &str)]| ColumnHint {
        renamed: renamed.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect(),
        ignored: ["quality_note".to_owned()].into(),
        ..ColumnHint::default()
    };
    let read_with = |columns| parse_landmarks(own.as_bytes(), &LandmarkHint { columns, ..hint() });
    let found = read_with(columns(&[("level", "vertebra"), ("rater_code", "observer")]));
    assert_eq!(found.expect("a table").films, read(&table()).films);
    for (renamed, parts) in [
        (&[("level", "vertebra"), ("rater", "observer")][..], ["line 1", "`rater` is missing"]),
        (&[("level", "vertebra"), ("rater_code", "observr")], ["`observr`", "mean `observer`"]),
        (&[("level", "vertebra"), ("rater_code", "vertebra")], ["`vertebra`", "given twice"]),
    ] {
        let error = read_with(columns(renamed)).expect_err("wrong on purpose").to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

#[test]
fn a_posture_that_is_none_is_answered_with_all_and_no_suggestion() {
    for posture in ["Upright", "standing", "left", "supine"] {
        let text = table().replacen("\nerect", &format!("\n{posture}"), 1);
        let error = refused(
            text.as_bytes(),
            &[posture, "erect, left_bending, right_bending, neutral, traction"],
        );
        assert!(!error.to_string().contains("did you mean"), "{error}");
    }
    assert_eq!(
        read(&table().replace("\nerect", "\nLeft-Bending")).films[0].posture,
        Some(Posture::LeftBending)
    );
}

#[test]
fn an_observer_that_a_study_refuses_is_refused_with_its_value() {
    for name in ["Dr. A. B.", "Müller", "A/B", "A B"] {
        let text = table().replacen(",A,", &format!(",{name},"), 1);
        refused(text.as_bytes(), &["line 2, column `observer`", name, "letters, digits"]);
    }
    let json = coco(CORNERS, "T5", "1,1,2").replacen(
        "\"id\":1",
        "\"spineline\":{\"observer\":\"Dr. B\"},\"id\":1",
        1,
    );
    let error = parse_coco(json.as_bytes(), &hint()).expect_err("no code").to_string();
    assert!(error.contains("annotations[0]") && error.contains("Dr. B"), "{error}");
}

/// A dataset of one vertebra with one place and visibility.
fn coco(names: [&str; 4], category: &str, first: &str) -> String {
    let names = names.map(|name| format!("\"{name}\"")).join(",");
    format!(
        r#"{{"images":[{{"id":7,"file_name":"a.png","width":1000.0,"height":2000}}],"categories":[{{"id":3.0,"name":"{category}","keypoints":[{names}]}},{{"id":4,"name":"T4","keypoints":[{names}]}}],"annotations":[{{"id":1,"image_id":7.0,"category_id":3,"keypoints":[{first},10,5,2,52,30,2,12,29,1]}},{{"image_id":7,"category_id":4,"keypoints":[50,7,2,10,5,2,52,30,2,12,29,1]}}]}}"#
    )
}

#[test]
fn a_key_point_that_was_not_placed_is_missing_by_its_name() {
    for first in ["NaN,NaN,0", "null,null,0", "0,0,0", "NaN,NaN,2", "\"\",\"\",0", "null,null,null"]
    {
        let error =
            refused(coco(CORNERS, "T5", first).as_bytes(), &["T5", "missing: superior_left"]);
        assert!(matches!(error.cause(), LandmarkError::Incomplete { .. }), "{first}: {error:?}");
        assert_eq!((error.place().film, error.place().level), (None, Some(Level::T5)));
        let all = format!("{first},{first},{first},{first}");
        let text = coco(CORNERS, "T5", &all).replacen(",10,5,2,52,30,2,12,29,1]", "]", 1);
        let file = parse_coco(text.as_bytes(), &hint()).expect(first);
        assert_eq!(count_vertebrae(&file.films[0]), 1, "T4 alone");
    }
    for none in ["\"keypoints\":[]", "\"keypoints\":null", "\"bbox\":[0,0,1,1]"] {
        let text = coco(CORNERS, "T5", "50,7,2");
        let text = text.replacen("\"keypoints\":[50,7,2,10,5,2,52,30,2,12,29,1]", none, 1);
        assert_eq!(count_vertebrae(&parse_coco(text.as_bytes(), &hint()).expect(none).films[0]), 1);
    }
}

#[test]
fn an_infinite_number_is_refused_with_its_place() {
    for (first, shown) in [("Infinity,1,2", "`inf`"), ("1,-Infinity,2", "`-inf`")] {
        let text = coco(CORNERS, "T5", first);
        refused(text.as_bytes(), &["T5", "superior_left", shown, "is not a number between"]);
    }
    let cells = ["inf"; 8].join(",");
    let text = table().replacen(&row(Level::T12), &format!("erect,A,1,T12,{cells}"), 1);
    refused(text.as_bytes(), &["line 6", "superior_left_column_px", "`inf`"]);
}

#[test]
fn key_points_without_a_vertebra_say_that_it_is_missing() {
    let numbers = coco(["1", "2", "3", "4"], "L4", "1,1,2");
    refused(
        numbers.as_bytes(),
        &["categories[0] `L4`", "`1`", "the vertebra is missing in the name"],
    );
    let shape = r#"{"label":"superior_left","points":[[1,2]],"group_id":1,"shape_type":"point"}"#;
    let labelme = format!(r#"{{"imagePath":"a.png","shapes":[{shape}]}}"#);
    let error = refused(labelme.as_bytes(), &["shapes[0]", "the vertebra is missing in the name"]);
    assert!(!error.to_string().contains("did you mean"));
}

fn slicer(change: &str) -> String {
    let point = |level: &str, corner: &str, x: f64, y: f64| {
        format!(
            r#"{{"label":"{level}_{corner}","position":[{x},{y},0.0],"positionStatus":"defined"}}"#
        )
    };
    let body = |level, top: f64| {
        let [a, b, c, d] = CORNERS;
        [
            point(level, a, 5.0, top),
            point(level, b, -5.0, top),
            point(level, c, 5.0, top + 8.0),
            point(level, d, -5.0, top + 8.0),
        ]
    };
    let mut points = [body("T5", 20.0), body("T6", 40.0)].concat();
    for (point, status) in
        points.iter_mut().take(4).zip(["undefined", "preview", "missing", "defined"])
    {
        let (label, _) = point.split_once(",\"position\"").expect("a position");
        *point = format!(r#"{label},"position":{change},"positionStatus":"{status}"}}"#);
    }
    format!(
        r#"{{"markups":[{{"type":"Fiducial","coordinateSystem":"LPS","controlPoints":[{}]}}]}}"#,
        points.join(",")
    )
}

#[test]
fn points_of_slicer_without_a_position_are_passed_over() {
    let image =
        ImageGeometry { columns: 100, rows: 100, spacing: None, patient_left: ImageSide::Right };
    let hint = LandmarkHint { image: Some(image), ..hint() };
    for empty in
        ["\"\"", "[]", "null", "[NaN,NaN,NaN]", "[null,null,null]", "[\"nan\",\"nan\",\"nan\"]"]
    {
        let file = parse_slicer(slicer(empty).as_bytes(), &hint).expect(empty);
        assert_eq!((count_vertebrae(&file.films[0]), file.remarks.len()), (1, 4), "{empty}");
    }
    for wrong in ["[1,2]", "\"here\"", "7"] {
        assert!(parse_slicer(slicer(wrong).as_bytes(), &hint).is_err(), "{wrong}");
    }
}

#[test]
fn shapes_of_labelme_without_a_place_are_passed_over() {
    for points in ["[]", "null", "[[NaN,NaN]]", "[[null,null]]", "[[]]"] {
        let shapes: Vec<String> = CORNERS
            .iter()
            .zip(places(Level::T5))
            .map(|(corner, [x, y])| {
                format!(r#"{{"label":"T5_{corner}","points":[[{x},{y}]],"shape_type":"point"}}"#)
            })
            .chain([format!(
                r#"{{"label":"T4_superior_left","points":{points},"shape_type":"point"}}"#
            )])
            .collect();
        let text = format!(
            r#"{{"imagePath":"a.png","imageWidth":1000.0,"imageHeight":2000,"shapes":[{}]}}"#,
            shapes.join(",")
        );
        let file = parse_labelme(text.as_bytes(), &hint()).expect(points);
        assert_eq!((count_vertebrae(&file.films[0]), file.films[0].size), (1, Some((1000, 2000))));
        assert!(file.remarks[0].contains("T4_superior_left"), "{:?}", file.remarks);
    }
}

#[test]
fn files_of_other_programs_are_named_with_the_export_that_works() {
    let matlab_4 =
        [&0_u32.to_le_bytes()[..], &[68, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0], b"p2\0"]
            .concat();
    for (bytes, parts) in [
        (&b"MATLAB 7.3 MAT-file, Platform: GLNXA64"[..], &["7.3 (HDF5)", "-v7"][..]),
        (&matlab_4, &["version 4", "-v7"]),
        (
            br#"[{"id":1,"data":{"image":"a.png"},"annotations":[{"result":[]}]}]"#,
            &["Label Studio", "COCO"],
        ),
        (br#"[{"image_id":1,"category_id":1,"keypoints":[]}]"#, &["COCO results", "`annotations`"]),
        (b"PK\x03\x04\x14\0[Content_Types].xml xl/workbook.xml", &["spreadsheet", "CSV"]),
        (b"<?xml version=\"1.0\"?><annotations><meta></meta>", &["CVAT", "COCO Keypoints"]),
    ] {
        refused(bytes, parts);
    }
}

/// A MATLAB file of version 5 with `p2` by columns.
fn mat(points: &[[f64; 2]]) -> Vec<u8> {
    let mut values: Vec<u8> = Vec::new();
    for column in 0..2 {
        values.extend(points.iter().flat_map(|point| point[column].to_le_bytes()));
    }
    let element = |kind: u32, data: &[u8]| {
        let padded = data.len().next_multiple_of(8);
        let mut all = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        all.extend(data);
        all.resize(8 + padded, 0);
        all
    };
    let words = |all: &[u32]| all.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let inside = [
        element(6, &words(&[6, 0])),
        element(5, &words(&[points.len() as u32, 2])),
        element(1, b"p2"),
        element(9, &values),
    ]
    .concat();
    let mut file = format!("{:<124}", "MATLAB 5.0 MAT-file").into_bytes();
    file.extend([0, 1, b'I', b'M']);
    file.extend(element(14, &inside));
    file
}

/// The corners of AASCE in an order of the four.
fn aasce(order: [usize; 4]) -> Vec<[f64; 2]> {
    let body = |level: Level| {
        let [superior_left, superior_right, inferior_left, inferior_right] = places(level);
        // The patient's left is on the picture's right.
        let four = [superior_right, superior_left, inferior_right, inferior_left];
        order.map(|place| four[place])
    };
    Level::ALL.into_iter().rev().flat_map(body).collect()
}

#[test]
fn corners_that_run_around_every_body_are_named_as_exchanged() {
    let judged = |order| {
        let mut file = parse_mat(&mat(&aasce(order)), &hint()).expect("a film");
        file.films.remove(0).into_film(Some(Posture::Erect), Some(image()))
    };
    judged([0, 1, 2, 3]).expect("the order of the set");
    for (order, words) in [
        ([0, 1, 3, 2], "inferior left and inferior right are exchanged"),
        ([1, 0, 2, 3], "superior left and superior right are exchanged"),
        ([2, 3, 0, 1], "superior left and inferior left are exchanged"),
        ([0, 2, 1, 3], "superior left and inferior right are exchanged"),
    ] {
        let error = judged(order).expect_err(words);
        assert!(error.to_string().contains(words), "{error}");
        let LandmarkError::Marks(error) = error else { panic!("{error}") };
        assert!(matches!(error.fault, MeasureFault::CornerOrder { count: 17, .. }), "{error}");
    }
}

#[test]
fn what_matlab_marks_as_no_number_is_not_placed() {
    let mut points = aasce([0, 1, 2, 3]);
    points[..4].fill([f64::NAN; 2]);
    let file = parse_mat(&mat(&points), &hint()).expect("a film without T1");
    assert_eq!(count_vertebrae(&file.films[0]), 16);
    points[5] = [f64::NAN; 2];
    let error = parse_mat(&mat(&points), &hint()).expect_err("half of T2").to_string();
    assert!(error.contains("T2") && error.contains("upper right"), "{error}");
    points[5] = [f64::INFINITY, 1.0];
    let error = parse_mat(&mat(&points), &hint()).expect_err("infinite").to_string();
    assert!(error.contains("T2") && error.contains("`inf`"), "{error}");
}

#[test]
fn names_of_pictures_are_kept_whole() {
    let long = "C:\\\\Users\\\\reader\\\\Documents\\\\study of bending films\\\\P07_LB.png";
    let text = coco(CORNERS, "T5", "50,7,2").replacen("a.png", long, 1);
    let file = parse_coco(text.as_bytes(), &hint()).expect("a film");
    assert!(file.films[0].picture.as_deref().is_some_and(|name| name.ends_with("P07_LB.png")));
    let LandmarkReadings::Corners(readings) = &file.films[0].landmarks else { panic!("corners") };
    assert_eq!(readings[0].vertebrae.len(), 2);
    assert!(parse_csv(b"", &hint()).is_err());
}

#[test]
fn text_that_is_not_utf_8_is_refused_with_the_way_to_save_it() {
    let latin_1 = |text: &str| -> Vec<u8> {
        text.bytes().map(|byte| if byte == b'?' { 0xfc } else { byte }).collect()
    };
    let rows = table().replace(",A,", ",M?ller,");
    for text in [" {\"markups\":\"M?ller\"}", &rows] {
        let error = parse_landmarks(&latin_1(text), &hint()).expect_err(text);
        assert!(matches!(error.cause(), LandmarkError::Encoding { .. }), "{error}");
        assert!(error.help().contains("UTF-8"), "{}", error.help());
    }
}
