//! Axial rotations of a film's vertebrae from their marked pedicles.

use super::axial::PediclePair;
use super::{
    AxialRotation, Film, FilmLandmarks, FilmPlace, MeasureError, MeasureFault, Outline,
    PedicleFault,
};
use crate::anatomy::Level;

/// Axial rotations of all vertebrae of a film on which both pedicles are marked, caudal first: means over readings.
///
/// # Errors
/// [`MeasureFault::Pedicles`] names film, reading, vertebra and fault.
pub(crate) fn axial_rotations(
    film: &Film,
    outline: &Outline,
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
            places.push(pair);
        }
        let marked = places.len();
        let Some(mean) = PediclePair::mean(places) else { continue };
        let Some(vertebra) = outline.vertebra(level) else { continue };
        let per_mm = outline.scale.units_per_mm;
        let corner_sd = outline.noise_of(vertebra).corner_mm() * per_mm;
        found.push(mean.rotation(level, corner_sd, marked));
    }
    Ok(found)
}
