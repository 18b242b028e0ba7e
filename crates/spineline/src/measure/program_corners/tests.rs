use super::super::completion::provide_shape;
use super::super::{Noise, ReadingId, VertebraLandmarks};
use super::*;
use crate::anatomy::ImageSide;
use crate::spatial::Pixel;

/// One pixel is the unit; the patient's left is on the right of the picture.
const IMAGE: ImageGeometry =
    ImageGeometry { columns: 800, rows: 2000, patient_left: ImageSide::Right, spacing: None };

/// A body about a place, from half its width and half its height.
fn body(column_px: f64, row_px: f64, [half_width, half_height]: [f64; 2]) -> Corners<Pixel> {
    let at = |x: f64, y: f64| Pixel::new(column_px + x, row_px + y);
    Corners {
        superior_left: at(half_width, -half_height),
        superior_right: at(-half_width, -half_height),
        inferior_left: at(half_width, half_height),
        inferior_right: at(-half_width, half_height),
    }
}

fn reading(vertebrae: Vec<(Level, VertebraLandmarks)>) -> Reading<VertebraLandmarks> {
    Reading { id: ReadingId::new("A", 1), vertebrae: vertebrae.into_iter().collect() }
}

/// Bodies of L4 to T2 above one another, with the walls marked and the corners of this origin.
fn column(origin: Origin) -> Reading<VertebraLandmarks> {
    provide_shape(spineline_weights::ERECT_SPINES);
    let marked = |(i, level): (usize, Level)| {
        let row_px = 1800.0 - 100.0 * i as f64;
        let walls = [Some(Pixel::new(460.0, row_px)), Some(Pixel::new(340.0, row_px))];
        let mut landmark = VertebraLandmarks::clicked(body(400.0, row_px, [60.0, 35.0]));
        (landmark.walls, landmark.origins) = (walls, Corners::all(origin));
        (level, landmark)
    };
    reading(Level::MODEL.into_iter().enumerate().map(marked).collect())
}

fn noise_of(reading: &Reading<VertebraLandmarks>, level: Level) -> Option<ProgramNoise> {
    let corners = ProgramCorners::of(&IMAGE, Some(Posture::Erect), reading).expect("completed");
    corners?.noise(&IMAGE, level, &reading.vertebrae[&level], TiltRule::Endplates)
}

#[test]
fn clicked_corners_have_no_noise_of_a_program() {
    assert!(noise_of(&column(Origin::Clicked), Level::L1).is_none());
    assert!(noise_of(&column(Origin::Adjusted), Level::L1).is_none());
}

#[test]
fn independent_corners_of_a_square_give_the_closed_form() {
    let mut landmark = VertebraLandmarks::clicked(body(400.0, 900.0, [10.0; 2]));
    (landmark.origins, landmark.sd_share) = (Corners::all(Origin::Detected), Some(0.05));
    let reading = reading(vec![(Level::T9, landmark)]);
    let noise = noise_of(&reading, Level::T9).expect("all corners are a program's");
    // A corner moves the crossing by half of what it moves across its diagonal, along the other one: 1 px of each of four corners
    // makes 1/sqrt(2) in every direction. The line through the walls' midpoints is 20 long.
    assert!((noise.location_mm - 0.5_f64.sqrt()).abs() < 1e-6, "{noise:?}");
    assert!((noise.tilt.rad() - 1.0 / 20.0).abs() < 1e-6, "{noise:?}");
    assert!(noise.placed_share == 0.0 && !noise.is_reviewed);
}

#[test]
fn corners_completed_from_walls_are_as_certain_as_clicks_and_accepting_does_not_help() {
    let completed = noise_of(&column(Origin::Completed), Level::T8).expect("completed");
    let accepted = noise_of(&column(Origin::Accepted), Level::T8).expect("accepted");
    assert_eq!(completed.location_mm, accepted.location_mm);
    assert_eq!(completed.tilt, accepted.tilt);
    assert!(!completed.is_reviewed && accepted.is_reviewed);
    // A click is a fortieth of the distance between neighbours, which is 100: both walls fix a tilt to sqrt(2) clicks over the
    // width. The neighbours reduce it; the difference of endplates and walls adds to it.
    let by_clicks = Angle::from_rad(2.0_f64.sqrt() * 2.65 / 120.0);
    assert!(completed.tilt > by_clicks * 0.5 && completed.tilt < by_clicks * 2.0, "{completed:?}");
}

#[test]
fn completed_corners_move_together() {
    let reading = column(Origin::Completed);
    let corners = ProgramCorners::of(&IMAGE, Some(Posture::Erect), &reading).expect("completed");
    let corners = corners.expect("all corners are completed");
    assert_eq!(corners.corners().len(), 4 * Level::MODEL.len());
    let covariance = &corners.factor_mm * corners.factor_mm.transpose();
    // The two superior corners of a vertebra go up and down with its height.
    let correlation = covariance[(1, 3)] / (covariance[(1, 1)] * covariance[(3, 3)]).sqrt();
    assert!(correlation > 0.5, "{correlation}");
    let mut moved = reading.vertebrae.clone();
    corners.move_by(&IMAGE, &vec![[0.0; 2]; corners.corners().len()], &mut moved);
    for (level, landmark) in &moved {
        let before = reading.vertebrae[level].corners.superior_left;
        assert!((landmark.corners.superior_left.row_px - before.row_px).abs() < 1e-9);
    }
}

#[test]
fn corners_that_nothing_completes_are_an_error() {
    let mut reading = column(Origin::Completed);
    reading.vertebrae.values_mut().for_each(|landmark| landmark.walls = [None; 2]);
    let found = ProgramCorners::of(&IMAGE, Some(Posture::Erect), &reading);
    assert!(matches!(found, Err(CompletionError::TooFew { clicks: 0 })));
}

#[test]
fn means_of_completed_readings_are_as_uncertain_as_one() {
    let one = ProgramNoise {
        location_mm: 2.0,
        tilt: Angle::from_deg(1.0),
        placed_share: 0.0,
        placed_tilt_share: 0.0,
        is_reviewed: true,
    };
    assert_eq!(ProgramNoise::of_mean(&[None, None]), None);
    let alike = ProgramNoise::of_mean(&[Some(one); 3]).expect("all are completed");
    assert!((alike.location_mm - 2.0).abs() < 1e-12);
    let half = ProgramNoise::of_mean(&[Some(one), None]).expect("one is completed");
    assert!((half.location_mm - 2.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!(half.placed_share, 0.5);
    let film =
        Noise { location_mm: 1.0, tilt: Angle::from_deg(0.5), tilt_degrees_of_freedom: None };
    assert!((half.beside(film).location_mm - 2.5_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn an_axis_set_by_hand_keeps_the_noise_of_axes_and_no_noise_is_zero() {
    let mut reading = column(Origin::Accepted);
    let landmark = reading.vertebrae.get_mut(&Level::T8).expect("a vertebra");
    landmark.axis_clockwise = Some(Angle::ZERO);
    let film =
        Noise { location_mm: 1.0, tilt: Angle::from_deg(0.5), tilt_degrees_of_freedom: None };
    let noise = noise_of(&reading, Level::T8).expect("accepted").beside(film);
    assert_eq!(noise.tilt, film.tilt);
    let sure = VertebraLandmarks {
        origins: Corners::all(Origin::Detected),
        sd_share: Some(0.0),
        ..VertebraLandmarks::clicked(body(400.0, 900.0, [10.0; 2]))
    };
    let noise = noise_of(&self::reading(vec![(Level::T9, sure)]), Level::T9);
    let noise = noise.expect("detected").beside(film);
    assert!(noise.location_mm > 0.0 && noise.tilt.rad() > 0.0, "{noise:?}");
}

#[test]
fn corners_that_later_landmarks_contradict_are_as_uncertain_as_they_are_off() {
    let before = noise_of(&column(Origin::Accepted), Level::T8).expect("accepted");
    let mut moved = column(Origin::Accepted);
    // The accepted body stays where it was, and its walls are marked again 30 px further down.
    let landmark = moved.vertebrae.get_mut(&Level::T8).expect("a vertebra");
    landmark.walls = landmark
        .walls
        .map(|wall| wall.map(|place| Pixel::new(place.column_px, place.row_px + 30.0)));
    let after = noise_of(&moved, Level::T8).expect("accepted");
    assert!(before.location_mm < 10.0 && after.location_mm > 15.0, "{before:?} {after:?}");
}
