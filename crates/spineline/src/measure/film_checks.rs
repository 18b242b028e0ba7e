//! Checks of one film before it is measured: scale, readings, bodies and crests.

use std::collections::BTreeSet;

use super::frame::body_shape;
use super::{
    Film, FilmLandmarks, FilmPlace, IliacCrests, ImageGeometry, LengthScale, MeasureError,
    MeasureFault, Placement, Reading, Spacing, is_observer_code,
};
use crate::anatomy::{FilmView, Posture};
use crate::spatial::Pixel;

pub(super) fn check_spacing(posture: Posture, image: &ImageGeometry) -> Result<(), MeasureError> {
    check_pixels(posture.into(), image.spacing)?;
    image.check_size().map_err(|fault| MeasureFault::FilmTooLarge { fault }.at(posture))
}

/// Refuses distances between pixels that no film has.
pub(super) fn check_pixels(film: FilmView, spacing: Option<Spacing>) -> Result<(), MeasureError> {
    let Some(spacing) = spacing else { return Ok(()) };
    for (direction, value) in [("column", spacing.column_mm), ("row", spacing.row_mm)] {
        if !Spacing::is_possible(value) {
            return Err(MeasureFault::Spacing { direction, value }.at(film));
        }
    }
    Ok(())
}

/// Refuses a standard deviation of a scale that is below zero or says that the scale is not known.
pub(super) fn check_scale_sd(
    posture: Posture,
    relative_sd: Option<f64>,
) -> Result<(), MeasureError> {
    let most = LengthScale::MAX_RELATIVE_SD;
    match relative_sd.filter(|sd| !(0.0..=most).contains(sd)) {
        Some(value) => Err(MeasureFault::ScaleSd { value, most }.at(posture)),
        None => Ok(()),
    }
}

/// Widths and heights of vertebral bodies on films, from small children to the largest adults on a film magnified by
/// half, with a wide margin (assumption): what lies outside is an error of the scale or of a corner.
const BODY_WIDTHS_MM: [f64; 2] = [5.0, 150.0];
const BODY_HEIGHTS_MM: [f64; 2] = [2.0, 100.0];

/// Refuses bodies of a size that no vertebra has, on a film with a scale.
pub(super) fn check_body_sizes(film: &Film) -> Result<(), MeasureError> {
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else { return Ok(()) };
    for reading in readings {
        // No result needs L5 or T1, which are left out where they are unusable.
        for (&level, landmark) in
            reading.vertebrae.iter().filter(|(l, _)| l.model_index().is_some())
        {
            let [height_mm, width_mm] = body_shape(image, landmark);
            for (side, size_mm, [least_mm, most_mm]) in
                [("wide", width_mm, BODY_WIDTHS_MM), ("high", height_mm, BODY_HEIGHTS_MM)]
            {
                if !(least_mm..=most_mm).contains(&size_mm) {
                    let fault = MeasureFault::BodySize { level, side, size_mm, least_mm, most_mm };
                    return Err(fault.at(FilmPlace::reading(film.posture, &reading.id)));
                }
            }
        }
    }
    Ok(())
}

pub(super) fn check_readings<T>(
    posture: Posture,
    readings: &[Reading<T>],
) -> Result<(), MeasureError> {
    if readings.is_empty() {
        return Err(MeasureFault::NoReading.at(posture));
    }
    check_observers(posture.into(), readings)
}

/// Every reading has an observer that is a code and a repeat from 1, and both together name one reading only.
pub(super) fn check_observers<T>(
    film: FilmView,
    readings: &[Reading<T>],
) -> Result<(), MeasureError> {
    if let Some(one) = readings.iter().find(|one| !is_observer_code(&one.id.observer)) {
        return Err(MeasureFault::Observer { id: one.id.clone() }.at(film));
    }
    if let Some(one) = readings.iter().find(|one| one.id.repeat == 0) {
        return Err(MeasureFault::Repeat { id: one.id.clone() }.at(film));
    }
    let mut seen = BTreeSet::new();
    match readings.iter().find(|one| !seen.insert(&one.id)) {
        Some(twice) => Err(MeasureFault::DuplicateReading { id: twice.id.clone() }.at(film)),
        None => Ok(()),
    }
}

pub(super) fn check_placements(
    posture: Posture,
    readings: &[Reading<Placement>],
) -> Result<(), MeasureError> {
    for reading in readings {
        for (&level, placement) in &reading.vertebrae {
            if !(placement.location.is_finite() && placement.tilt.rad().is_finite()) {
                return Err(MeasureFault::NotFinite.at(FilmPlace::vertebra(
                    posture,
                    &reading.id,
                    level,
                )));
            }
        }
    }
    Ok(())
}

/// Crests must lie on the picture, apart, and on their sides.
pub(super) fn check_crests(
    posture: Posture,
    image: &ImageGeometry,
    crests: &IliacCrests,
) -> Result<(), MeasureError> {
    const MIN_DISTANCE_MM: f64 = 50.0;
    let outside = [crests.left, crests.right].into_iter().find(|&crest| !image.contains(crest));
    if let Some(Pixel { column_px, row_px }) = outside {
        let (columns, rows) = (image.columns, image.rows);
        return Err(MeasureFault::CrestOffImage { column_px, row_px, columns, rows }.at(posture));
    }
    let apart_mm = image.frontal(crests.left).distance_mm(image.frontal(crests.right));
    // Without a spacing, how far apart they are says nothing.
    if (image.scale().is_some() && apart_mm < MIN_DISTANCE_MM) || apart_mm == 0.0 {
        return Err(MeasureFault::Crests { apart_mm, limit_mm: MIN_DISTANCE_MM }.at(posture));
    }
    Ok(())
}
