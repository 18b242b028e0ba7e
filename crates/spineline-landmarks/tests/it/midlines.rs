//! Midlines of the back surface: the same line in any axes gives the same levels, and other files are refused.

use serde_json::{Value, json};
use spineline::anatomy::{Level, Posture};
use spineline::measure::{FilmLandmarks, Placement, PlacementSource, SpacingPlane};
use spineline_landmarks::{
    LandmarkError, LandmarkExportError, LandmarkFormat, LandmarkHint, LandmarkTarget,
    export_landmarks, parse_landmarks,
};
use spineline_phantom::{Readers, Scenario, generate};

/// A line of 440 mm or so with one bend to the patient's left and some depth: left, cranial, anterior.
fn points() -> Vec<[f64; 3]> {
    (0..=86)
        .map(|i| {
            let down = f64::from(i) * 5.0;
            let along = down / 430.0 * std::f64::consts::PI;
            [30.0 * along.sin(), 1000.0 - down, 20.0 * (2.0 * along).sin()]
        })
        .collect()
}

fn file(axes: Value, points: impl Iterator<Item = Vec<f64>>) -> Value {
    json!({ "midlines": [{
        "posture": "left_bending", "observer": "scan", "repeat": 2, "cranial_end": "C7", "caudal_end": "S1",
        "axes": axes, "points_mm": points.collect::<Vec<_>>(),
    }]})
}

fn plain() -> Value {
    file(json!(["left", "cranial", "anterior"]), points().into_iter().map(Vec::from))
}

fn levels(file: &Value) -> Vec<(Level, Placement)> {
    let mut found =
        parse_landmarks(file.to_string().as_bytes(), &LandmarkHint::default()).expect("a midline");
    assert_eq!(found.format, LandmarkFormat::SurfaceMidlines);
    assert!(found.remarks[0].contains("no vertebra was seen"));
    let film = found.films.remove(0).into_film(None, None).expect("a film without a picture");
    assert_eq!(film.posture, Posture::LeftBending);
    let FilmLandmarks::Placements { source, spacing_plane, readings, .. } = film.landmarks else {
        panic!("locations")
    };
    assert_eq!(source, PlacementSource::SurfaceMidline);
    assert_eq!(spacing_plane, SpacingPlane::Patient);
    assert_eq!(readings[0].id.to_string(), "scan (repeat 2)");
    readings[0].vertebrae.iter().map(|(&level, &placed)| (level, placed)).collect()
}

#[test]
fn axes_of_any_scanner_give_the_same_levels() {
    let expected = levels(&plain());
    assert_eq!(expected.len(), 17);
    // The bend is to the left, so the cranial part tilts to the right, and the lumbar part to the left.
    let tilt = |wanted| expected.iter().find(|(level, _)| *level == wanted).expect("placed").1.tilt;
    assert!(tilt(Level::T2).deg() > 5.0 && tilt(Level::L4).deg() < -5.0);
    // Axes of the scanner of the PCdare set: x to the patient's right, y down, z away from the camera.
    let turned = points().into_iter().map(|[y, z, x]| vec![-y, -z, x]);
    assert_eq!(levels(&file(json!(["right", "caudal", "anterior"]), turned)), expected);
    let turned = points().into_iter().map(|[y, z, x]| vec![-x, z, y]);
    assert_eq!(levels(&file(json!(["posterior", "cranial", "left"]), turned)), expected);
    // A mirrored line gives mirrored levels.
    let mirrored = points().into_iter().map(|[y, z, x]| vec![-y, z, x]);
    let mirrored = levels(&file(json!(["left", "cranial", "anterior"]), mirrored));
    for ((_, one), (_, other)) in expected.iter().zip(mirrored) {
        assert_eq!(one.location.y_mm, -other.location.y_mm);
        assert!((one.tilt + other.tilt).abs().deg() < 1e-12);
    }
}

#[test]
fn files_that_are_no_midlines_are_refused_with_their_place() {
    let refused = |change: &dyn Fn(&mut Value), parts: &[&str]| {
        let mut file = plain();
        change(&mut file["midlines"][0]);
        let error = parse_landmarks(file.to_string().as_bytes(), &LandmarkHint::default())
            .expect_err("bad");
        let text = error.to_string();
        for part in parts {
            assert!(text.contains(part), "`{text}` does not say {part}");
        }
        assert!(!error.help().is_empty());
        error
    };
    let metres = |line: &mut Value| {
        let points = points().into_iter().map(|p| p.map(|value| value * 0.001).to_vec());
        line["points_mm"] = json!(points.collect::<Vec<_>>());
    };
    let error = refused(&metres, &["midlines[0]", "0.4 mm long"]);
    assert!(matches!(error, LandmarkError::Midline { .. }));
    refused(
        &|line| line["axes"] = json!(["left", "right", "cranial"]),
        &["axes", "left and right"],
    );
    refused(
        &|line| line["axes"] = json!(["left", "cranal"]),
        &["`cranal`", "one of left, right, cranial"],
    );
    refused(&|line| line["axes"] = json!(["left", "cranial"]), &["points_mm[0]", "3 numbers"]);
    refused(&|line| line["axes"] = json!(["left", "caudal", "anterior"]), &["lower than the last"]);
    refused(&|line| line["cranial_end"] = json!("C6"), &["`C6`", "C7"]);
    refused(&|line| line["posture"] = json!("standing"), &["posture `standing`"]);
    refused(&|line| line["repeat"] = json!(0), &["repeat"]);
    refused(&|line| line["lines"] = json!(1), &["unknown key"]);
    refused(&|line| line["points_mm"] = json!([]), &["two points"]);
    let twice = json!({ "midlines": [plain()["midlines"][0], plain()["midlines"][0]] });
    let error = parse_landmarks(twice.to_string().as_bytes(), &LandmarkHint::default());
    assert!(error.expect_err("twice").to_string().contains("midlines[1]"));
}

#[test]
fn estimated_levels_are_not_exported_as_seen_ones() {
    let mut found = parse_landmarks(plain().to_string().as_bytes(), &LandmarkHint::default())
        .expect("a midline");
    let film = found.films.remove(0).into_film(None, None).expect("a film");
    let mut case = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1").case;
    case.films = vec![film];
    let error = export_landmarks(&case, None, LandmarkTarget::Csv).expect_err("estimated");
    assert_eq!(error, LandmarkExportError::Estimated(Posture::LeftBending));
}
