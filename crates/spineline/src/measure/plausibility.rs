//! Landmarks that no film of a spine can show, or that one reading alone shows.

use super::confidence::warn_of_confidence;
use super::{Corners, Film, FilmLandmarks, ImageGeometry, Reading, VertebraLandmarks};
use crate::anatomy::Level;
use crate::spatial::{Angle, Frontal, Pixel};
use crate::warning::{Step, Warnings};

/// The longer of two opposite sides of a body over the shorter one, above which a corner is doubted.
///
/// Of 8177 bodies of the training landmarks of [wu-boostnet-2017], with their films taken as 2.5 times as high as wide,
/// 11 exceed it by their left and right sides and 2 by the others.
const LARGEST_SIDE_RATIO: f64 = 2.5;

/// Readings of a corner from which one of them can be called the odd one: of two, neither is.
const FEWEST_READINGS: usize = 3;

/// Distance of a corner from the median of its readings, in medians of such distances on the film. For normal errors in
/// two directions the median is 1.18 standard deviations, so this is beyond nine of them.
const OUTLIER_MEDIANS: f64 = 8.0;

/// A corner closer than this part of its body's diagonal to the median of its readings is no outlier, however well the
/// other readings agree.
const SMALLEST_OUTLIER_SHARE: f64 = 0.15;

/// Angle between an axis turned by hand and that of the corners, above which one of them is doubted. Assumption: far
/// above the deviation of either (assumption).
const LARGEST_AXIS_DIFFERENCE: Angle = Angle::from_deg(30.0);

/// Whether two films carry the same landmarks or placements, whoever is named as their observer.
pub(crate) fn same_landmarks(a: &Film, b: &Film) -> bool {
    fn same<T: PartialEq>(a: &[Reading<T>], b: &[Reading<T>]) -> bool {
        let marked = a.iter().any(|reading| !reading.vertebrae.is_empty());
        marked && a.iter().map(|one| &one.vertebrae).eq(b.iter().map(|one| &one.vertebrae))
    }
    match (&a.landmarks, &b.landmarks) {
        (
            FilmLandmarks::Corners { readings: a, .. },
            FilmLandmarks::Corners { readings: b, .. },
        ) => same(a, b),
        (
            FilmLandmarks::Placements { readings: a, .. },
            FilmLandmarks::Placements { readings: b, .. },
        ) => same(a, b),
        _ => false,
    }
}

/// Whether all landmarks of a reading lie on the film, from bottom to top, once columns and rows are exchanged.
pub(super) fn fits_exchanged(image: &ImageGeometry, reading: &Reading<VertebraLandmarks>) -> bool {
    let exchanged = |place: Pixel| Pixel::new(place.row_px, place.column_px);
    let bodies: Vec<Corners<Frontal>> = reading
        .vertebrae
        .values()
        .map(|landmark| landmark.corners.map(exchanged))
        .take_while(|corners| corners.points().iter().all(|&corner| image.contains(corner)))
        .map(|corners| corners.map(|corner| image.frontal(corner)))
        .collect();
    let upright = Frontal::new(0.0, 1.0);
    bodies.len() > 1
        && bodies.len() == reading.vertebrae.len()
        && bodies.iter().all(|body| body.sides_agree() && body.points_along(upright))
}

/// Warnings about the corners of every reading, and about readings against one another.
pub(crate) fn warn_of_implausible_landmarks(film: &Film, warnings: &mut Warnings) {
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else { return };
    for reading in readings {
        warn_of_confidence(film.posture, reading, warnings);
        for (&level, landmark) in &reading.vertebrae {
            warn_of_body(film, image, (reading, level, landmark), warnings);
        }
    }
    warn_of_outliers(film, image, readings, warnings);
}

/// One body by itself: its sides, and its axis.
fn warn_of_body(
    film: &Film,
    image: &ImageGeometry,
    (reading, level, landmark): (&Reading<VertebraLandmarks>, Level, &VertebraLandmarks),
    warnings: &mut Warnings,
) {
    let body = landmark.corners.map(|corner| image.frontal(corner));
    for (sides, ratio) in body.side_ratios() {
        if ratio > LARGEST_SIDE_RATIO {
            let text = format!(
                "observer {}: {sides} differ by a factor of {ratio:.1} (limit {LARGEST_SIDE_RATIO}): check the four corners of this vertebra",
                reading.id
            );
            warnings.vertebra(Step::Measure, "body_sides_differ", film.posture, level, text);
        }
    }
    let Some(axis) = landmark.axis_clockwise else { return };
    let apart = (image.tilt_from_clockwise(axis) - body.measure_tilt()).wrapped().abs();
    if apart > LARGEST_AXIS_DIFFERENCE {
        let text = format!(
            "observer {}: the axis turned by hand is {:.0}° from that of the corners (limit {:.0}°): check the axis and the corners",
            reading.id,
            apart.deg(),
            LARGEST_AXIS_DIFFERENCE.deg()
        );
        warnings.vertebra(Step::Measure, "axis_against_corners", film.posture, level, text);
    }
}

/// Corners of one reading far from the median of all readings.
fn warn_of_outliers(
    film: &Film,
    image: &ImageGeometry,
    readings: &[Reading<VertebraLandmarks>],
    warnings: &mut Warnings,
) {
    let mut found = Vec::new();
    for level in Level::ALL {
        let bodies: Vec<(&Reading<VertebraLandmarks>, Corners<Frontal>)> = readings
            .iter()
            .filter_map(|one| Some((one, one.vertebrae.get(&level)?)))
            .map(|(one, landmark)| (one, landmark.corners.map(|corner| image.frontal(corner))))
            .collect();
        if bodies.len() < FEWEST_READINGS {
            continue;
        }
        for corner in 0..4 {
            let of = |body: &Corners<Frontal>| body.points()[corner];
            let middle = Frontal::new(
                median(bodies.iter().map(|(_, body)| of(body).y_mm).collect()),
                median(bodies.iter().map(|(_, body)| of(body).z_mm).collect()),
            );
            let diagonal =
                median(bodies.iter().map(|(_, body)| body.longer_diagonal_mm()).collect());
            for (reading, body) in &bodies {
                let share = of(body).distance_mm(middle) / diagonal;
                found.push((level, corner, &reading.id, share));
            }
        }
    }
    if found.is_empty() {
        return;
    }
    let usual = median(found.iter().map(|&(.., share)| share).collect());
    let limit = (OUTLIER_MEDIANS * usual).max(SMALLEST_OUTLIER_SHARE);
    const CORNERS: [&str; 4] =
        ["superior left", "superior right", "inferior left", "inferior right"];
    for (level, corner, id, share) in found.into_iter().filter(|&(.., share)| share > limit) {
        let text = format!(
            "observer {id}: the {} corner is {:.0} % of the body's diagonal from the median of all readings (limit {:.0} %): mark it again",
            CORNERS[corner],
            100.0 * share,
            100.0 * limit
        );
        warnings.vertebra(Step::Measure, "corner_far_from_readings", film.posture, level, text);
    }
}

/// Median of at least one value, all finite.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}
