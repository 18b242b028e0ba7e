//! Weights of locations and tilts in the fit of a whole shape, for every fit of one.

use crate::measure::{ErrorRate, Measured, MeasuredVertebra, Noise, Outline, Whitening};
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
    /// The noise of the difference between a film and the erect film, from which the model is made.
    pub fn of_difference(film: &Noise, erect: &Noise) -> Self {
        Self {
            location_sd_mm: film.location_mm.hypot(erect.location_mm),
            tilt_sd_rad: film.tilt.rad().hypot(erect.tilt.rad()),
        }
    }

    /// Of one vertebra: where the erect film does not show it, or a program found its corners there, its place in the model
    /// is less certain.
    pub fn with_model(self, uncertain: Option<&Noise>) -> Self {
        let Some(found) = uncertain else { return self };
        Self {
            location_sd_mm: self.location_sd_mm.hypot(found.location_mm),
            tilt_sd_rad: self.tilt_sd_rad.hypot(found.tilt.rad()),
        }
    }

    /// Residuals of a vertebra with these errors of location and tilt.
    pub fn residuals(&self, off: Frontal, turn: Angle) -> [f64; ROWS_PER_VERTEBRA] {
        let sd_mm = self.location_sd_mm;
        [off.y_mm / sd_mm, off.z_mm / sd_mm, turn.wrapped().rad() / self.tilt_sd_rad]
    }

    /// Their derivatives, from the derivatives of location and tilt.
    pub fn derivatives(&self, location: Frontal, tilt: f64) -> [f64; ROWS_PER_VERTEBRA] {
        let per_mm = 1.0 / self.location_sd_mm;
        [location.y_mm * per_mm, location.z_mm * per_mm, tilt / self.tilt_sd_rad]
    }
}

/// The vertebrae above the base that a film shows, and how their residuals are weighted; those that it does not show take no part
/// in a fit.
#[derive(Debug, Clone)]
pub(crate) struct ShapeRows {
    /// By their place, with the standard deviations that their residuals are divided by.
    pub vertebrae: Vec<(usize, ShapeWeights)>,
    /// Where vertebrae share errors: makes the divided residuals independent.
    whitening: Option<Whitening>,
}

impl ShapeRows {
    /// Weights are for the difference from the erect film.
    pub fn new(film: &Outline, erect: &Outline, model: &SpineModel) -> Self {
        let weights = |(i, vertebra): (usize, &MeasuredVertebra)| {
            let weights = ShapeWeights::of_difference(&film.noise_of(vertebra), &erect.noise);
            (i, weights.with_model(model.uncertain[i].as_ref()))
        };
        let vertebrae: Vec<(usize, ShapeWeights)> =
            film.measured().filter(|(i, _)| *i > 0).map(weights).collect();
        let whitening = film.difference_covariance(erect, model.shared_errors.as_ref());
        let whitening = whitening.and_then(|all| Whitening::of(&all, &error_rates(&vertebrae)));
        Self { vertebrae, whitening }
    }

    /// Rows of the film in a system.
    pub fn count(&self) -> usize {
        ROWS_PER_VERTEBRA * self.vertebrae.len()
    }

    /// Makes the divided residuals from a row of a system on independent, or their derivatives by one unknown.
    pub fn whiten(&self, rows: &mut [f64]) {
        if let Some(whitening) = &self.whitening {
            whitening.apply(rows);
        }
    }
}

fn error_rates(vertebrae: &[(usize, ShapeWeights)]) -> Vec<ErrorRate> {
    let of_vertebra = |(place, weights): &(usize, ShapeWeights)| {
        let (per_mm, per_rad) = (1.0 / weights.location_sd_mm, 1.0 / weights.tilt_sd_rad);
        let (left, cranial) = (Measured::Left, Measured::Cranial);
        [(*place, left, per_mm), (*place, cranial, per_mm), (*place, Measured::Tilt, per_rad)]
    };
    vertebrae.iter().flat_map(of_vertebra).collect()
}
