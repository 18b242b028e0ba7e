//! What the frontal film shows of a vertebra's axis.

use std::collections::BTreeMap;

use crate::anatomy::Level;
use crate::measure::means::average;
use crate::measure::{Film, FilmLandmarks, MeasureError, Outline, TiltRule, measure_readings};
use crate::spatial::{Angle, Frontal};

/// One vertebra on the frontal film, upright as that film hung.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FrontalMark {
    pub location_mm: Frontal,
    /// Of the line through the centres of both endplates.
    pub axis_tilt: Angle,
    pub location_sd_mm: f64,
    pub tilt_sd: Angle,
}

/// The vertebrae that a frontal film shows. Where it has no corners, their tilts are those of the film, by whatever rule.
pub(super) fn frontal_marks(
    film: &Film,
    outline: &Outline,
) -> Result<BTreeMap<Level, FrontalMark>, MeasureError> {
    let readings = measure_readings(film, TiltRule::Axis)?;
    let placed: Vec<_> = readings.into_iter().map(|reading| reading.vertebrae).collect();
    let per_mm = outline.scale.pixels_per_mm.unwrap_or(1.0);
    let heights = axis_heights(film);
    let marks = average(&placed).into_iter().filter_map(|(level, (placement, _))| {
        let noise = outline.noise_of(outline.vertebra(level)?);
        let by_corners = |height: &f64| Angle::from_rad(noise.corner_mm() * per_mm / height);
        let mark = FrontalMark {
            location_mm: placement.location * (1.0 / per_mm),
            axis_tilt: placement.tilt,
            location_sd_mm: noise.location_mm,
            tilt_sd: heights.get(&level).map_or(noise.tilt, by_corners),
        };
        Some((level, mark))
    });
    Ok(marks.collect())
}

/// Mean distances between the centres of the endplates, in the film's millimetres or pixels.
fn axis_heights(film: &Film) -> BTreeMap<Level, f64> {
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else {
        return BTreeMap::new();
    };
    let mut all: BTreeMap<Level, Vec<f64>> = BTreeMap::new();
    for (&level, landmark) in readings.iter().flat_map(|reading| &reading.vertebrae) {
        let body = landmark.corners.map(|corner| image.frontal(corner));
        all.entry(level).or_default().push(body.height_mm());
    }
    let mean = |mut heights: Vec<f64>| {
        heights.sort_by(f64::total_cmp);
        heights.iter().sum::<f64>() / heights.len() as f64
    };
    all.into_iter().map(|(level, heights)| (level, mean(heights))).collect()
}
