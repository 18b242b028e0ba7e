//! A vertebra's axis on the frontal film.

use std::collections::BTreeMap;

use crate::anatomy::Level;
use crate::measure::bodies::{ReadBodies, corner_sd, crossing_sd};
use crate::measure::means::average;
use crate::measure::{Film, MeasureError, Outline, TiltRule, measure_readings};
use crate::number::mean;
use crate::spatial::{Angle, Frontal};

/// One vertebra on the frontal film, upright as that film hung.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FrontalMark {
    pub location_mm: Frontal,
    /// Of the line through the centres of both endplates.
    pub axis_tilt: Angle,
    /// Of the location, to the left and upwards.
    pub location_sd_mm: [f64; 2],
    pub tilt_sd: Angle,
}

/// The vertebrae that a frontal film shows. Without corners, their tilts are the film's, by any rule.
pub(super) fn frontal_marks(
    film: &Film,
    outline: &Outline,
) -> Result<BTreeMap<Level, FrontalMark>, MeasureError> {
    let readings = measure_readings(film, TiltRule::Axis)?;
    let placed: Vec<_> = readings.into_iter().map(|reading| reading.vertebrae).collect();
    let per_mm = outline.scale.units_per_mm;
    let bodies = ReadBodies::of_film(film);
    let measured_sd = corner_sd(&bodies);
    let marks = average(&placed).into_iter().filter_map(|(level, (placement, _))| {
        let vertebra = outline.vertebra(level)?;
        let noise = outline.noise_of(vertebra);
        // Differences of a program's corners between readings do not show their error.
        let corner_sd = match (measured_sd, vertebra.program) {
            (Some(sd), None) => sd,
            _ => noise.corner_mm() * per_mm,
        };
        let (location_sd_mm, tilt_sd) = match mean_shape(&bodies, level) {
            Some([width, height]) => {
                let crossing = crossing_sd(corner_sd, width, height);
                (crossing.map(|sd| sd / per_mm), Angle::from_rad(corner_sd / height))
            }
            None => ([noise.location_mm; 2], noise.tilt),
        };
        let mark = FrontalMark {
            location_mm: placement.location * (1.0 / per_mm),
            axis_tilt: placement.tilt,
            location_sd_mm,
            tilt_sd,
        };
        Some((level, mark))
    });
    Ok(marks.collect())
}

/// Mean width of a body and mean distance between the centres of its endplates, in the film's millimetres or pixels.
pub(super) fn mean_shape(readings: &[ReadBodies<'_>], level: Level) -> Option<[f64; 2]> {
    let bodies = readings.iter().filter_map(|reading| reading.body(level));
    let mut shapes: Vec<[f64; 2]> =
        bodies.map(|body| [body.mean_width_mm(), body.height_mm()]).collect();
    // Sums in a fixed order: the order of the readings must not reach the last bit.
    shapes.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mean_of = |side: usize| mean(shapes.iter().map(|one| one[side]));
    Some([mean_of(0)?, mean_of(1)?])
}
