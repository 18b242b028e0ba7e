//! Where a vertebra that one of two films shows must lie on the other one: at its height.

use std::collections::BTreeMap;

use super::alignment::{FilmAlignment, FrontalHeight, LateralSd};
use super::marks::mean_shape;
use crate::anatomy::{Level, Morphometry};
use crate::measure::bodies::{ReadBodies, corner_sd, crossing_sd};
use crate::measure::lateral::LateralVertebra;
use crate::measure::means::average;
use crate::measure::{
    Film, FilmLandmarks, ImageGeometry, LateralFilm, MeasureError, Noise, TiltRule,
    measure_readings,
};
use crate::spatial::{Frontal, Pixel};
use crate::warning::Warnings;

/// The line on a film on which the midpoint of a vertebra of the other film must lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightLine {
    /// The vertebra.
    pub level: Level,
    /// Ends of the line, at the first and the last column.
    pub ends: [Pixel; 2],
    /// Standard deviation of its place along the rows, in pixels.
    pub sd_px: f64,
}

/// The heights of vertebrae on an erect and a lateral film of one patient, each shown on the other film (epipolar lines of parallel rays).
///
/// # Definition
/// Heights agree by the [`FilmAlignment`] that is estimated from the vertebrae on both films. Of a vertebra on the lateral film the line on
/// the erect film is a row; the other way it has the turn of the lateral film. The standard deviation includes the alignment and
/// the midpoint on the film where the vertebra is marked, by the delta method.
///
/// # Assumptions
/// As for [`FilmAlignment`]. Films need not be complete. Where nothing was read twice, a corner has the deviation of one careful reading
/// ([`Noise::ONE_READING`]), on a film without spacing by the height of typical bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedHeights {
    /// On the erect film, of the vertebrae of the lateral one, caudal first.
    pub on_erect: Vec<HeightLine>,
    /// On the lateral film, of the vertebrae of the erect one, caudal first.
    pub on_lateral: Vec<HeightLine>,
    /// Vertebrae on both films, from which the alignment is estimated.
    pub vertebrae: usize,
}

impl SharedHeights {
    /// Of two films; `None` where fewer than two vertebrae are marked on both, or the erect film has no corners.
    ///
    /// # Errors
    /// [`MeasureError`] of either film.
    pub fn of(erect: &Film, lateral: &LateralFilm) -> Result<Option<Self>, MeasureError> {
        let once = erect.with_copies_as_one();
        let erect = &*once;
        let FilmLandmarks::Corners { image, .. } = &erect.landmarks else { return Ok(None) };
        let bodies = ReadBodies::of_film(erect);
        let assumed = assumed_corner_sd(image, &bodies);
        let marks = erect_marks(erect, &bodies, corner_sd(&bodies).unwrap_or(assumed))?;
        let seen = lateral.measure(&mut Warnings::default())?;
        let corner = LateralSd::of(&seen, assumed);
        let height = |level: Level| marks.get(&level).copied();
        let has_scale = image.scale().is_some();
        let Some(alignment) = FilmAlignment::of(&seen, corner, has_scale, height) else {
            return Ok(None);
        };
        let on_erect = |side: &LateralVertebra| row(image, &alignment, side, corner);
        let on_lateral = |(level, mark): (&Level, &FrontalHeight)| {
            line_on_lateral(lateral, &alignment, *level, mark)
        };
        Ok(Some(Self {
            on_erect: seen.vertebrae.iter().map(on_erect).collect(),
            on_lateral: marks.iter().map(on_lateral).collect(),
            vertebrae: alignment.vertebrae,
        }))
    }
}

/// Standard deviation of a corner of one careful reading, in the unit of the film.
fn assumed_corner_sd(image: &ImageGeometry, bodies: &[ReadBodies<'_>]) -> f64 {
    let one_mm = Noise::ONE_READING.corner_mm();
    if image.scale().is_some() {
        return one_mm;
    }
    let bodies = bodies.iter().flat_map(|reading| &reading.bodies);
    let sizes: Vec<f64> = bodies
        .map(|(level, body)| body.height_mm() / Morphometry::of(*level).body_height_mm)
        .collect();
    one_mm * sizes.iter().sum::<f64>() / sizes.len().max(1) as f64
}

/// Heights of the vertebrae of the erect film, in the unit of that film.
fn erect_marks(
    erect: &Film,
    bodies: &[ReadBodies<'_>],
    corner_sd: f64,
) -> Result<BTreeMap<Level, FrontalHeight>, MeasureError> {
    let readings = measure_readings(erect, TiltRule::Axis)?;
    let placed: Vec<_> = readings.into_iter().map(|reading| reading.vertebrae).collect();
    let marks = average(&placed).into_iter().filter_map(|(level, (placement, _))| {
        let [width, height] = mean_shape(bodies, level)?;
        let [_, sd] = crossing_sd(corner_sd, width, height);
        Some((level, FrontalHeight { height: placement.location.z_mm, sd }))
    });
    Ok(marks.collect())
}

/// The row of the erect film at the height of a vertebra of the lateral one.
fn row(
    image: &ImageGeometry,
    alignment: &FilmAlignment,
    side: &LateralVertebra,
    corner: LateralSd,
) -> HeightLine {
    let [height, alignment_sd] = alignment.height_mm(side.location);
    let sd = alignment_sd.hypot(corner.upwards(side).on_frontal(alignment.scale));
    let ends = [0.0, f64::from(image.columns.saturating_sub(1))].map(|column_px| {
        let row_px = image.pixel(Frontal::new(0.0, height)).row_px;
        Pixel::new(column_px, row_px)
    });
    HeightLine { level: side.level, ends, sd_px: sd / image.steps()[1] }
}

/// The line of the lateral film at the height of a vertebra of the erect one.
fn line_on_lateral(
    lateral: &LateralFilm,
    alignment: &FilmAlignment,
    level: Level,
    mark: &FrontalHeight,
) -> HeightLine {
    let image = &lateral.image;
    let at = |column_px: f64| {
        let front = image.frontal(Pixel::new(column_px, 0.0)).y_mm;
        alignment.place_at(mark.height, front)
    };
    let last = f64::from(image.columns.saturating_sub(1));
    let ends = [0.0, last].map(|column_px| image.pixel(at(column_px).0));
    let (_, alignment_sd) = at(0.5 * last);
    let sd = alignment_sd.hypot(mark.sd / alignment.scale);
    HeightLine { level, ends, sd_px: sd / image.steps()[1] }
}
