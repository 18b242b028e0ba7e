//! The shape of a spine on one film by a model or a baseline, beside the measured film.

use serde::{Deserialize, Serialize};

use crate::anatomy::{Level, Posture};
use crate::measure::{FilmLength, FilmScale, Outline};
use crate::number::mean;
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
        Self::beside(film.posture, film.length.scale, locations, ShownVertebra::all_of(film))
    }

    /// As [`Self::new`], beside the vertebrae above the base.
    pub(super) fn beside(
        posture: Posture,
        scale: FilmScale,
        locations: Vec<Frontal>,
        shown: impl Iterator<Item = ShownVertebra>,
    ) -> Self {
        let error = |ShownVertebra { place, level, location }| {
            (level, locations[usize::from(place)].distance_mm(location))
        };
        let (compared, location_errors_mm) = shown.map(error).unzip();
        Self { posture, scale, locations, compared, location_errors_mm }
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
    pub(crate) fn in_lengths_of(self, film: &FilmLength, found: FilmScale) -> Self {
        let factor = found.factor / film.scale.factor;
        Self {
            scale: found,
            locations: self.locations.iter().map(|&location| location * factor).collect(),
            location_errors_mm: self.location_errors_mm.iter().map(|mm| mm * factor).collect(),
            ..self
        }
    }
}

/// A vertebra above the base that a film shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ShownVertebra {
    /// Its place in the chain.
    pub place: u8,
    pub level: Level,
    /// On the outline of the film.
    pub location: Frontal,
}

impl ShownVertebra {
    /// All of a film, caudal first.
    pub fn all_of(film: &Outline) -> impl Iterator<Item = Self> {
        film.measured().skip(1).map(|(i, vertebra)| Self {
            place: i as u8,
            level: vertebra.level,
            location: vertebra.location,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locations_and_errors_follow_the_found_scale() {
        let shape = FilmShape {
            posture: Posture::Erect,
            scale: FilmScale::ONE,
            locations: vec![Frontal::default(), Frontal::new(3.0, 40.0)],
            compared: vec![Level::L3],
            location_errors_mm: vec![2.0],
        };
        let scale = |factor| FilmScale { factor, log_sd: 0.01 };
        let film = FilmLength { scale: scale(0.5), ..FilmLength::ERECT };
        let expected = FilmShape {
            scale: scale(0.75),
            locations: vec![Frontal::default(), Frontal::new(4.5, 60.0)],
            location_errors_mm: vec![3.0],
            ..shape.clone()
        };
        assert_eq!(shape.in_lengths_of(&film, scale(0.75)), expected);
    }
}
