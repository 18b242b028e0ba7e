//! Films marked wrongly: each fault ends with an error that names film, vertebra and value, and says what to do.

use std::mem::swap;
use std::ops::RangeInclusive;

use crate::common::{
    case_of, exact_case, film_mut, graph_film, landmarks, landmarks_mut, move_places, refused,
    spacing,
};
use spineline::analysis::Case;
use spineline::anatomy::{Level, Posture};
use spineline::error::Error;
use spineline::measure::{CornerFault, Corners, FilmLandmarks, MeasureError, MeasureFault};
use spineline::spatial::{Angle, Pixel};
use spineline::warning::Step;

/// The error of a case in step 1; its words must name what the user has to look at.
#[track_caller]
fn refused_in_measure(case: &Case, named: &[&str]) -> MeasureError {
    let error = refused(case);
    assert_eq!(error.step(), Step::Measure);
    let text = error.to_string();
    for part in named {
        assert!(text.contains(part), "`{text}` does not name {part}");
    }
    match error {
        Error::Measure(error) => error,
        other => panic!("not an error of step 1: {other:?}"),
    }
}

#[track_caller]
fn refused_corners(case: &Case, level: Level, expected: CornerFault) {
    let named = ["left bending", "A (repeat 1)", level.name()];
    let error = refused_in_measure(case, &named);
    assert_eq!((error.at.film, error.at.level), (Posture::LeftBending.into(), Some(level)));
    assert_eq!(error.fault, MeasureFault::Corners { fault: expected });
}

/// A sound case with the corners of one vertebra of the left bend changed.
fn with_corners(level: Level, change: impl FnOnce(&mut Corners<Pixel>)) -> Case {
    let mut case = exact_case(0);
    change(&mut landmarks_mut(&mut case, Posture::LeftBending, level).corners);
    case
}

#[test]
fn swapped_neighbouring_corners_are_reported_as_crossed() {
    // Oracle: the diagonals of a bow tie do not meet.
    for level in [Level::L4, Level::T8, Level::T2] {
        let case = with_corners(level, |c| swap(&mut c.superior_left, &mut c.superior_right));
        refused_corners(&case, level, CornerFault::Crossed);
    }
}

#[test]
fn swapped_sides_of_one_vertebra_are_reported_by_name() {
    // Oracle: the patient's left cannot change from one vertebra to the next.
    for level in [Level::L4, Level::T8, Level::T2] {
        let case = with_corners(level, |c| {
            swap(&mut c.superior_left, &mut c.superior_right);
            swap(&mut c.inferior_left, &mut c.inferior_right);
        });
        refused_corners(&case, level, CornerFault::SidesExchanged);
    }
}

#[test]
fn a_vertebra_upside_down_is_named() {
    // Oracle: the next vertebra lies on the cranial side.
    for level in [Level::L4, Level::T8, Level::T2] {
        let case = with_corners(level, |c| {
            swap(&mut c.superior_left, &mut c.inferior_left);
            swap(&mut c.superior_right, &mut c.inferior_right);
        });
        refused_corners(&case, level, CornerFault::UpsideDown);
    }
}

#[test]
fn a_vertebra_rotated_by_180_degrees_is_upside_down() {
    // Oracle: superior and inferior are exchanged, whatever the sides say.
    let case = with_corners(Level::T8, |c| {
        swap(&mut c.superior_left, &mut c.inferior_right);
        swap(&mut c.superior_right, &mut c.inferior_left);
    });
    refused_corners(&case, Level::T8, CornerFault::UpsideDown);
}

#[test]
fn coincident_or_collinear_corners_are_refused() {
    // Oracle: a body has an area.
    let point = with_corners(Level::T8, |c| *c = c.map(|_| Pixel::new(900.0, 900.0)));
    refused_corners(&point, Level::T8, CornerFault::Flat);
    let line = with_corners(Level::T8, |c| *c = c.map(|p| Pixel::new(p.column_px, 900.0)));
    refused_corners(&line, Level::T8, CornerFault::Flat);
    let doubled = with_corners(Level::T8, |c| c.superior_left = c.superior_right);
    refused_corners(&doubled, Level::T8, CornerFault::Flat);
    let doubled = with_corners(Level::T8, |c| c.inferior_left = c.superior_left);
    refused_corners(&doubled, Level::T8, CornerFault::Flat);
}

#[test]
fn a_coordinate_that_is_not_finite_is_refused() {
    // Oracle: nothing can be measured from NaN or infinity.
    for value in [f64::NAN, f64::INFINITY] {
        let case = with_corners(Level::T5, |c| c.inferior_right.row_px = value);
        let error = refused_in_measure(&case, &["left bending", "T5", "A (repeat 1)"]);
        assert!(
            error.fault == MeasureFault::NotFinite && error.at.level == Some(Level::T5),
            "{error:?}"
        );
    }
    let mut case = exact_case(0);
    landmarks_mut(&mut case, Posture::Erect, Level::L1).axis_clockwise =
        Some(Angle::from_rad(f64::NAN));
    let error = refused_in_measure(&case, &["erect", "L1"]);
    assert!(
        error.fault == MeasureFault::NotFinite && error.at.level == Some(Level::L1),
        "{error:?}"
    );
}

#[test]
fn a_placement_that_is_not_finite_is_refused() {
    // Oracle: nothing can be measured from NaN.
    let film =
        graph_film(Posture::Erect, 390.0, |z| if z > 380.0 { (f64::NAN, 0.0) } else { (0.0, 0.0) });
    let error = refused_in_measure(&case_of(vec![film]), &["erect", "T2"]);
    assert!(
        error.fault == MeasureFault::NotFinite && error.at.level == Some(Level::T2),
        "{error:?}"
    );
}

/// A sound case without the vertebrae of a range on one film.
fn without(posture: Posture, missing: RangeInclusive<Level>) -> Case {
    let mut case = exact_case(0);
    let (_, _, readings) = landmarks(film_mut(&mut case, posture));
    readings[0].vertebrae.retain(|level, _| !missing.contains(level));
    case
}

#[test]
fn films_that_show_too_little_are_refused_with_advice_that_fits() {
    // Oracle: the documented limits; the only erect film cannot be left out.
    let cases = [
        (Level::T6..=Level::T1, "above T7"),
        (Level::L5..=Level::L2, "below L1"),
        (Level::T11..=Level::T8, "between T12 and T7"),
    ];
    for (missing, named) in cases {
        for posture in [Posture::Erect, Posture::Neutral] {
            let case = without(posture, missing.clone());
            let error = refused_in_measure(&case, &[&posture.to_string(), named]);
            assert_eq!(error.code(), "level_missing");
            let leave_out = error.help().contains("leave this film out");
            assert_eq!(leave_out, posture != Posture::Erect, "{error}: {}", error.help());
        }
    }
}

#[test]
fn bases_that_no_two_films_share_are_refused() {
    // Oracle: L4 and L3 on one film, L2 alone on the other: no vertebra that both could be fixed at.
    let mut case = without(Posture::Neutral, Level::L2..=Level::L2);
    let (_, _, readings) = landmarks(film_mut(&mut case, Posture::Traction));
    readings[0].vertebrae.retain(|level, _| *level >= Level::L2);
    let error = refused_in_measure(&case, &["no vertebra from L4 to L2 is marked on every film"]);
    assert!(matches!(error.fault, MeasureFault::NoCommonEnd { at_base: true }), "{error:?}");
}

#[test]
fn a_corner_off_the_picture_is_refused_with_its_place() {
    // Oracle: the picture ends half a pixel before its first and after its last pixel centre.
    let (columns, rows) = {
        let mut case = exact_case(0);
        let (image, _, _) = landmarks(film_mut(&mut case, Posture::LeftBending));
        (image.columns, image.rows)
    };
    let (last_column, last_row) = (f64::from(columns) - 1.0, f64::from(rows) - 1.0);
    for place in [
        Pixel::new(-0.6, 100.0),
        Pixel::new(100.0, -0.6),
        Pixel::new(last_column + 0.6, 100.0),
        Pixel::new(100.0, last_row + 0.6),
    ] {
        let case = with_corners(Level::T5, |c| c.superior_left = place);
        let named = [place.column_px.to_string(), place.row_px.to_string(), columns.to_string()];
        let named: Vec<&str> = named.iter().map(String::as_str).collect();
        let error = refused_in_measure(&case, &named);
        assert!(matches!(error.fault, MeasureFault::OffImage { .. }), "{error:?}");
        assert_eq!(error.at.level, Some(Level::T5));
    }
}

#[test]
fn a_spacing_that_is_not_positive_is_refused() {
    // Oracle: pixels have a distance; some real files say "0.000".
    for value in [0.0, -0.1, f64::NAN, f64::INFINITY, 1e-5, 5.1] {
        let mut case = exact_case(0);
        spacing(landmarks(film_mut(&mut case, Posture::Traction)).0).row_mm = value;
        let error = refused_in_measure(&case, &["traction", "row", &value.to_string()]);
        assert!(matches!(error.fault, MeasureFault::Spacing { direction: "row", .. }), "{error:?}");
        let mut case = exact_case(0);
        spacing(landmarks(film_mut(&mut case, Posture::Erect)).0).column_mm = value;
        let error = refused_in_measure(&case, &["erect", "column", &value.to_string()]);
        assert!(
            matches!(error.fault, MeasureFault::Spacing { direction: "column", .. }),
            "{error:?}"
        );
    }
}

#[test]
fn a_film_larger_than_any_film_is_refused_with_its_size() {
    // Oracle: the size of the film is its pixels times their distance; a decimal comma read as nothing is a factor of ten.
    let mut case = exact_case(0);
    let image = landmarks(film_mut(&mut case, Posture::Neutral)).0;
    let rows = f64::from(image.rows);
    spacing(image).row_mm = 2510.0 / rows;
    let error = refused_in_measure(&case, &["neutral", "2510 mm high", "2500 mm"]);
    assert!(matches!(error.fault, MeasureFault::FilmTooLarge { .. }), "{error:?}");
    let mut case = exact_case(0);
    let image = landmarks(film_mut(&mut case, Posture::Neutral)).0;
    image.spacing = None;
    assert_eq!(image.check_size(), Ok(()), "a film without a scale has no size");
}

#[test]
fn a_scale_ten_times_too_small_is_named_before_what_follows_from_it() {
    // Oracle: at a tenth of the scale the crests, sound ones, are closer than those of any pelvis.
    let mut case = exact_case(0);
    let (image, crests, _) = landmarks(film_mut(&mut case, Posture::Erect));
    let apart_px = crests.map(|crests| crests.left.column_px - crests.right.column_px);
    let scale = spacing(image);
    (scale.column_mm, scale.row_mm) = (0.1 * scale.column_mm, 0.1 * scale.row_mm);
    assert!((apart_px.expect("marked") * scale.column_mm).abs() < 50.0);
    let error = refused_in_measure(&case, &["erect", "mm"]);
    assert!(matches!(error.fault, MeasureFault::Length { .. }), "{error:?}");
}

#[test]
fn a_body_of_a_size_that_no_vertebra_has_is_refused() {
    // Oracle: corners moved apart by hand; the width is their distance.
    let mut case = exact_case(0);
    let (image, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    let column_mm = spacing(image).column_mm;
    let body = readings[0].vertebrae.get_mut(&Level::T9).expect("marked");
    let wide_px = 160.0 / column_mm;
    let middle =
        0.5 * (body.corners.superior_left.column_px + body.corners.superior_right.column_px);
    let left = (body.corners.superior_left.column_px - middle).signum();
    let by = left * 0.5 * wide_px;
    body.corners.superior_left.column_px = middle + by;
    body.corners.inferior_left.column_px = middle + by;
    body.corners.superior_right.column_px = middle - by;
    body.corners.inferior_right.column_px = middle - by;
    let columns = image.columns;
    image.columns = columns.max(4000);
    let error = refused_in_measure(&case, &["erect", "T9", "mm wide", "150 mm"]);
    assert!(
        matches!(error.fault, MeasureFault::BodySize { level: Level::T9, side: "wide", .. }),
        "{error:?}"
    );
}

#[test]
fn a_repeated_reading_is_refused() {
    // Oracle: a mean over readings counts every reading once.
    let mut case = exact_case(0);
    let (_, _, readings) = landmarks(film_mut(&mut case, Posture::RightBending));
    readings.push(readings[0].clone());
    let error = refused_in_measure(&case, &["right bending", "A (repeat 1)"]);
    assert!(matches!(error.fault, MeasureFault::DuplicateReading { .. }), "{error:?}");
}

#[test]
fn a_film_without_a_reading_is_refused() {
    // Oracle: there is nothing to measure.
    let mut case = exact_case(0);
    landmarks(film_mut(&mut case, Posture::Neutral)).2.clear();
    let error = refused_in_measure(&case, &["neutral"]);
    assert_eq!(error, MeasureError { at: Posture::Neutral.into(), fault: MeasureFault::NoReading });
    let mut case = case_of(vec![graph_film(Posture::Erect, 390.0, |_| (0.0, 0.0))]);
    let FilmLandmarks::Placements { readings, .. } = &mut case.films[0].landmarks else {
        unreachable!("a graph film has placements")
    };
    readings.clear();
    assert_eq!(
        refused_in_measure(&case, &["erect"]),
        MeasureError { at: Posture::Erect.into(), fault: MeasureFault::NoReading }
    );
}

#[test]
fn two_vertebrae_with_swapped_names_are_out_of_order() {
    // Oracle: T6 stands on T7.
    let mut case = exact_case(0);
    let (_, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    let vertebrae = &mut readings[0].vertebrae;
    let (t7, t6) = (vertebrae[&Level::T7], vertebrae[&Level::T6]);
    vertebrae.insert(Level::T7, t6);
    vertebrae.insert(Level::T6, t7);
    let error = refused_in_measure(&case, &["erect", "T7 is marked above T6: check the labels"]);
    match error.fault {
        MeasureFault::OutOfOrder { inferior, superior, share, .. } => {
            assert_eq!((inferior, superior), (Level::T7, Level::T6));
            assert!(share < 0.0, "T6 is marked below T7: {share}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_vertebra_read_twice_under_two_names_is_out_of_order() {
    // Oracle: two vertebrae are not in one place.
    let mut case = exact_case(0);
    let (_, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    let t7 = readings[0].vertebrae[&Level::T7];
    readings[0].vertebrae.insert(Level::T6, t7);
    let error = refused_in_measure(&case, &["erect", "T7", "T6"]);
    assert!(matches!(error.fault, MeasureFault::OutOfOrder { .. }), "{error:?}");
}

#[test]
fn an_axis_with_a_large_angle_is_refused_with_its_angle() {
    // Oracle: no spine tilts a vertebra by 130° against L4.
    let mut case = exact_case(0);
    landmarks_mut(&mut case, Posture::Erect, Level::T9).axis_clockwise =
        Some(Angle::from_deg(130.0));
    let error = refused_in_measure(&case, &["erect", "T9", "120°", "relative to L4"]);
    assert!(
        matches!(error.fault, MeasureFault::TiltTooLarge { level: Level::T9, .. }),
        "{error:?}"
    );
    // On a film without L4, tilts are relative to L3, which is tilted itself.
    landmarks_mut(&mut case, Posture::Erect, Level::T9).axis_clockwise =
        Some(Angle::from_deg(150.0));
    let (_, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    readings.iter_mut().for_each(|reading| reading.vertebrae.retain(|&level, _| level > Level::L4));
    refused_in_measure(&case, &["erect", "T9", "120°", "relative to L3"]);
}

#[test]
fn a_film_whose_side_is_wrong_is_mirrored() {
    // Oracle: all corners are then on the wrong side, so it is the film and not the vertebrae.
    for posture in Posture::ALL {
        let mut case = exact_case(0);
        let (image, _, readings) = landmarks(film_mut(&mut case, posture));
        image.patient_left = image.patient_left.opposite();
        let count = readings[0].vertebrae.len();
        let error = refused_in_measure(&case, &[&posture.to_string(), "15", "patient_left"]);
        assert_eq!(error.at.film, posture.into());
        assert_eq!(error.fault, MeasureFault::FilmMirrored { count });
    }
}

#[test]
fn names_in_reverse_order_do_not_blame_the_corners_or_the_side() {
    // Oracle: the bodies stay where they are, upright and with their sides; only the names are exchanged.
    for posture in Posture::ALL {
        let mut case = exact_case(0);
        let (_, _, readings) = landmarks(film_mut(&mut case, posture));
        let count = readings[0].vertebrae.len();
        for reading in readings.iter_mut() {
            let levels: Vec<Level> = reading.vertebrae.keys().copied().collect();
            let bodies: Vec<_> = reading.vertebrae.values().rev().copied().collect();
            reading.vertebrae = levels.into_iter().zip(bodies).collect();
        }
        let error = refused_in_measure(&case, &[&posture.to_string(), "15", "reverse order"]);
        assert_eq!(error.fault, MeasureFault::LevelsReversed { count });
    }
}

#[test]
fn rows_that_count_from_the_bottom_do_not_blame_the_side() {
    // Oracle: such rows turn the picture over, so the spine runs down it and its sides are exchanged.
    for posture in Posture::ALL {
        let mut case = exact_case(0);
        let film = film_mut(&mut case, posture);
        let (image, _, readings) = landmarks(film);
        let (lowest, count) = (f64::from(image.rows) - 1.0, readings[0].vertebrae.len());
        move_places(film, |place| Pixel::new(place.column_px, lowest - place.row_px));
        let (film, rows) = (posture.to_string(), "rows count from the bottom");
        let error = refused_in_measure(&case, &[&film, "15", rows, "upside down"]);
        assert_eq!(error.at.film, posture.into());
        assert_eq!(error.fault, MeasureFault::RowsFromBottom { count });
        assert!(error.help().contains("height − 1 − row"), "{}", error.help());
    }
}
