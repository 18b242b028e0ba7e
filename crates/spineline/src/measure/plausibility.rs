//! Landmarks that no film of a spine can show, or that one reading alone shows.

use super::bodies::{ReadBodies, median};
use super::confidence::warn_of_confidence;
use super::copies::MIN_SAME;
use super::lengths::warn_of_lengths;
use super::neighbours::warn_of_corners_off_the_trend;
use super::readings_apart::warn_of_readings_apart;
use super::rounding::warn_of_rounding;
use super::{Corners, Film, FilmLandmarks, ImageGeometry, Reading, ReadingId, VertebraLandmarks};
use crate::anatomy::{FilmView, Level};
use crate::number::fixed;
use crate::spatial::{Angle, Frontal, Pixel};
use crate::warning::{WarningCode, Warnings};

/// The longer of two opposite sides of a body over the shorter one, above which a corner is doubted.
///
/// Of 8177 bodies of the training landmarks of [wu-boostnet-2017], with their films taken as 2.5 times as high as wide,
/// 11 exceed it by their left and right sides and 2 by the others.
const MAX_SIDE_RATIO: f64 = 2.5;

/// Readings of a corner from which one of them can be called an outlier: of two, neither is.
const MIN_READINGS: usize = 3;

/// Distance of a corner from the median of its readings, in medians of such distances on the film. For normal errors in
/// two directions the median is 1.18 standard deviations, so this is beyond nine of them.
const OUTLIER_MEDIANS: f64 = 8.0;

/// A corner closer than this part of its body's diagonal to the median of its readings is not an outlier, however well the
/// other readings agree.
const MIN_OUTLIER_SHARE: f64 = 0.15;

/// Angle between an axis turned by hand and the axis of the corners, above which one of them is doubted. Far above the
/// deviation of either (assumption).
const MAX_AXIS_DIFFERENCE: Angle = Angle::from_deg(30.0);

/// Whether a reading of one film has the landmarks or placements of a reading of the other one, whoever is named as its
/// observer.
pub(crate) fn same_landmarks(a: &Film, b: &Film) -> bool {
    fn same<T: PartialEq>(a: &[Reading<T>], b: &[Reading<T>]) -> bool {
        let mut marked = a.iter().filter(|reading| reading.vertebrae.len() >= MIN_SAME);
        marked.any(|one| b.iter().any(|other| one.vertebrae == other.vertebrae))
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

/// Warnings about the readings, corners and lengths of a frontal film.
pub(crate) fn warn_of_implausible_landmarks(film: &Film, warnings: &mut Warnings) {
    warn_of_corners(film.posture.into(), &ReadBodies::of_film(film), warnings);
    film.warn_of_copies(warnings);
    warn_of_lengths(film, warnings);
    warn_of_rounding(film, warnings);
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else { return };
    for reading in readings {
        warn_of_confidence(film.posture, reading, warnings);
        for (&level, landmark) in &reading.vertebrae {
            warn_of_axis(film, image, &reading.id, level, landmark, warnings);
        }
    }
}

/// Warnings about the landmarks of a frontal film, of whichever vertebrae: those that an analysis of the film gives too.
///
/// ```
/// use spineline::measure::judge_landmarks;
/// use spineline::anatomy::Level;
/// use spineline::warning::WarningCode;
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let mut film = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case.films.remove(0);
/// assert!(judge_landmarks(&film).all().is_empty());
/// let reading = &mut film.landmarks.corner_readings_mut()[0];
/// if let Some(body) = reading.vertebrae.get_mut(&Level::T8) {
///     body.corners.superior_left.column_px += 150.0;
/// }
/// assert!(judge_landmarks(&film).has(WarningCode::CornerFarFromNeighbours));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn judge_landmarks(film: &Film) -> Warnings {
    let mut warnings = Warnings::default();
    warn_of_implausible_landmarks(film, &mut warnings);
    warnings
}

/// Warnings about one reading of a frontal film, by itself and against the film's other readings.
#[must_use]
pub fn judge_reading(film: &Film, id: &ReadingId) -> Warnings {
    let mut warnings = Warnings::default();
    let mut alone = film.clone();
    if let FilmLandmarks::Corners { readings, .. } = &mut alone.landmarks {
        readings.retain(|reading| reading.id == *id);
    }
    warn_of_implausible_landmarks(&alone, &mut warnings);
    let (view, readings) = (film.posture.into(), ReadBodies::of_film(film));
    warn_of_outliers(view, &readings, Some(id), &mut warnings);
    warn_of_readings_apart(view, &readings, Some(id), &mut warnings);
    warnings
}

/// Warnings about the corners of every reading by itself, and about readings against one another.
pub(super) fn warn_of_corners(
    film: FilmView,
    readings: &[ReadBodies<'_>],
    warnings: &mut Warnings,
) {
    for reading in readings {
        for (level, body) in &reading.bodies {
            warn_of_sides(film, reading.id, *level, body, warnings);
        }
        warn_of_corners_off_the_trend(film, reading, warnings);
    }
    warn_of_outliers(film, readings, None, warnings);
    warn_of_readings_apart(film, readings, None, warnings);
}

/// Opposite sides of one body.
fn warn_of_sides(
    film: FilmView,
    id: &ReadingId,
    level: Level,
    body: &Corners<Frontal>,
    warnings: &mut Warnings,
) {
    for (sides, ratio) in film.sides().into_iter().zip(body.side_ratios()) {
        if ratio > MAX_SIDE_RATIO {
            let text = format!(
                "observer {id}: {sides} differ by a factor of {} (limit {MAX_SIDE_RATIO}): check the four corners of this vertebra",
                fixed(ratio, 1)
            );
            film.warn(WarningCode::BodySidesDiffer, level, text, warnings);
        }
    }
}

/// An axis turned by hand against the corners of its body.
fn warn_of_axis(
    film: &Film,
    image: &ImageGeometry,
    id: &ReadingId,
    level: Level,
    landmark: &VertebraLandmarks,
    warnings: &mut Warnings,
) {
    let Some(axis) = landmark.axis_clockwise else { return };
    let body = landmark.corners.map(|corner| image.frontal(corner));
    let apart = (image.tilt_from_clockwise(axis) - body.measure_tilt()).wrapped().abs();
    if apart > MAX_AXIS_DIFFERENCE {
        let text = format!(
            "observer {}: the axis turned by hand is {} from the axis of the corners (limit {}): check the axis and the corners",
            id,
            apart.text(0),
            MAX_AXIS_DIFFERENCE.text(0)
        );
        warnings.vertebra(WarningCode::AxisAgainstCorners, film.posture, level, text);
    }
}

/// Corners far from the median of all readings: of one reading, or of any.
fn warn_of_outliers(
    film: FilmView,
    readings: &[ReadBodies<'_>],
    of: Option<&ReadingId>,
    warnings: &mut Warnings,
) {
    let mut found = Vec::new();
    for level in Level::ALL {
        let bodies: Vec<(&ReadingId, &Corners<Frontal>)> =
            readings.iter().filter_map(|one| Some((one.id, one.body(level)?))).collect();
        if bodies.len() < MIN_READINGS {
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
            for (id, body) in &bodies {
                let share = of(body).distance_mm(middle) / diagonal;
                found.push((level, corner, *id, share));
            }
        }
    }
    if found.is_empty() {
        return;
    }
    let usual = median(found.iter().map(|&(.., share)| share).collect());
    let limit = (OUTLIER_MEDIANS * usual).max(MIN_OUTLIER_SHARE);
    let asked = |id: &ReadingId| of.is_none_or(|of| of == id);
    let odd = found.into_iter().filter(|&(_, _, id, share)| share > limit && asked(id));
    for (level, corner, id, share) in odd {
        let text = format!(
            "observer {id}: the {} corner is {} % of the body's diagonal from the median of all readings (limit {} %): mark it again",
            film.corners()[corner],
            fixed(100.0 * share, 0),
            fixed(100.0 * limit, 0)
        );
        film.warn(WarningCode::CornerFarFromReadings, level, text, warnings);
    }
}
