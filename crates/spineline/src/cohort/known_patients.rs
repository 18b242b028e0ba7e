//! The patients of a cohort. Each patient counts once.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use crate::analysis::Case;
use crate::anatomy::Posture;
use crate::fault::faults;
use crate::measure::{Film, FilmLandmarks, Reading};

/// Identifies a patient: the identifier, in any case of its letters, and the landmarks of every reading of the frontal films.
#[derive(Debug, Clone)]
pub struct PatientMarks {
    id: String,
    readings: Vec<(Posture, u64)>,
}

faults! {
    /// A patient who would count twice.
    #[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
    pub enum SamePatient {
        /// The identifier was given before.
        #[error("the case {id} was given already{}", as_other(id, earlier))]
        #[help("give every case its own `case_id`")]
        Identifier {
            id: String,
            /// The earlier one, which may differ in the case of its letters.
            earlier: String,
        },
        /// A reading was given before, under another identifier.
        #[error(
            "the {posture} film of the case {id} has the landmarks of a film of the case {earlier}"
        )]
        #[help("a patient counts once: leave one of the two files out")]
        Reading {
            posture: Posture,
            id: String,
            /// The earlier one.
            earlier: String,
        },
    }
}

fn as_other(id: &str, earlier: &str) -> String {
    if id == earlier { String::new() } else { format!(" as {earlier}") }
}

/// The patients so far, each by its place among their identifiers.
#[derive(Debug, Default)]
pub struct KnownPatients {
    ids: Vec<String>,
    by_id: BTreeMap<String, usize>,
    by_reading: BTreeMap<u64, usize>,
}

impl KnownPatients {
    /// Adds a patient.
    ///
    /// # Errors
    /// If the patient was added before.
    pub fn add(&mut self, patient: PatientMarks) -> Result<(), SamePatient> {
        let PatientMarks { id, readings } = patient;
        let key = id.to_lowercase();
        if let Some(&earlier) = self.by_id.get(&key) {
            return Err(SamePatient::Identifier { id, earlier: self.ids[earlier].clone() });
        }
        let earlier = |(posture, reading): &(Posture, u64)| {
            Some((*posture, self.ids[*self.by_reading.get(reading)?].clone()))
        };
        if let Some((posture, earlier)) = readings.iter().find_map(earlier) {
            return Err(SamePatient::Reading { posture, id, earlier });
        }
        let place = self.ids.len();
        self.by_reading.extend(readings.into_iter().map(|(_, reading)| (reading, place)));
        self.by_id.insert(key, place);
        self.ids.push(id);
        Ok(())
    }
}

impl PatientMarks {
    /// Of a case whose identifier alone can be read.
    #[must_use]
    pub const fn of_id(id: String) -> Self {
        Self { id, readings: Vec::new() }
    }

    /// Of a case.
    #[must_use]
    pub fn of(case: &Case) -> Self {
        let of_film = |film: &Film| {
            let posture = film.posture;
            readings_of(film).into_iter().map(move |reading| (posture, reading))
        };
        Self { id: case.id.clone(), readings: case.films.iter().flat_map(of_film).collect() }
    }
}

/// A hash of the landmarks of every reading of a film, whatever its posture.
fn readings_of(film: &Film) -> Vec<u64> {
    match &film.landmarks {
        FilmLandmarks::Corners { readings, .. } => hashes(readings, |landmark| {
            let places = landmark.corners.points();
            places.iter().flat_map(|place| [place.column_px, place.row_px]).collect()
        }),
        FilmLandmarks::Placements { readings, .. } => {
            hashes(readings, |placed| vec![placed.location.y_mm, placed.location.z_mm])
        }
    }
}

/// A reading of fewer than two vertebrae may be like another one by chance.
fn hashes<T>(readings: &[Reading<T>], numbers: impl Fn(&T) -> Vec<f64>) -> Vec<u64> {
    let hash = |reading: &Reading<T>| {
        let mut hasher = DefaultHasher::new();
        for (level, mark) in &reading.vertebrae {
            level.hash(&mut hasher);
            numbers(mark).iter().for_each(|number| number.to_bits().hash(&mut hasher));
        }
        hasher.finish()
    };
    readings.iter().filter(|reading| reading.vertebrae.len() > 1).map(hash).collect()
}
