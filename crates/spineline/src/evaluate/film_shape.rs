//! The shape of a spine on one film by a model or a baseline, beside the measured film.

use serde::{Deserialize, Serialize};

use super::statistics::mean;
use crate::anatomy::{Level, Posture};
use crate::measure::{FilmScale, Outline};
use crate::spatial::Frontal;

/// A shape beside the film that it is compared with, in the frame and at the scale of the film's outline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FilmShape {
    /// The posture.
    pub posture: Posture,
    /// The film's scale against the erect film, at which both were compared: from all vertebrae of a fitted film, from T2 of a
    /// predicted one.
    pub scale: FilmScale,
    /// Locations by the model, from L4 (the base) upwards.
    pub locations: Vec<Frontal>,
    /// The vertebrae above the base that the film shows, caudal first: L3…T2 where none is missing.
    pub compared: Vec<Level>,
    /// Distance between the location by the model and the measured one of each of them: E_LOC.
    pub location_errors_mm: Vec<f64>,
}

impl FilmShape {
    /// Locations beside those that a film shows, at the scale of its outline.
    ///
    /// # Panics
    /// If the film shows a vertebra without a location.
    #[must_use]
    pub fn new(locations: Vec<Frontal>, film: &Outline) -> Self {
        let shown = || film.measured().skip(1);
        Self {
            posture: film.posture,
            scale: film.length.scale,
            compared: shown().map(|(_, vertebra)| vertebra.level).collect(),
            location_errors_mm: shown()
                .map(|(i, vertebra)| locations[i].distance_mm(vertebra.location))
                .collect(),
            locations,
        }
    }

    /// Location error of a vertebra; `None` where the film does not show it.
    #[must_use]
    pub fn location_error_mm(&self, level: Level) -> Option<f64> {
        let place = self.compared.iter().position(|&own| own == level)?;
        self.location_errors_mm.get(place).copied()
    }

    /// Mean of the location errors; NaN where the film shows no vertebra above the base.
    #[must_use]
    pub fn mean_location_error_mm(&self) -> f64 {
        mean(self.location_errors_mm.iter().copied()).unwrap_or(f64::NAN)
    }

    /// A shape that was compared at the scale found for it, in the lengths of the film as it was given.
    pub(crate) fn in_lengths_of(self, film: &Outline, found: FilmScale) -> Self {
        let factor = found.factor / film.length.scale.factor;
        Self {
            scale: found,
            locations: self.locations.iter().map(|&location| location * factor).collect(),
            location_errors_mm: self.location_errors_mm.iter().map(|mm| mm * factor).collect(),
            ..self
        }
    }
}
