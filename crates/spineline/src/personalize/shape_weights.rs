//! Weights of locations and tilts in the fit of a whole shape, for every fit of one.

use crate::measure::{Interpolation, Noise, Outline};
use crate::multibody::SpineModel;
use crate::spatial::{Angle, Frontal};

/// Residuals of one vertebra per film: both coordinates of its location, and its tilt.
pub(crate) const ROWS_PER_VERTEBRA: usize = 3;

/// Standard deviations by which residuals of locations and tilts are divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShapeWeights {
    pub location_sd_mm: f64,
    pub tilt_sd_rad: f64,
}

impl ShapeWeights {
    /// The noise of the film alone.
    pub fn of_film(noise: &Noise) -> Self {
        Self { location_sd_mm: noise.location_mm, tilt_sd_rad: noise.tilt.rad() }
    }

    /// The noise of the difference between a film and the erect film, from which the model is made.
    pub fn of_difference(film: &Noise, erect: &Noise) -> Self {
        Self {
            location_sd_mm: film.location_mm.hypot(erect.location_mm),
            tilt_sd_rad: film.tilt.rad().hypot(erect.tilt.rad()),
        }
    }

    /// Of one vertebra: where the erect film does not show it, the model's own place of it is less certain.
    pub fn with_model(self, interpolated: Option<&Interpolation>) -> Self {
        let Some(found) = interpolated else { return self };
        Self {
            location_sd_mm: self.location_sd_mm.hypot(found.location_sd_mm),
            tilt_sd_rad: self.tilt_sd_rad.hypot(found.tilt_sd.rad()),
        }
    }

    /// The vertebrae above the base that a film shows, by their place, and the weights of each; those that it does not show
    /// take no part in a fit.
    pub fn of_vertebrae(self, film: &Outline, model: &SpineModel) -> Vec<(usize, Self)> {
        let above_base = film.measured().filter(|(i, _)| *i > 0);
        above_base.map(|(i, _)| (i, self.with_model(model.interpolated[i].as_ref()))).collect()
    }

    /// Residuals of a vertebra that lies so far off and is turned by so much.
    pub fn residuals(&self, off: Frontal, turn: Angle) -> [f64; ROWS_PER_VERTEBRA] {
        let sd_mm = self.location_sd_mm;
        [off.y_mm / sd_mm, off.z_mm / sd_mm, turn.wrapped().rad() / self.tilt_sd_rad]
    }

    /// Their derivatives, from those of location and tilt.
    pub fn derivatives(&self, location: Frontal, tilt: f64) -> [f64; ROWS_PER_VERTEBRA] {
        let per_mm = 1.0 / self.location_sd_mm;
        [location.y_mm * per_mm, location.z_mm * per_mm, tilt / self.tilt_sd_rad]
    }
}
