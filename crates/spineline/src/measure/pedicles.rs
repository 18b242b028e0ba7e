//! Axial rotations of a film's vertebrae from their marked pedicles.

use super::axial::{PediclePair, height_over, own_heights};
use super::{
    AxialRotation, Corners, Film, FilmLandmarks, FilmPlace, ImageGeometry, MeasureError,
    MeasureFault, Outline, PedicleFault, Reading, VertebraLandmarks,
};
use crate::anatomy::{Level, Side};
use crate::spatial::{Frontal, Pixel};
use crate::warning::{WarningCode, Warnings};

/// Share of half of the distance between two pedicles, by which both lie on one half of the body, from where they are doubted: a typical
/// vertebra shows it at an axial rotation of 35° in the thoracic spine and 40° at L2.
const ONE_SIDE_SHARE: f64 = -0.25;

/// Axial rotations of all vertebrae of a film on which both pedicles are marked, caudal first: means over readings.
///
/// # Errors
/// [`MeasureFault::Pedicles`] names film, reading, vertebra and fault.
pub(crate) fn axial_rotations(
    film: &Film,
    outline: &Outline,
    warnings: &mut Warnings,
) -> Result<Vec<AxialRotation>, MeasureError> {
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else {
        return Ok(Vec::new());
    };
    let mut found = Vec::new();
    for level in Level::ALL {
        let mut places: Vec<PediclePair> = Vec::new();
        for reading in readings {
            let Some(landmark) = reading.vertebrae.get(&level) else { continue };
            let [Some(left), Some(right)] = landmark.pedicles else { continue };
            let fault = |fault| {
                let place = FilmPlace::vertebra(film.posture, &reading.id, level);
                MeasureFault::Pedicles { fault }.at(place)
            };
            if ![left, right].into_iter().all(|place| image.contains(place)) {
                return Err(fault(PedicleFault::OffImage));
            }
            let pair = PediclePair::of(landmark, |place| image.frontal(place)).map_err(fault)?;
            match level_at(image, reading, level, [left, right]) {
                Some(fits) if fits != level => {
                    return Err(fault(PedicleFault::OtherLevel { fits }));
                }
                Some(_) => {}
                None => {
                    let text = "its pedicles lie far above or below its body: check both pedicles";
                    warnings.vertebra(WarningCode::PediclesUnusual, film.posture, level, text);
                }
            }
            places.push(pair);
        }
        let marked = places.len();
        let Some(mean) = PediclePair::mean(places) else { continue };
        let Some(vertebra) = outline.vertebra(level) else { continue };
        let per_mm = outline.scale.units_per_mm;
        let corner_sd = outline.noise_of(vertebra).corner_mm() * per_mm;
        let rotation = mean.rotation(level, corner_sd, marked);
        if mean.nearer_share() < ONE_SIDE_SHARE {
            // The front turns away from the half on which the pedicles lie.
            let half = rotation.side().map_or(Side::Left, Side::opposite);
            let text = format!(
                "both of its pedicles lie on the {half} half of its body, so its axial rotation is {}: check both pedicles and the corners",
                rotation.words()
            );
            warnings.vertebra(WarningCode::PediclesUnusual, film.posture, level, text);
        }
        found.push(rotation);
    }
    Ok(found)
}

/// The marked vertebra whose height fits pedicles that are marked for `level`: this one before all others.
fn level_at(
    image: &ImageGeometry,
    reading: &Reading<VertebraLandmarks>,
    level: Level,
    pedicles: [Pixel; 2],
) -> Option<Level> {
    let pedicles = pedicles.map(|place| image.frontal(place));
    let height = |landmark: &VertebraLandmarks| {
        let body: Corners<Frontal> = landmark.corners.map(|corner| image.frontal(corner));
        height_over(&body, pedicles)
    };
    let fits = |other: Level, landmark| own_heights(other).contains(&height(landmark));
    if reading.vertebrae.get(&level).is_some_and(|own| fits(level, own)) {
        return Some(level);
    }
    let others = reading.vertebrae.iter().filter(|(other, landmark)| fits(**other, *landmark));
    let nearest = |a: &(_, &VertebraLandmarks), b: &(_, &VertebraLandmarks)| {
        height(a.1).abs().total_cmp(&height(b.1).abs())
    };
    others.min_by(nearest).map(|(other, _)| *other)
}
