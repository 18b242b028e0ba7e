//! Films and landmarks that contradict themselves.

use crate::common::{
    analyzed, exact_case, film_mut, landmarks, landmarks_mut, on_a_table, refused,
};
use spineline::analysis::Case;
use spineline::anatomy::{ImageSide, Level, Posture};
use spineline::measure::{Reading, ReadingId, VertebraLandmarks};
use spineline::spatial::{Angle, Pixel};

/// The same patient on films of both kinds: as held, mirrored, and with pixels twice as high as wide.
fn variants() -> [Case; 3] {
    let plain = exact_case(0);
    let mut mirrored = plain.clone();
    let mut oblong = plain.clone();
    for film in &mut mirrored.films {
        let (image, crests, readings) = landmarks(film);
        let last = f64::from(image.columns) - 1.0;
        let flip = |place: Pixel| Pixel::new(last - place.column_px, place.row_px);
        image.patient_left = match image.patient_left {
            ImageSide::Left => ImageSide::Right,
            ImageSide::Right => ImageSide::Left,
        };
        change(readings, flip);
        for landmark in readings.iter_mut().flat_map(|one| one.vertebrae.values_mut()) {
            landmark.axis_clockwise = landmark.axis_clockwise.map(|axis| -axis);
        }
        if let Some(crests) = crests {
            (crests.left, crests.right) = (flip(crests.left), flip(crests.right));
        }
    }
    for film in &mut oblong.films {
        let (image, crests, readings) = landmarks(film);
        let squeeze = |place: Pixel| Pixel::new(place.column_px, 0.5 * place.row_px);
        if let Some(spacing) = &mut image.spacing {
            spacing.row_mm *= 2.0;
        }
        change(readings, squeeze);
        if let Some(crests) = crests {
            (crests.left, crests.right) = (squeeze(crests.left), squeeze(crests.right));
        }
    }
    [plain, mirrored, oblong]
}

fn change(readings: &mut [Reading<VertebraLandmarks>], to: impl Fn(Pixel) -> Pixel) {
    for landmark in readings.iter_mut().flat_map(|one| one.vertebrae.values_mut()) {
        landmark.corners = landmark.corners.map(&to);
    }
}

/// Codes of the warnings of a sound case about one vertebra of one film.
fn codes(case: &Case, level: Level) -> Vec<&'static str> {
    let analysis = analyzed(case, &on_a_table());
    let of = analysis.warnings.all().iter().filter(|one| one.level == Some(level));
    of.filter(|one| one.posture == Some(Posture::Erect)).map(|one| one.code).collect()
}

#[test]
fn the_same_landmarks_in_two_postures_are_one_film() {
    for mut case in variants() {
        let erect = film_mut(&mut case, Posture::Erect).clone();
        film_mut(&mut case, Posture::RightBending).landmarks = erect.landmarks;
        let error = refused(&case);
        assert_eq!(error.code(), "film_repeated");
        let text = error.to_string();
        assert!(text.contains("erect") && text.contains("right bending"), "{text}");
    }
}

#[test]
fn exchanged_columns_and_rows_are_named() {
    for mut case in variants() {
        let (image, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
        // On the film as it is, and on one that holds the exchanged landmarks too.
        change(readings, |place| Pixel::new(place.row_px, place.column_px));
        let side = image.columns.max(image.rows);
        assert_eq!(refused(&case).code(), "axes_exchanged");
        let (image, ..) = landmarks(film_mut(&mut case, Posture::Erect));
        (image.columns, image.rows) = (side, side);
        assert_eq!(refused(&case).code(), "axes_exchanged");
    }
}

#[test]
fn impossible_ages_and_nameless_observers_are_refused() {
    for age in [-3.0, 240.0, f64::NAN] {
        let mut case = exact_case(0);
        case.subject.age_years = Some(age);
        assert_eq!(refused(&case).code(), "age");
    }
    let mut case = exact_case(0);
    landmarks(film_mut(&mut case, Posture::Neutral)).2[0].id = ReadingId::new("  ", 1);
    assert_eq!(refused(&case).code(), "no_observer");
}

#[test]
fn a_body_with_unlike_sides_is_doubted() {
    for mut case in variants() {
        assert!(codes(&case, Level::T8).is_empty());
        let corners = &mut landmarks_mut(&mut case, Posture::Erect, Level::T8).corners;
        // The left side keeps a quarter of its height.
        let (upper, lower) = (corners.superior_left, corners.inferior_left);
        corners.superior_left = Pixel::new(
            lower.column_px + 0.25 * (upper.column_px - lower.column_px),
            lower.row_px + 0.25 * (upper.row_px - lower.row_px),
        );
        assert!(codes(&case, Level::T8).contains(&"body_sides_differ"));
    }
}

#[test]
fn an_axis_far_from_its_corners_is_doubted() {
    for mut case in variants() {
        landmarks_mut(&mut case, Posture::Erect, Level::T8).axis_clockwise =
            Some(Angle::from_deg(80.0));
        assert!(codes(&case, Level::T8).contains(&"axis_against_corners"));
    }
}

#[test]
fn a_corner_far_from_the_other_readings_is_named_from_three_readings_on() {
    for mut case in variants() {
        for (readings, expected) in [(2, false), (3, true)] {
            let (_, _, all) = landmarks(film_mut(&mut case, Posture::Erect));
            let first = all[0].clone();
            *all = (1..=readings)
                .map(|repeat| Reading { id: ReadingId::new("A", repeat), ..first.clone() })
                .collect();
            let odd = all.last_mut().expect("two or three readings");
            let corners = &mut odd.vertebrae.get_mut(&Level::T8).expect("all are marked").corners;
            let (near, far) = (corners.superior_left, corners.superior_right);
            corners.superior_left.column_px += 0.3 * (near.column_px - far.column_px);
            let found = codes(&case, Level::T8).contains(&"corner_far_from_readings");
            assert_eq!(found, expected, "{readings} readings");
        }
    }
}
