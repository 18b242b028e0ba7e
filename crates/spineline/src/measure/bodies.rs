//! The marked vertebral bodies of one film, frontal or lateral, for checks of their corners.

use super::{Corners, Film, FilmLandmarks, Reading, ReadingId};
use crate::anatomy::{Level, Posture};
use crate::spatial::Frontal;
use crate::warning::{Step, Warnings};

/// Which film is checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum CheckedFilm {
    Frontal(Posture),
    /// Its anterior corners are where those of a frontal film are left.
    Lateral,
}

impl CheckedFilm {
    /// The names of the corners in their order.
    pub const fn corners(self) -> [&'static str; 4] {
        match self {
            Self::Frontal(_) => {
                ["superior left", "superior right", "inferior left", "inferior right"]
            }
            Self::Lateral => [
                "superior anterior",
                "superior posterior",
                "inferior anterior",
                "inferior posterior",
            ],
        }
    }

    /// The names of the pairs of opposite sides: the walls, and the endplates.
    pub const fn sides(self) -> [&'static str; 2] {
        let walls = match self {
            Self::Frontal(_) => "its left and right sides",
            Self::Lateral => "its anterior and posterior sides",
        };
        [walls, "its superior and inferior sides"]
    }

    /// Warns about a vertebra of this film.
    pub fn warn(self, code: &'static str, level: Level, text: String, warnings: &mut Warnings) {
        match self {
            Self::Frontal(posture) => {
                warnings.vertebra(Step::Measure, code, posture, level, text);
            }
            Self::Lateral => {
                warnings.push(Step::Measure, code, format!("lateral film, {level}, {text}"));
            }
        }
    }
}

/// The bodies of one reading, caudal first.
pub(super) struct ReadBodies<'a> {
    pub id: &'a ReadingId,
    pub bodies: Vec<(Level, Corners<Frontal>)>,
}

impl<'a> ReadBodies<'a> {
    /// Of a reading of any landmarks.
    pub fn of<T>(reading: &'a Reading<T>, corners: impl Fn(&T) -> Corners<Frontal>) -> Self {
        let bodies = reading.vertebrae.iter().map(|(&level, landmark)| (level, corners(landmark)));
        Self { id: &reading.id, bodies: bodies.collect() }
    }

    /// Of every reading of a frontal film; none where it has placements.
    pub fn of_film(film: &'a Film) -> Vec<Self> {
        let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else {
            return Vec::new();
        };
        let readings = readings.iter();
        readings
            .map(|one| Self::of(one, |mark| mark.corners.map(|corner| image.frontal(corner))))
            .collect()
    }

    /// The body of one vertebra.
    pub fn body(&self, level: Level) -> Option<&Corners<Frontal>> {
        self.bodies.iter().find(|(of, _)| *of == level).map(|(_, body)| body)
    }
}

/// Median of at least one value, all finite.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}
