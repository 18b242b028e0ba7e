//! Origins of corners survive an export to every format and back.

use std::collections::BTreeMap;

use spineline::analysis::Case;
use spineline::anatomy::{ImageSide, Level};
use spineline::measure::{Corners, Film, Origin, VertebraLandmarks};
use spineline::spatial::Pixel;
use spineline_landmarks::{
    LandmarkError, LandmarkHint, LandmarkTarget, export_landmarks, parse_landmarks,
};

use crate::exchange::{case, image, read_back, source, without_axes};

/// A case with every origin: T8 of every reading is completed from its walls except for one moved corner, T9 is
/// detected and T10 accepted.
fn proposed() -> Case {
    let mut case = without_axes(case(ImageSide::Right));
    for film in &mut case.films {
        for reading in film.landmarks.corner_readings_mut() {
            let mut change = |level: Level, change: &dyn Fn(&mut VertebraLandmarks)| {
                change(reading.vertebrae.get_mut(&level).expect("all levels are marked"));
            };
            change(Level::T8, &|landmark| {
                let completed = Corners::all(Origin::Completed);
                landmark.origins = Corners { inferior_left: Origin::Adjusted, ..completed };
                let middle = |a: Pixel, b: Pixel| {
                    let (column, row) = (a.column_px + b.column_px, a.row_px + b.row_px);
                    Some(Pixel::new(0.5 * column, 0.5 * row))
                };
                let corners = landmark.corners;
                landmark.walls = [
                    middle(corners.superior_left, corners.inferior_left),
                    middle(corners.superior_right, corners.inferior_right),
                ];
            });
            change(Level::T9, &|landmark| {
                landmark.origins = Corners::all(Origin::Detected);
                landmark.sd_share = Some(0.07);
            });
            change(Level::T10, &|landmark| landmark.origins = Corners::all(Origin::Accepted));
        }
    }
    case
}

fn landmarks(film: &Film) -> Vec<VertebraLandmarks> {
    let readings = film.landmarks.corner_readings();
    assert!(!readings.is_empty(), "phantoms have corners");
    readings.iter().flat_map(|reading| reading.vertebrae.values().copied()).collect()
}

#[test]
fn every_format_keeps_origins() {
    let (case, none) = (proposed(), BTreeMap::new());
    let size = |film: &Film| (image(film).columns, image(film).rows);
    let of_film = |film: &Film| (film.posture, source(size(film), film.posture));
    let sources = case.films.iter().map(of_film).collect();
    let report =
        LandmarkTarget::DicomSr { sources: &sources, curves: &[], written: ["20260131", "235959"] };
    for target in [
        LandmarkTarget::Csv,
        LandmarkTarget::Slicer,
        LandmarkTarget::Labelme { pictures: &none },
        LandmarkTarget::Coco { pictures: &none },
        report,
    ] {
        let back = read_back(&case, target);
        assert_eq!(back.len(), case.films.len());
        for film in &back {
            let original = case.film(film.posture).expect("of the case");
            let [was, is] = [original, film].map(landmarks);
            assert!(was.iter().map(|one| one.origins).eq(is.iter().map(|one| one.origins)));
            if target == LandmarkTarget::Csv {
                assert_eq!(was, is, "a table keeps walls and deviations too");
            }
        }
    }
}

#[test]
fn a_case_without_proposals_has_no_columns_of_them() {
    let case = without_axes(case(ImageSide::Right));
    let files = export_landmarks(&case, None, LandmarkTarget::Csv).expect("a table");
    let text = String::from_utf8(files[0].bytes.clone()).expect("UTF-8");
    let heading = text.lines().next().expect("a heading");
    assert!(!heading.contains("origin") && !heading.contains("wall") && !heading.contains("sd"));
}

#[test]
fn what_says_how_uncertain_proposals_are_is_left_out_of_all_but_tables() {
    let (case, none) = (proposed(), BTreeMap::new());
    assert_eq!(LandmarkTarget::Csv.left_out(&case), [""; 0]);
    for target in [LandmarkTarget::Slicer, LandmarkTarget::Coco { pictures: &none }] {
        let left_out = target.left_out(&case);
        assert!(left_out.len() == 1 && left_out[0].contains("uncertainty"), "{left_out:?}");
    }
    let clicked = without_axes(self::case(ImageSide::Right));
    assert_eq!(LandmarkTarget::Slicer.left_out(&clicked), [""; 0]);
}

#[test]
fn an_unknown_origin_is_reported_with_all_names_in_every_format() {
    let (case, none) = (proposed(), BTreeMap::new());
    for target in [
        LandmarkTarget::Csv,
        LandmarkTarget::Slicer,
        LandmarkTarget::Labelme { pictures: &none },
        LandmarkTarget::Coco { pictures: &none },
    ] {
        let files = export_landmarks(&case, None, target).expect("files");
        let text = String::from_utf8(files[0].bytes.clone()).expect("UTF-8");
        let text = text.replacen("accepted", "acepted", 1);
        let error = parse_landmarks(text.as_bytes(), &LandmarkHint::default()).expect_err("a typo");
        let LandmarkError::Choice { what: "origin", name, known, .. } = error.cause() else {
            panic!("{target:?}: {error}")
        };
        assert_eq!(name, "acepted");
        assert_eq!(known[..], ["clicked", "completed", "detected", "accepted", "adjusted"]);
    }
}

#[test]
fn an_origin_that_is_not_a_text_is_refused_and_does_not_count_as_clicked() {
    let (case, none) = (proposed(), BTreeMap::new());
    let files = export_landmarks(&case, None, LandmarkTarget::Coco { pictures: &none });
    let text = String::from_utf8(files.expect("a dataset").remove(0).bytes).expect("UTF-8");
    let text = text.replacen("\"completed\"", "1", 1);
    let error = parse_landmarks(text.as_bytes(), &LandmarkHint::default()).expect_err("a number");
    assert!(matches!(error, LandmarkError::Choice { what: "origin", .. }), "{error}");
}
