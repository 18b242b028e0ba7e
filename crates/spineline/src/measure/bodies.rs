//! The marked vertebral bodies of one film, frontal or lateral, for checks of their corners.

use std::collections::BTreeMap;

use super::{Corners, Film, FilmLandmarks, Noise, Reading, ReadingId, ReadingSquares};
use crate::anatomy::{FilmView, Level};
use crate::spatial::Frontal;
use crate::warning::{WarningCode, Warnings};

impl FilmView {
    /// The names of the corners in their order; on a lateral film the anterior ones stand for the left ones of a frontal film.
    pub(super) const fn corners(self) -> [&'static str; 4] {
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
    pub(super) const fn sides(self) -> [&'static str; 2] {
        let walls = match self {
            Self::Frontal(_) => "its left and right sides",
            Self::Lateral => "its anterior and posterior sides",
        };
        [walls, "its superior and inferior sides"]
    }

    /// Warns about a vertebra of this film.
    pub(super) fn warn(
        self,
        code: WarningCode,
        level: Level,
        text: String,
        warnings: &mut Warnings,
    ) {
        match self {
            Self::Frontal(posture) => {
                warnings.vertebra(code, posture, level, text);
            }
            Self::Lateral => {
                warnings.push(code, format!("lateral film, {level}, {text}"));
            }
        }
    }

    pub(super) fn warn_of_film(self, code: WarningCode, text: String, warnings: &mut Warnings) {
        match self {
            Self::Frontal(posture) => {
                warnings.film(code, posture, text);
            }
            Self::Lateral => warnings.push(code, format!("lateral film: {text}")),
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

    /// Of every reading of a frontal film; empty if it has placements.
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

/// Median of values; NaN without one.
#[must_use]
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = |place: usize| values.get(place).copied().unwrap_or(f64::NAN);
    f64::midpoint(at((values.len().max(1) - 1) / 2), at(values.len() / 2))
}

/// The bodies of every vertebra, with their observers, in the order of the readings.
pub(super) fn bodies_of_levels<'a>(
    readings: &'a [ReadBodies<'_>],
) -> BTreeMap<Level, Vec<(&'a str, &'a Corners<Frontal>)>> {
    let mut marked: BTreeMap<Level, Vec<_>> = BTreeMap::new();
    for reading in readings {
        for (level, body) in &reading.bodies {
            marked.entry(*level).or_default().push((reading.id.observer.as_str(), body));
        }
    }
    marked
}

/// Standard deviation of a coordinate of a corner, mean over the readings, from how they differ, in the unit of the bodies; `None` where
/// nothing was read twice.
pub(super) fn corner_sd(readings: &[ReadBodies<'_>]) -> Option<f64> {
    let marked = bodies_of_levels(readings);
    let mut pool = ReadingSquares::default();
    for bodies in marked.values() {
        for corner in 0..4 {
            let places = || bodies.iter().map(|(by, body)| (*by, body.points()[corner]));
            pool.add(places().map(|(by, place)| (by, place.y_mm)));
            pool.add(places().map(|(by, place)| (by, place.z_mm)));
        }
    }
    let readings = marked.values().map(Vec::len).sum::<usize>() as f64 / marked.len() as f64;
    // Rounding to a pixel leaves at least about this noise, and pixels are not smaller than it in mm.
    Some((pool.spread()?.variance / readings).sqrt().max(Noise::FLOOR_CORNER_MM))
}

/// Standard deviations, across and along the axis, of the crossing of a body's diagonals, from a corner's: the error of a
/// diagonal there is the mean error of its ends.
pub(super) fn crossing_sd(corner_sd: f64, width: f64, height: f64) -> [f64; 2] {
    let diagonal = width.hypot(height);
    [diagonal / height, diagonal / width].map(|share| 0.5 * corner_sd * share)
}
