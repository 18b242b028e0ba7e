//! The patients that a command has read: none counts twice.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use spineline::analysis::Case;
use spineline::anatomy::Posture;
use spineline::measure::{Film, FilmLandmarks, Reading};

use crate::run::failure::Failure;

/// Identifiers by their lower-case form, and by the landmarks.
#[derive(Default)]
pub struct KnownPatients {
    by_id: BTreeMap<String, String>,
    by_landmarks: BTreeMap<u64, String>,
}

impl KnownPatients {
    /// Adds the patient of a case.
    ///
    /// # Errors
    /// If the identifier was read before, in any case of its letters, or the same landmarks under another identifier: the patient would
    /// count twice.
    pub fn add(&mut self, place: &str, case: &Case) -> Result<(), Failure> {
        if let Some(earlier) = self.by_id.insert(case.id.to_lowercase(), case.id.clone()) {
            let text = if earlier == case.id {
                format!("the case {earlier} was given already")
            } else {
                format!("the case {} was given already as {earlier}", case.id)
            };
            return Err(Failure::input(place, text, "give every case its own `case_id`"));
        }
        let readings: Vec<u64> = case.films.iter().flat_map(readings_of).collect();
        // The order of films and readings has no meaning.
        let landmarks = readings.iter().fold(0, |sum: u64, one| sum.wrapping_add(*one));
        let earlier = self.by_landmarks.insert(landmarks, case.id.clone());
        if let Some(earlier) = earlier.filter(|_| !readings.is_empty()) {
            let text = format!("the case {} has the films of the case {earlier}", case.id);
            let help = "a patient counts once: leave one of the two files out";
            return Err(Failure::input(place, text, help));
        }
        Ok(())
    }
}

/// A hash of the landmarks of every reading of a film.
fn readings_of(film: &Film) -> Vec<u64> {
    match &film.landmarks {
        FilmLandmarks::Corners { readings, .. } => hashes(film.posture, readings, |landmark| {
            let places = landmark.corners.points();
            places.iter().flat_map(|place| [place.column_px, place.row_px]).collect()
        }),
        FilmLandmarks::Placements { readings, .. } => hashes(film.posture, readings, |placed| {
            vec![placed.location.y_mm, placed.location.z_mm]
        }),
    }
}

fn hashes<T>(
    posture: Posture,
    readings: &[Reading<T>],
    numbers: impl Fn(&T) -> Vec<f64>,
) -> Vec<u64> {
    let hash = |reading: &Reading<T>| {
        let mut hasher = DefaultHasher::new();
        posture.hash(&mut hasher);
        for (level, mark) in &reading.vertebrae {
            level.hash(&mut hasher);
            numbers(mark).iter().for_each(|number| number.to_bits().hash(&mut hasher));
        }
        hasher.finish()
    };
    readings.iter().map(hash).collect()
}
