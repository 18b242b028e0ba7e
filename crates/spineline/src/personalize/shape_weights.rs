//! Weights of locations and tilts in the fit of a whole shape, for every fit of one.

use crate::measure::{MeasuredVertebra, Noise, Outline};
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

    /// Of one vertebra: where the erect film does not show it, or a program found its corners there, the model's own place of
    /// it is less certain.
    pub fn with_model(self, uncertain: Option<&Noise>) -> Self {
        let Some(found) = uncertain else { return self };
        Self {
            location_sd_mm: self.location_sd_mm.hypot(found.location_mm),
            tilt_sd_rad: self.tilt_sd_rad.hypot(found.tilt.rad()),
        }
    }

    /// The vertebrae above the base that a film shows, by their place, and the weights of each; those that it does not show
    /// take no part in a fit. With the erect film, the weights are those of the difference from it.
    pub fn of_vertebrae(
        film: &Outline,
        erect: Option<&Outline>,
        model: &SpineModel,
    ) -> Vec<(usize, Self)> {
        let weights = |(i, vertebra): (usize, &MeasuredVertebra)| {
            let own = film.noise_of(vertebra);
            let weights = match erect {
                None => Self::of_film(&own),
                Some(erect) => Self::of_difference(&own, &erect.noise),
            };
            (i, weights.with_model(model.uncertain[i].as_ref()))
        };
        film.measured().filter(|(i, _)| *i > 0).map(weights).collect()
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
