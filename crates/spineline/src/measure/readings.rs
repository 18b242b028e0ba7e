use std::borrow::Cow;

use super::film_checks::{check_placements, check_readings, check_spacing};
use super::placing::place;
use super::tilts::check_tilts;
use super::{
    Film, FilmLandmarks, MeasureError, Placement, Reading, ReadingId, SpacingPlane, TiltRule,
    alike_names, alike_words,
};
use crate::anatomy::{Level, Posture};
use crate::warning::{WarningCode, Warnings};

/// Every reading of one film by itself, for questions about the readers.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmReadings {
    /// Position of the patient.
    pub posture: Posture,
    /// Unit of the lengths.
    pub length_unit: String,
    /// Midpoints and tilts, all in one frame of the film; by observer and repeat, whatever order the film had. Copies count once.
    pub readings: Vec<Reading<Placement>>,
    /// Readings with the landmarks of another one of this film, which count with that one.
    pub copied: Vec<ReadingId>,
}

impl FilmReadings {
    /// Of a film.
    ///
    /// # Errors
    /// As [`measure_readings`].
    pub fn measure(film: &Film, rule: TiltRule) -> Result<Self, MeasureError> {
        let plane = match &film.landmarks {
            FilmLandmarks::Corners { image, .. } => {
                image.spacing.map_or(SpacingPlane::Pixels, |spacing| spacing.plane)
            }
            FilmLandmarks::Placements { spacing_plane, .. } => *spacing_plane,
        };
        // Copies are measured too, so that a fault in one is refused.
        let mut readings = measure_readings(film, rule)?;
        let mut copied = Vec::new();
        if let Cow::Owned(once) = film.with_copies_as_one() {
            readings = measure_readings(&once, rule)?;
            let kept = once.landmarks.reading_ids();
            let all = film.landmarks.reading_ids().into_iter();
            copied = all.filter(|id| !kept.contains(id)).cloned().collect();
        }
        readings.sort_by(|a, b| a.id.cmp(&b.id));
        copied.sort();
        Ok(Self { posture: film.posture, length_unit: plane.unit().to_owned(), readings, copied })
    }

    /// Whether some reading has a vertebra.
    #[must_use]
    pub fn marks(&self, level: Level) -> bool {
        self.readings.iter().any(|reading| reading.vertebrae.contains_key(&level))
    }
}

/// Every reading of one film by itself: midpoints and tilts in the film's own frame, before they are averaged.
///
/// # Errors
/// [`MeasureError`], which names film, reading, vertebra, value and limit. Nothing is repaired.
pub fn measure_readings(
    film: &Film,
    rule: TiltRule,
) -> Result<Vec<Reading<Placement>>, MeasureError> {
    let posture = film.posture;
    match &film.landmarks {
        FilmLandmarks::Corners { image, readings, .. } => {
            check_spacing(posture, image)?;
            check_readings(posture, readings)?;
            readings
                .iter()
                .map(|reading| {
                    let vertebrae = place(posture, image, reading, rule, &mut Vec::new())?;
                    Ok(Reading { id: reading.id.clone(), vertebrae })
                })
                .collect()
        }
        FilmLandmarks::Placements { readings, .. } => {
            check_readings(posture, readings)?;
            check_placements(posture, readings)?;
            check_tilts(posture, readings)?;
            Ok(readings.clone())
        }
    }
}

/// Warns of such names among the observers of all films.
pub(crate) fn warn_of_alike_observers(films: &[FilmReadings], warnings: &mut Warnings) {
    let ids = films.iter().flat_map(|film| &film.readings).map(|reading| &reading.id);
    for names in alike_names(ids.map(|id| id.observer.as_str())) {
        warnings.push(WarningCode::ObserversAlike, alike_words(&names));
    }
}
