//! Wrong landmarks and invalid files: each fault gives an error that names its place.

use std::collections::BTreeMap;

use proptest::prelude::*;
use spineline::anatomy::{ImageSide, Level, Posture};
use spineline::measure::{CornerFault, ImageGeometry, MeasureFault};
use spineline::spatial::{Angle, Pixel};
use spineline_landmarks::{
    LandmarkError, LandmarkHint, LandmarkReadings, LandmarkTarget, MAX_ROWS, export_landmarks,
    parse_coco, parse_csv, parse_labelme, parse_landmarks, parse_slicer,
};

use crate::{count_vertebrae, exchange};

pub const HEADING: &str = "posture,observer,repeat,vertebra,superior_left_column_px,superior_left_row_px,superior_right_column_px,\
superior_right_row_px,inferior_left_column_px,inferior_left_row_px,inferior_right_column_px,inferior_right_row_px";

pub fn hint() -> LandmarkHint {
    LandmarkHint { patient_left: Some(ImageSide::Right), ..LandmarkHint::default() }
}

pub fn image() -> ImageGeometry {
    ImageGeometry { columns: 1000, rows: 2000, spacing: None, patient_left: ImageSide::Right }
}

/// A row of a straight spine; the patient's left is the picture's right.
fn row(level: Level) -> String {
    let top = 1800.5 - 100.0 * level as u8 as f64;
    format!("erect,A,1,{level},546,{top},454,{top},550,{0},450,{0}", top + 60.0)
}

fn table(rows: &[String]) -> String {
    format!("{HEADING}\n{}\n", rows.join("\n"))
}

fn whole() -> Vec<String> {
    Level::MODEL.into_iter().map(row).collect()
}

#[track_caller]
fn refused(text: &str, parts: &[&str]) -> LandmarkError {
    let error = parse_csv(text.as_bytes(), &hint()).expect_err("the text is wrong on purpose");
    let words = error.to_string();
    for part in parts {
        assert!(words.contains(part), "`{words}` does not say {part}");
    }
    assert!(!error.help().is_empty());
    error
}

/// What the core says of a table with some rows changed.
fn judged(change: impl Fn(&mut Vec<String>)) -> Result<(), LandmarkError> {
    let mut rows = whole();
    change(&mut rows);
    let mut file = parse_csv(table(&rows).as_bytes(), &hint()).expect("a table");
    file.films.remove(0).into_film(None, Some(image())).map(|_| ())
}

/// Another order of the four corners of a row.
fn reordered(row: &str, order: [usize; 4]) -> String {
    let cells: Vec<&str> = row.split(',').collect();
    let mut out: Vec<&str> = cells[..4].to_vec();
    out.extend(order.into_iter().flat_map(|i| [cells[4 + 2 * i], cells[5 + 2 * i]]));
    out.join(",")
}

#[test]
fn a_valid_table_gives_a_valid_film() {
    assert!(judged(|_| {}).is_ok());
    let mut file = parse_csv(table(&whole()).as_bytes(), &hint()).expect("a table");
    let film = file.films.remove(0);
    assert_eq!((film.posture, count_vertebrae(&film)), (Some(Posture::Erect), 15));
}

#[test]
fn f17_corners_in_another_order_are_detected() {
    let at = Level::T8.model_index().expect("of the model");
    for (order, fault) in [
        ([1, 0, 2, 3], CornerFault::Crossed),
        ([0, 1, 3, 2], CornerFault::Crossed),
        ([2, 3, 0, 1], CornerFault::UpsideDown),
        ([1, 0, 3, 2], CornerFault::SidesExchanged),
    ] {
        match judged(|rows| rows[at] = reordered(&rows[at], order)) {
            Err(LandmarkError::Marks(error)) => {
                assert_eq!(error.at.level, Some(Level::T8));
                assert_eq!(error.fault, MeasureFault::Corners { fault });
            }
            other => panic!("{order:?}: {other:?}"),
        }
    }
}

#[test]
fn f18_a_film_with_all_sides_swapped_is_mirrored() {
    let all = judged(|rows| rows.iter_mut().for_each(|row| *row = reordered(row, [1, 0, 3, 2])));
    let Err(LandmarkError::Marks(error)) = all else { panic!("{all:?}") };
    assert_eq!(error.fault, MeasureFault::FilmMirrored { count: 15 });
}

#[test]
fn f19_a_film_upside_down_is_refused() {
    let all = judged(|rows| rows.iter_mut().for_each(|row| *row = reordered(row, [2, 3, 0, 1])));
    let words = all.expect_err("upside down").to_string();
    assert!(words.contains("in all 15 vertebrae superior left and inferior left"), "{words}");
}

#[test]
fn f20_repeated_and_missing_vertebrae_are_named() {
    let mut rows = whole();
    rows.push(row(Level::T12).replace("T12", "Th12"));
    refused(&table(&rows), &["line 17", "T12", "twice", "line 6"]);
    for (name, part) in [("T13", "thirteenth"), ("L6", "sixth"), ("S1", "sacral"), ("L7", "`L7`")] {
        refused(
            &table(&[row(Level::T12).replace("T12", name)]),
            &["line 2", "`vertebra`", name, part],
        );
    }
}

#[test]
fn f21_and_f22_an_absent_vertebra_is_accepted_and_not_interpolated() {
    let rows: Vec<String> = whole().into_iter().filter(|row| !row.contains(",T7,")).collect();
    let mut file = parse_csv(table(&rows).as_bytes(), &hint()).expect("a table");
    let film = file.films.remove(0);
    assert_eq!(count_vertebrae(&film), 14);
    film.into_film(None, Some(image())).expect("marks may come one by one");
}

#[test]
fn f24_an_invalid_number_is_reported_with_its_cell() {
    for value in ["NaN", ""] {
        let text = table(&[row(Level::T5)]).replacen(",546,", &format!(",{value},"), 1);
        refused(&text, &["line 2, T5", "missing: superior_left"]);
    }
    for value in ["inf", "-Infinity", "1e308", "-1e7", "12 px", "=1+2", "0x10", "1,5"] {
        let quoted = format!("\"{value}\"");
        let text = table(&[row(Level::T5)]).replacen(",546,", &format!(",{quoted},"), 1);
        refused(&text, &["line 2", "superior_left_column_px"]);
    }
}

#[test]
fn f25_coincident_points_and_points_off_the_picture_are_refused() {
    let flat = judged(|rows| rows[3] = "erect,A,1,L1,500,500,500,500,500,500,500,500".to_owned());
    let Err(LandmarkError::Marks(error)) = flat else { panic!("{flat:?}") };
    assert_eq!(error.at.level, Some(Level::L1));
    assert_eq!(error.fault, MeasureFault::Corners { fault: CornerFault::Flat });
    let off = judged(|rows| rows[3] = rows[3].replace(",550,", ",1550,"));
    let Err(LandmarkError::Marks(error)) = off else { panic!("{off:?}") };
    assert!(matches!(error.fault, MeasureFault::OffImage { .. }), "{error}");
}

#[test]
fn f29_a_single_iliac_crest_is_not_used() {
    let crests = |cells: &str| format!("erect,,,iliac_crests,{cells}");
    let mut rows = whole();
    rows.push(crests("700,1700,300,1710,,,,"));
    let file = parse_csv(table(&rows).as_bytes(), &hint()).expect("a table");
    let found = file.films[0].iliac_crests.expect("two crests");
    assert_eq!((found.left.column_px, found.right.row_px), (700.0, 1710.0));
    refused(&table(&[crests("700,1700,,,,,,")]), &["line 2", "iliac_crest_right"]);
    refused(&table(&[crests("700,1700,300,1710,1,,,")]), &["inferior_left_column_px", "empty"]);
    refused(&table(&[crests("700,1700,300,1710,,,,"), crests("1,1,300,1710,,,,")]), &["twice"]);
}

#[test]
fn angles_of_more_than_half_a_turn_are_refused() {
    let rows = [format!("{},362.2", row(Level::T12))];
    let axis = table(&rows).replacen('\n', ",axis_clockwise_deg\n", 1);
    refused(&axis, &["line 2", "axis_clockwise_deg", "`362.2` is not an angle"]);
    let placed = "posture,observer,repeat,vertebra,location_left_mm,location_cranial_mm,tilt_right_deg\nerect,A,1,T12,1,2,-181\n";
    refused(placed, &["line 2", "tilt_right_deg", "`-181` is not an angle"]);
}

#[test]
fn an_axis_of_more_than_half_a_turn_in_a_report_is_refused() {
    let mut case = exchange::case(ImageSide::Right);
    case.films.truncate(1);
    let film = &mut case.films[0];
    let image = exchange::image(film);
    let source = exchange::source((image.columns, image.rows), film.posture);
    let sources = BTreeMap::from([(film.posture, source)]);
    let readings = film.landmarks.corner_readings_mut();
    let l4 = readings[0].vertebrae.get_mut(&Level::L4).expect("marked");
    l4.axis_clockwise = Some(Angle::from_deg(200.0));
    let target =
        LandmarkTarget::DicomSr { sources: &sources, curves: &[], written: ["20260131", "101500"] };
    let files = export_landmarks(&case, None, target).expect("reports");
    let error = parse_landmarks(&files[0].bytes, &LandmarkHint::default()).expect_err("200°");
    let place = error.place();
    let LandmarkError::Outside { at, expected, .. } = error else { panic!("{error}") };
    assert!(at.starts_with("measurement group"), "{at}");
    assert!((place.value.expect("a number") - 200.0).abs() < 1e-9, "{place:?}");
    assert_eq!(place.limit, Some(180.0));
    assert_eq!(expected, "an angle in degrees from -180 to 180");
}

#[test]
fn f30_tables_from_spreadsheets_are_read() {
    let plain = parse_csv(table(&whole()).as_bytes(), &hint()).expect("a table");
    let german = table(&whole()).replace(',', ";").replace('.', ",");
    let quoted = table(&whole()).replace("erect", "\"erect\"").replace("550", "\"550\"");
    for text in [
        format!("\u{feff}{}", table(&whole())),
        table(&whole()).replace('\n', "\r\n"),
        german.clone(),
        table(&whole()).replace(',', ";"),
        table(&whole()).replace(',', "\t"),
        quoted,
        table(&whole()) + ",,,,,,,,,,,\n",
    ] {
        assert_eq!(parse_csv(text.as_bytes(), &hint()).expect(&text).films, plain.films);
    }
    let mixed = german.replacen(",5;", ".5;", 1);
    refused(&mixed, &["decimal point", "line 2", "decimal comma"]);
    refused(&german.replacen("posture;", "posture,", 1), &["line 1", "more than one"]);
}

#[test]
fn f30_a_formula_is_refused_as_observer() {
    for name in ["=cmd", "+1", "-B", "@x"] {
        refused(
            &table(&[row(Level::T5).replace(",A,", &format!(",{name},"))]),
            &["`observer`", "formula"],
        );
    }
}

#[test]
fn f30_too_many_rows_are_refused() {
    let mut text = String::from(HEADING);
    for repeat in 1..=MAX_ROWS + 1 {
        text.push_str(&format!("\nerect,A,{repeat},T5,550,5,450,5,550,9,450,9"));
    }
    refused(&text, &["rows", "100000"]);
}

#[test]
fn unknown_columns_are_reported_with_the_nearest_name_and_postures_with_all() {
    refused(
        &table(&whole()).replace("superior_left_row_px", "superior_left_rows_px"),
        &["`superior_left_row_px`?"],
    );
    refused(&table(&whole()).replace("repeat,", "posture,"), &["`posture`", "twice"]);
    refused(&table(&whole()).replace("inferior_right_row_px", "posture"), &["twice"]);
    refused(
        &table(&[row(Level::T5).replace("erect", "erct")]),
        &["`erct`", "one of erect, left_bending, right_bending, neutral, traction"],
    );
    refused(&format!("{HEADING}\nerect,A,1\n"), &["line 2", "3 cells"]);
    refused(&format!("{HEADING}\n"), &["missing"]);
}

fn slicer(points: &str) -> String {
    format!(
        r#"{{"markups":[{{"type":"Fiducial","name":"F","coordinateSystem":"LPS","controlPoints":[{points}]}}]}}"#
    )
}

fn point(label: &str, x: f64, y: f64, z: f64) -> String {
    format!(r#"{{"label":"{label}","position":[{x},{y},{z}]}}"#)
}

fn body(z: [f64; 4]) -> String {
    let corners = [("SL", 5.0, 1.0), ("SR", -5.0, 1.0), ("IL", 5.0, 8.0), ("IR", -5.0, 8.0)];
    let points =
        corners.into_iter().zip(z).map(|((c, x, y), z)| point(&format!("T5 {c}"), x, y, z));
    points.collect::<Vec<_>>().join(",")
}

#[test]
fn f26_points_outside_of_a_plane_are_refused() {
    let hint = LandmarkHint { image: Some(image()), ..hint() };
    parse_slicer(slicer(&body([0.0; 4])).as_bytes(), &hint).expect("a plane of a picture");
    let error = parse_slicer(slicer(&body([0.0, 0.0, 0.0, 3.0])).as_bytes(), &hint);
    assert!(matches!(error, Err(LandmarkError::Plane { .. })), "{error:?}");
}

#[test]
fn points_in_the_patient_without_the_place_of_the_picture_are_refused_with_this_reason() {
    let list = |left_mm: f64, cranial_mm: f64| {
        let corners = [("SL", 5.0, 8.0), ("SR", -5.0, 8.0), ("IL", 5.0, 1.0), ("IR", -5.0, 1.0)];
        let at = |(corner, x, z): (&str, f64, f64)| {
            point(&format!("T5 {corner}"), left_mm + x, 17.0, cranial_mm + z)
        };
        slicer(&corners.map(at).join(","))
    };
    let hint = LandmarkHint { image: Some(image()), ..hint() };
    // From the first pixel, the patient's left is to the right and the feet are below; a pixel counts as 1 mm.
    let file = parse_slicer(list(50.0, -109.0).as_bytes(), &hint).expect("on the picture");
    let LandmarkReadings::Corners(readings) = &file.films[0].landmarks else { panic!("corners") };
    let corner = readings[0].vertebrae[&Level::T5].corners.superior_left;
    assert_eq!(corner, Pixel::new(55.0, 101.0));
    // An origin in the middle of the patient.
    let error = parse_slicer(list(-50.0, 300.0).as_bytes(), &hint).expect_err("another origin");
    let text = error.to_string();
    assert!(
        text.contains("does not state where the picture lies") && text.contains("T5"),
        "{text}"
    );
    assert!(!text.contains("column") && error.help().contains("`spineline.Film`"), "{text}");
    // Without a picture the same list gives locations.
    let file = parse_slicer(list(-50.0, 300.0).as_bytes(), &LandmarkHint::default());
    let placed = file.expect("no picture").films.remove(0).landmarks;
    let LandmarkReadings::Placements(readings) = placed else { panic!("locations") };
    let location = readings[0].vertebrae[&Level::T5].location;
    assert!((location.y_mm + 50.0).abs() < 1e-12 && (location.z_mm - 304.5).abs() < 1e-12);
}

#[test]
fn f26_millimetres_without_a_spacing_are_refused() {
    let error = parse_slicer(slicer(&body([0.0; 4])).as_bytes(), &LandmarkHint::default());
    assert!(matches!(error, Err(LandmarkError::Needs { .. })), "{error:?}");
}

#[test]
fn unnamed_repeated_missing_and_unplaced_points_of_slicer_are_reported() {
    let hint = LandmarkHint { image: Some(image()), ..hint() };
    let refused = |points: &str, part: &str| {
        let text = parse_slicer(slicer(points).as_bytes(), &hint).expect_err(part).to_string();
        assert!(text.contains(part), "{text}");
    };
    refused(&point("F-1", 0.0, 0.0, 0.0), "F-1");
    refused(&format!("{},{}", body([0.0; 4]), point("Th5_superior_left", 1.0, 1.0, 0.0)), "twice");
    refused(&body([0.0; 4]).replacen("[5,1,0]", "[5,1]", 1), "three numbers");
    let unplaced = r#"{"label":"T6 SL","positionStatus":"undefined","position":[0,0,0]}"#;
    let text = slicer(&format!("{},{unplaced}", body([0.0; 4])));
    let file = parse_slicer(text.as_bytes(), &hint).expect("a list");
    assert_eq!((count_vertebrae(&file.films[0]), file.remarks.len()), (1, 1));
    let three = body([0.0; 4]).rsplit_once(",{").expect("four points").0.to_owned();
    refused(&three, "inferior_right");
    for system in ["\"XYZ\"", "0", "1", "null"] {
        let text = slicer(&body([0.0; 4])).replace("\"LPS\"", system);
        assert!(parse_slicer(text.as_bytes(), &hint).is_err(), "{system}");
    }
}

#[test]
fn a_description_by_this_program_that_cannot_be_used_is_refused_on_a_single_point_too() {
    let hint = LandmarkHint { image: Some(image()), ..hint() };
    let described = |text: &str| {
        let own = format!(r#"{{"description":{},"label":"T5 SL""#, serde_json::json!(text));
        slicer(&body([0.0; 4]).replacen(r#"{"label":"T5 SL""#, &own, 1))
    };
    let right = r#"{"spineline":1,"film":"erect","observer":"B","repeat":2,"frame":"image"}"#;
    for text in [right, "a note of the user", r#"{"note":1}"#, "[1]"] {
        parse_slicer(described(text).as_bytes(), &hint).expect(text);
    }
    for wrong in [
        r#"{"spineline":2}"#,
        &right.replace("\"image\"", "\"detector\""),
        &right.replace(":1,", ":99,"),
        &right.replace(":2,", ":0,"),
        &right.replace("film", "flim"),
        &right[..30],
    ] {
        let error = parse_slicer(described(wrong).as_bytes(), &hint).expect_err(wrong).to_string();
        assert!(error.contains("`T5 SL`, description") && error.contains("version 1"), "{error}");
    }
}

#[test]
fn an_unknown_key_of_film_and_reading_is_refused_and_not_replaced_by_a_default() {
    let ring = [[10.5, 5.5], [50.5, 7.5], [52.5, 30.5], [12.5, 29.5]];
    let text = labelme(&polygon(ring)).replacen('{', r#"{"spineline":{"observr":"B"},"#, 1);
    let error = parse_labelme(text.as_bytes(), &hint()).expect_err("a typo").to_string();
    assert!(error.contains("unknown key `observr`"), "{error}");
}

fn labelme(shapes: &str) -> String {
    format!(
        r#"{{"version":"5.0","imagePath":"a.png","imageWidth":1000,"imageHeight":2000,"shapes":[{shapes}]}}"#
    )
}

fn polygon(points: [[f64; 2]; 4]) -> String {
    format!(r#"{{"label":"T5","shape_type":"polygon","points":{points:?}}}"#)
}

#[test]
fn corners_of_a_labelme_quadrilateral_do_not_depend_on_start_and_sense() {
    let ring = [[10.5, 5.5], [50.5, 7.5], [52.5, 30.5], [12.5, 29.5]];
    let corners = |points| {
        let file = parse_labelme(labelme(&polygon(points)).as_bytes(), &hint()).expect("a body");
        let LandmarkReadings::Corners(readings) = &file.films[0].landmarks else {
            panic!("corners")
        };
        readings[0].vertebrae[&Level::T5].corners
    };
    let first = corners(ring);
    // The patient's left is the picture's right, and labelme counts from the pixel's corner.
    assert_eq!((first.superior_left.column_px, first.superior_left.row_px), (50.0, 7.0));
    assert_eq!((first.inferior_right.column_px, first.inferior_right.row_px), (12.0, 29.0));
    for start in 0..4 {
        let mut turned = ring;
        turned.rotate_left(start);
        assert_eq!(corners(turned), first);
        turned.reverse();
        assert_eq!(corners(turned), first);
    }
}

#[test]
fn a_labelme_quadrilateral_with_large_tilt_or_without_area_is_refused() {
    let diamond = [[30.0, 0.0], [60.0, 30.0], [30.0, 60.0], [0.0, 30.0]];
    let error = parse_labelme(labelme(&polygon(diamond)).as_bytes(), &hint());
    assert!(matches!(error, Err(LandmarkError::Ambiguous { .. })), "{error:?}");
    let upright = [[10.5, 5.5], [50.5, 7.5], [52.5, 30.5], [12.5, 29.5]];
    let unsaid = parse_labelme(labelme(&polygon(upright)).as_bytes(), &LandmarkHint::default());
    assert!(matches!(unsaid, Err(LandmarkError::Needs { .. })), "{unsaid:?}");
}

#[test]
fn a_labelme_quadrilateral_whose_sides_cross_is_refused_and_not_reordered() {
    let [a, b, c, d] = [[10.5, 5.5], [50.5, 7.5], [52.5, 30.5], [12.5, 29.5]];
    for crossed in [[a, b, d, c], [a, c, b, d]] {
        for start in 0..4 {
            let mut turned = crossed;
            turned.rotate_left(start);
            let error = parse_labelme(labelme(&polygon(turned)).as_bytes(), &hint());
            let text = error.expect_err("crossed").to_string();
            assert!(text.contains("shapes[0] `T5`") && text.contains("sides cross"), "{text}");
        }
    }
}

#[test]
fn the_picture_named_in_a_file_is_that_of_the_film() {
    let upright = [[10.5, 5.5], [50.5, 7.5], [52.5, 30.5], [12.5, 29.5]];
    let mut file = parse_labelme(labelme(&polygon(upright)).as_bytes(), &hint()).expect("a body");
    let other = ImageGeometry { rows: 999, ..image() };
    let error = file.films.remove(0).into_film(Some(Posture::Erect), Some(other));
    assert!(matches!(error, Err(LandmarkError::OtherPicture { .. })), "{error:?}");
}

fn coco(keypoints: &str, values: &str) -> String {
    format!(
        r#"{{"images":[{{"id":7,"file_name":"a.png","width":1000,"height":2000}}],"categories":[{{"id":3,"name":"T5","keypoints":[{keypoints}]}}],"annotations":[{{"id":1,"image_id":7,"category_id":3,"keypoints":[{values}]}}]}}"#
    )
}

#[test]
fn keypoints_of_coco_are_named_by_either_scheme() {
    let values = "50,7,2,10,5,2,52,30,2,12,29,1";
    let short = r#""superior_left","superior_right","inferior_left","inferior_right""#;
    let long = short.replace("\"s", "\"T5_s").replace("\"i", "\"T5_i");
    let one = parse_coco(coco(short, values).as_bytes(), &hint()).expect("a film");
    let other = parse_coco(coco(&long, values).as_bytes(), &hint()).expect("a film");
    assert_eq!(one.films, other.films);
    assert_eq!(one.films[0].size, Some((1000, 2000)));
    for (names, values, part) in [
        (short, "50,7,2,10,5,2", "6 numbers"),
        (short, "50,7,3,10,5,2,52,30,2,12,29,1", "visibility"),
        (short, "50,7,0,10,5,2,52,30,2,12,29,1", "superior_left"),
        (r#""upper_left","b","c","d""#, values, "the vertebra is missing in the name"),
    ] {
        let text = parse_coco(coco(names, values).as_bytes(), &hint()).expect_err(part).to_string();
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn files_without_landmarks_are_reported() {
    for (text, part) in [
        (r#"{"format":"spineline-case"}"#, "it is a Spineline file"),
        (r#"{"a":1}"#, "has no `markups`"),
        ("{", "line 1"),
        ("0.1,0.2\n", "it is not DICOM"),
        ("", "the file is empty"),
    ] {
        let error = parse_landmarks(text.as_bytes(), &hint()).expect_err(text).to_string();
        assert!(error.contains(part), "{error}");
    }
    let deep = "[".repeat(100_000);
    assert!(parse_landmarks(format!("{{\"markups\":{deep}").as_bytes(), &hint()).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    /// No input causes a panic.
    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..400), kind in 0..5usize) {
        let begin: &[u8] = [&b""[..], b"vertebra,", b"{\"markups\":[", b"MATLAB 5.0 MAT-file", b"{\"shapes\":["][kind];
        let _ = parse_landmarks(&[begin, &bytes].concat(), &hint());
    }

    /// Nor do changes of a sound table.
    #[test]
    fn a_damaged_table_is_read_or_refused(place in 0..2000usize, byte in any::<u8>()) {
        let mut bytes = table(&whole()).into_bytes();
        let place = place % bytes.len();
        bytes[place] = byte;
        if let Ok(file) = parse_csv(&bytes, &hint()) {
            prop_assert!(file.films.iter().map(count_vertebrae).sum::<usize>() >= 14);
        }
    }
}
