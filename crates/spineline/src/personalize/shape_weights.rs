//! Weights of locations and tilts in the fit of a whole shape, for every fit of one.

use crate::measure::Noise;
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
