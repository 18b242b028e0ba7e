//! Every export is read back and compared; left stays left on either side of the picture, also with pixels that are not
//! square.

use std::collections::BTreeMap;

use spineline::analysis::Case;
use spineline::anatomy::{ImageSide, Level, Posture, Region};
use spineline::clinical::CobbEnds;
use spineline::measure::{
    Corners, Film, FilmLandmarks, IliacCrests, ImageGeometry, Placement, Reading, ReadingId,
    Spacing, SpacingPlane,
};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline_landmarks::{
    LandmarkExportError, LandmarkFile, LandmarkFormat, LandmarkHint, LandmarkReadings,
    LandmarkTarget, SlicerFrame, SourceImage, export_landmarks, parse_landmarks,
};
use spineline_phantom::{Readers, Scenario, generate};

/// A phantom whose films hang as stated, with pixels twice as high as wide.
pub fn case(patient_left: ImageSide) -> Case {
    let mut case =
        generate(2, Scenario::Rod, &Readers::default(), 5).expect("subject 3 exists").case;
    for film in &mut case.films {
        let FilmLandmarks::Corners { image, readings, iliac_crests } = &mut film.landmarks else {
            continue;
        };
        let own = *image;
        let (column_mm, row_mm) = own.spacing.map_or((1.0, 1.0), |s| (s.column_mm, s.row_mm));
        let wanted = ImageGeometry {
            rows: own.rows,
            spacing: Some(Spacing::stated(column_mm, 2.0 * row_mm, SpacingPlane::Detector)),
            patient_left,
            ..own
        };
        let mirrored = own.patient_left != patient_left;
        let moved = |p: Pixel| {
            let last = f64::from(own.columns) - 1.0;
            let column_px = if mirrored { last - p.column_px } else { p.column_px };
            Pixel::new(column_px, 0.5 * p.row_px)
        };
        *image = wanted;
        for landmark in readings.iter_mut().flat_map(|reading| reading.vertebrae.values_mut()) {
            landmark.corners = landmark.corners.map(moved);
            if mirrored {
                landmark.axis_clockwise = landmark.axis_clockwise.map(|axis| -axis);
            }
        }
        if let Some(crests) = iliac_crests {
            crests.left = moved(crests.left);
            crests.right = moved(crests.right);
        }
    }
    case
}

pub fn image(film: &Film) -> ImageGeometry {
    match &film.landmarks {
        FilmLandmarks::Corners { image, .. } => *image,
        FilmLandmarks::Placements { .. } => panic!("phantoms have corners"),
    }
}

fn read(bytes: &[u8]) -> LandmarkFile {
    parse_landmarks(bytes, &LandmarkHint::default()).expect("our own file")
}

/// Largest distance between two films' corners and crests, in pixels; all other parts must be equal.
#[track_caller]
fn apart(one: &Film, other: &Film) -> f64 {
    assert_eq!(one.posture, other.posture);
    let (
        FilmLandmarks::Corners { image: a, iliac_crests: c, readings: r },
        FilmLandmarks::Corners { image: b, iliac_crests: d, readings: s },
    ) = (&one.landmarks, &other.landmarks)
    else {
        panic!("corners on both sides");
    };
    assert_eq!((a, r.len()), (b, s.len()));
    let mut pairs = Vec::new();
    match (c, d) {
        (Some(c), Some(d)) => pairs.extend([(c.left, d.left), (c.right, d.right)]),
        (c, d) => assert!(c.is_none() && d.is_none()),
    }
    for (r, s) in r.iter().zip(s) {
        assert_eq!(r.id, s.id);
        assert!(r.vertebrae.keys().eq(s.vertebrae.keys()));
        for (m, n) in r.vertebrae.values().zip(s.vertebrae.values()) {
            pairs.extend(m.corners.points().into_iter().zip(n.corners.points()));
        }
    }
    let off = |(p, q): (Pixel, spineline::spatial::Pixel)| {
        (p.column_px - q.column_px).hypot(p.row_px - q.row_px)
    };
    pairs.into_iter().map(off).fold(0.0, f64::max)
}

fn axes(film: &Film) -> Vec<Option<f64>> {
    let readings = film.landmarks.corner_readings();
    assert!(!readings.is_empty(), "phantoms have corners");
    let landmarks = readings.iter().flat_map(|reading| reading.vertebrae.values());
    landmarks.map(|landmark| landmark.axis_clockwise.map(Angle::deg)).collect()
}

#[track_caller]
fn same_axes(one: &Film, other: &Film) {
    for (a, b) in axes(one).into_iter().zip(axes(other)) {
        assert!(a.is_some() == b.is_some() && (a.unwrap_or(0.0) - b.unwrap_or(0.0)).abs() < 1e-9);
    }
}

const SIDES: [ImageSide; 2] = [ImageSide::Left, ImageSide::Right];

#[test]
fn a_table_round_trips() {
    for side in SIDES {
        let case = case(side);
        let files = export_landmarks(&case, None, LandmarkTarget::Csv).expect("a table");
        let file = read(&files[0].bytes);
        assert_eq!((file.format, file.films.len()), (LandmarkFormat::Csv, case.films.len()));
        for found in file.films {
            let film = found.posture.and_then(|of| case.film(of)).expect("a posture of the case");
            let back = found.into_film(None, Some(image(film))).expect("sound marks");
            assert_eq!(apart(film, &back), 0.0);
            same_axes(film, &back);
        }
    }
}

#[test]
fn point_lists_round_trip() {
    for side in SIDES {
        let case = case(side);
        let files = export_landmarks(&case, None, LandmarkTarget::Slicer).expect("lists");
        assert_eq!(files.len(), case.films.len());
        for bytes in files.iter().map(|file| &file.bytes) {
            let mut file = read(bytes);
            assert_eq!((file.format, file.films.len()), (LandmarkFormat::Slicer, 1));
            let found = file.films.remove(0);
            let film = found.posture.and_then(|of| case.film(of)).expect("a posture of the case");
            let back = found.into_film(None, Some(image(film))).expect("sound marks");
            assert!(apart(film, &back) < 1e-9);
        }
    }
}

#[test]
fn lists_in_ras_and_lps_give_the_same_film() {
    let case = case(ImageSide::Right);
    let files =
        export_landmarks(&case, Some(Posture::Erect), LandmarkTarget::Slicer).expect("lists");
    let mut json: serde_json::Value = serde_json::from_slice(&files[0].bytes).expect("JSON");
    let lps = read(&files[0].bytes);
    for markup in json["markups"].as_array_mut().expect("lists") {
        markup["coordinateSystem"] = "RAS".into();
        for point in markup["controlPoints"].as_array_mut().expect("points") {
            for axis in 0..2 {
                let value = -point["position"][axis].as_f64().expect("a number");
                point["position"][axis] = value.into();
            }
        }
    }
    assert_eq!(read(json.to_string().as_bytes()).films, lps.films);
    // Without stated coordinates the same file could be mirrored.
    json["markups"][0].as_object_mut().expect("a list").remove("coordinateSystem");
    let error = parse_landmarks(json.to_string().as_bytes(), &LandmarkHint::default());
    let text = error.expect_err("no coordinates named").to_string();
    assert!(text.contains("coordinateSystem") && text.contains("erect"), "{text}");
}

#[test]
fn a_list_in_the_patients_frame_is_converted_to_pixels() {
    for side in SIDES {
        let case = case(side);
        let film = &case.films[0];
        let (image, readings) = (image(film), film.landmarks.corner_readings());
        let names = ["superior_left", "superior_right", "inferior_left", "inferior_right"];
        let mut points = Vec::new();
        for (level, landmark) in &readings[0].vertebrae {
            for (name, corner) in names.into_iter().zip(landmark.corners.points()) {
                let at = image.frontal(corner);
                points.push(serde_json::json!({
                    "label": format!("{level}_{name}"), "position": [at.y_mm, 17.0, at.z_mm],
                }));
            }
        }
        let list = serde_json::json!({ "@schema": "markups-schema-v1.0.3.json#", "markups": [
            { "type": "Fiducial", "coordinateSystem": "LPS", "controlPoints": points },
        ]});
        let hint = LandmarkHint {
            image: Some(image),
            posture: Some(film.posture),
            reading: readings[0].id.clone(),
            ..LandmarkHint::default()
        };
        let mut found = parse_landmarks(list.to_string().as_bytes(), &hint).expect("a list");
        let LandmarkReadings::Corners(back) = &found.films[0].landmarks else { panic!("corners") };
        for (landmark, again) in readings[0].vertebrae.values().zip(back[0].vertebrae.values()) {
            for (p, q) in landmark.corners.points().into_iter().zip(again.corners.points()) {
                assert!(
                    (p.column_px - q.column_px).abs() < 1e-9 && (p.row_px - q.row_px).abs() < 1e-9
                );
            }
        }
        found.films.remove(0).into_film(None, Some(image)).expect("left stays left");
        // Without a picture the same list gives locations.
        let hint = LandmarkHint { image: None, ..hint };
        let placed = parse_landmarks(list.to_string().as_bytes(), &hint).expect("a list");
        assert!(matches!(placed.films[0].landmarks, LandmarkReadings::Placements(_)));
        let hint = LandmarkHint { slicer_frame: Some(SlicerFrame::Image), ..hint };
        let error = parse_landmarks(list.to_string().as_bytes(), &hint).expect_err("another plane");
        assert!(error.to_string().contains("Patient"), "{error}");
    }
}

pub fn source(size: (u32, u32), posture: Posture) -> SourceImage {
    SourceImage {
        sop_class_uid: "1.2.840.10008.5.1.4.1.1.1.1".to_owned(),
        sop_instance_uid: format!("2.25.{}", 100 + posture as u32),
        study_instance_uid: "2.25.7".to_owned(),
        series_instance_uid: "2.25.8".to_owned(),
        modality: "DX".to_owned(),
        size,
        patient_id: "P-1".to_owned(),
        ..SourceImage::default()
    }
}

#[test]
fn reports_round_trip_to_single_precision() {
    // Half a unit in the last place of a number below 4096.
    const TOLERANCE_PX: f64 = 2.0 * 1.3e-4;
    let curves = [(Region::MainThoracic, CobbEnds { inferior: Level::L1, superior: Level::T6 })];
    for side in SIDES {
        let case = case(side);
        let sources: BTreeMap<_, _> = case
            .films
            .iter()
            .map(|film| {
                let image = image(film);
                (film.posture, source((image.columns, image.rows), film.posture))
            })
            .collect();
        let target = LandmarkTarget::DicomSr {
            sources: &sources,
            curves: &curves,
            written: ["20260131", "101500"],
        };
        let files = export_landmarks(&case, None, target).expect("reports");
        assert_eq!(files, export_landmarks(&case, None, target).expect("the same bytes"));
        let mut films: BTreeMap<Posture, Vec<_>> = BTreeMap::new();
        for file in &files {
            let mut read = read(&file.bytes);
            assert_eq!(read.format, LandmarkFormat::DicomSr);
            let found = read.films.remove(0);
            let LandmarkReadings::Corners(readings) = found.landmarks else { panic!("corners") };
            let posture = found.posture.expect("a posture");
            films.entry(posture).or_default().push((found.iliac_crests, readings));
        }
        for film in &case.films {
            let reports = films.remove(&film.posture).expect("reports of every film");
            let iliac_crests = reports[0].0;
            let readings = reports.into_iter().flat_map(|(_, readings)| readings).collect();
            let landmarks = FilmLandmarks::Corners { image: image(film), iliac_crests, readings };
            let back = Film::new(film.posture, landmarks);
            assert!(apart(film, &back) < TOLERANCE_PX, "{}", apart(film, &back));
            same_axes(film, &back);
        }
    }
}

#[test]
fn a_report_needs_its_radiograph() {
    let mut case = case(ImageSide::Right);
    let mut sources = BTreeMap::new();
    let refused = |case: &Case, sources: &BTreeMap<_, _>| {
        let target =
            LandmarkTarget::DicomSr { sources, curves: &[], written: ["20260131", "101500"] };
        export_landmarks(case, Some(Posture::Erect), target)
            .expect_err("the radiograph is missing, or the crests are not on it")
    };
    assert!(matches!(refused(&case, &sources), LandmarkExportError::Source(_)));
    sources.insert(Posture::Erect, source((10, 10), Posture::Erect));
    assert!(refused(&case, &sources).to_string().contains("10 × 10"));
    let size = image(case.film(Posture::Erect).expect("of the case"));
    sources.insert(Posture::Erect, source((size.columns, size.rows), Posture::Erect));
    for film in &mut case.films {
        let FilmLandmarks::Corners { iliac_crests, .. } = &mut film.landmarks else { panic!() };
        let (left, right) = (Pixel::new(-5.0, 9.0), Pixel::new(5.0, 9.0));
        *iliac_crests = Some(IliacCrests { left, right });
    }
    let error = refused(&case, &sources);
    assert_eq!(error, LandmarkExportError::Crests(Posture::Erect));
    assert!(error.help().contains("crests") && !error.help().contains("DICOM"), "{error}");
}

#[test]
fn locations_of_another_program_are_read_from_a_table() {
    let placement = |i: usize| {
        let location = Frontal::new(0.1 * i as f64, -31.25 * i as f64);
        Placement::new(location, Angle::from_deg(3.0 - i as f64))
    };
    let vertebrae = Level::MODEL.into_iter().enumerate().map(|(i, level)| (level, placement(i)));
    let readings = vec![Reading { id: ReadingId::new("-B", 2), vertebrae: vertebrae.collect() }];
    let mut case = case(ImageSide::Right);
    let placed = FilmLandmarks::placed(SpacingPlane::Unknown, readings);
    case.films = vec![Film::new(Posture::Erect, placed)];
    let files = export_landmarks(&case, None, LandmarkTarget::Csv).expect("a table");
    let text = std::str::from_utf8(&files[0].bytes).expect("UTF-8");
    // Spreadsheets must not run a cell as a formula.
    for cell in text.lines().skip(1).flat_map(|line| line.split(',')) {
        let formula = cell.starts_with(['=', '+', '-', '@']);
        assert!(!formula || cell.parse::<f64>().is_ok(), "{cell}");
    }
    let LandmarkReadings::Placements(back) = &read(&files[0].bytes).films[0].landmarks else {
        panic!("locations");
    };
    let FilmLandmarks::Placements { readings, .. } = &case.films[0].landmarks else {
        panic!("locations")
    };
    assert_eq!(back[0].id, readings[0].id);
    for (p, q) in back[0].vertebrae.values().zip(readings[0].vertebrae.values()) {
        assert_eq!(p.location, q.location);
        assert!((p.tilt - q.tilt).abs().deg() < 1e-13);
    }
    let error = export_landmarks(&case, None, LandmarkTarget::Slicer).expect_err("no corners");
    assert_eq!(error, LandmarkExportError::NoCorners(Posture::Erect));
}

/// The corners of an annotated film, without what labelme and COCO cannot hold: axes set by hand.
pub fn without_axes(mut case: Case) -> Case {
    for film in &mut case.films {
        let readings = film.landmarks.corner_readings_mut();
        assert!(!readings.is_empty(), "phantoms have corners");
        for landmark in readings.iter_mut().flat_map(|reading| reading.vertebrae.values_mut()) {
            landmark.axis_clockwise = None;
        }
    }
    case
}

/// The case with a different confidence for every corner, as from a network.
fn with_confidences(case: Case) -> Case {
    let mut case = without_axes(case);
    let mut count = 0.0;
    for film in &mut case.films {
        let readings = film.landmarks.corner_readings_mut();
        assert!(!readings.is_empty(), "phantoms have corners");
        for landmark in readings.iter_mut().flat_map(|reading| reading.vertebrae.values_mut()) {
            count += 1.0;
            let value = |corner: f64| 1.0 / (1.0 + 0.001 * (4.0 * count + corner));
            landmark.confidence = Some(Corners {
                superior_left: value(0.0),
                superior_right: value(1.0),
                inferior_left: value(2.0),
                inferior_right: value(3.0),
            });
        }
    }
    case
}

/// The films of an export when it is read back; readings of one film may be in several files.
pub fn read_back(case: &Case, target: LandmarkTarget<'_>) -> Vec<Film> {
    let mut films: BTreeMap<Posture, Film> = BTreeMap::new();
    for file in export_landmarks(case, None, target).expect("corners") {
        for found in read(&file.bytes).films {
            let posture = found.posture.expect("our own files name the film");
            let film = case.film(posture).expect("of the case");
            let found = found.into_film(None, Some(image(film))).expect("sound marks");
            match films.get_mut(&posture).map(|film| &mut film.landmarks) {
                None => drop(films.insert(posture, found)),
                Some(FilmLandmarks::Corners { readings, .. }) => {
                    let FilmLandmarks::Corners { readings: more, .. } = found.landmarks else {
                        panic!("corners")
                    };
                    readings.extend(more);
                }
                Some(FilmLandmarks::Placements { .. }) => panic!("corners"),
            }
        }
    }
    films.into_values().collect()
}

fn confidences(film: &Film) -> Vec<Option<Corners<f64>>> {
    let readings = film.landmarks.corner_readings();
    assert!(!readings.is_empty(), "phantoms have corners");
    let landmarks = readings.iter().flat_map(|reading| reading.vertebrae.values());
    landmarks.map(|landmark| landmark.confidence).collect()
}

#[test]
fn annotations_and_keypoints_round_trip_with_confidences() {
    let pictures = BTreeMap::from([(Posture::Erect, "standing.jpg".to_owned())]);
    for side in SIDES {
        for case in [without_axes(case(side)), with_confidences(case(side))] {
            for target in [
                LandmarkTarget::Labelme { pictures: &pictures },
                LandmarkTarget::Coco { pictures: &pictures },
                LandmarkTarget::Csv,
            ] {
                let back = read_back(&case, target);
                assert_eq!(back.len(), case.films.len());
                for film in &back {
                    let original = case.film(film.posture).expect("of the case");
                    assert!(apart(original, film) < 1e-9);
                    assert_eq!(confidences(original), confidences(film));
                }
            }
        }
    }
}

#[test]
fn what_a_format_leaves_out_is_named() {
    let none = BTreeMap::new();
    let axes = case(ImageSide::Right);
    let sure = with_confidences(axes.clone());
    let slicer = LandmarkTarget::Slicer;
    let coco = LandmarkTarget::Coco { pictures: &none };
    assert_eq!(LandmarkTarget::Csv.left_out(&sure), [""; 0]);
    assert_eq!(slicer.left_out(&sure), ["confidences"]);
    assert_eq!(coco.left_out(&sure), [""; 0]);
    assert_eq!(slicer.left_out(&axes), ["axes that were set by hand"]);
    assert_eq!(coco.left_out(&axes), ["axes that were set by hand"]);
}

#[test]
fn annotations_name_their_picture_and_have_what_their_programs_need() {
    let case = without_axes(case(ImageSide::Right));
    let pictures = BTreeMap::from([(Posture::Erect, "standing.jpg".to_owned())]);
    let json = |target| -> Vec<serde_json::Value> {
        let files = export_landmarks(&case, Some(Posture::Erect), target).expect("files");
        files.iter().map(|f| serde_json::from_slice(&f.bytes).expect("JSON")).collect()
    };
    let labelme = json(LandmarkTarget::Labelme { pictures: &pictures });
    let image = image(&case.films[0]);
    for file in &labelme {
        assert_eq!(file["imagePath"], "standing.jpg");
        assert_eq!(file["imageWidth"], image.columns);
        assert!(file["imageData"].is_null() && file["version"].is_string());
        assert_eq!(file["shapes"][0]["label"], "T2_superior_left");
    }
    let none = BTreeMap::new();
    let coco = &json(LandmarkTarget::Coco { pictures: &none })[0];
    assert_eq!(coco["images"][0]["file_name"], "erect.png");
    for annotation in coco["annotations"].as_array().expect("a list") {
        let numbers = annotation["keypoints"].as_array().expect("a list").len() as u64;
        assert_eq!(annotation["num_keypoints"], numbers / 3);
        assert!(annotation["bbox"][2].as_f64() > Some(0.0), "{annotation}");
    }
}

#[test]
fn a_keypoint_dataset_of_a_network_keeps_its_scores() {
    let keypoints = "[100,100,2,50,100,2,100,130,2,50,130,2]";
    let with = |scores: &str| {
        let text = format!(
            r#"{{"images":[{{"id":1,"width":200,"height":400}}],"categories":[{{"id":5,"name":"T5","keypoints":["superior_left","superior_right","inferior_left","inferior_right"]}}],"annotations":[{{"id":1,"image_id":1,"category_id":5,"keypoints":{keypoints}{scores}}}]}}"#
        );
        parse_landmarks(text.as_bytes(), &LandmarkHint::default()).map(|mut file| {
            let LandmarkReadings::Corners(readings) = file.films.remove(0).landmarks else {
                panic!("corners")
            };
            readings[0].vertebrae[&Level::T5].confidence.map(|corners| corners.points())
        })
    };
    assert_eq!(with("").expect("a dataset"), None);
    assert_eq!(with(r#","score":0.25"#).expect("a dataset"), Some([0.25; 4]));
    let each = with(r#","score":0.25,"keypoint_scores":[0.9,0.8,0.7,0.6]"#).expect("a dataset");
    assert_eq!(each, Some([0.9, 0.8, 0.7, 0.6]));
    for (scores, part) in [
        (r#","keypoint_scores":[0.9,0.8]"#, "2 keypoint_scores"),
        (r#","score":87"#, "confidence from 0 to 1"),
        (r#","score":-0.1"#, "confidence from 0 to 1"),
    ] {
        let error = with(scores).expect_err("no confidence").to_string();
        assert!(error.contains(part), "{error}");
    }
    let list =
        parse_landmarks(br#"[{"image_id":1,"keypoints":[1,2,0.9]}]"#, &LandmarkHint::default());
    let error = list.expect_err("results alone").to_string();
    assert!(error.contains("COCO results"), "{error}");
}
