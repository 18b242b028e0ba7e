//! Marks on a film as rows of linear equations for the corners.

use nalgebra::{DMatrix, DVector};

use super::error::CompletionError;
use super::shape::{LEVELS, PARAMETERS, coordinate};
use crate::anatomy::{Level, Side};
use crate::measure::{CornerName, ImageGeometry, Reading, VertebraLandmarks};
use crate::spatial::{Frontal, Pixel};

/// What a click marks on a vertebra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    /// A corner.
    Corner(CornerName),
    /// The midpoint of the wall on a side of the patient.
    Wall(Side),
    /// The midpoint of the superior endplate.
    SuperiorEndplate,
    /// The midpoint of the inferior endplate.
    InferiorEndplate,
    /// The mean of the four corners.
    Centre,
}

impl Mark {
    /// The corners of which it is the mean.
    #[must_use]
    pub const fn corners(self) -> &'static [CornerName] {
        use CornerName::{InferiorLeft, InferiorRight, SuperiorLeft, SuperiorRight};
        match self {
            Self::Corner(SuperiorLeft) => &[SuperiorLeft],
            Self::Corner(SuperiorRight) => &[SuperiorRight],
            Self::Corner(InferiorLeft) => &[InferiorLeft],
            Self::Corner(InferiorRight) => &[InferiorRight],
            Self::Wall(Side::Left) => &[SuperiorLeft, InferiorLeft],
            Self::Wall(Side::Right) => &[SuperiorRight, InferiorRight],
            Self::SuperiorEndplate => &[SuperiorLeft, SuperiorRight],
            Self::InferiorEndplate => &[InferiorLeft, InferiorRight],
            Self::Centre => &CornerName::ALL,
        }
    }
}

/// A click on a vertebra.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Click {
    /// Which vertebra.
    pub level: Level,
    /// What it marks there.
    pub mark: Mark,
    /// Where.
    pub place: Pixel,
}

impl Click {
    /// Clicks on one vertebra: the corners that were placed, or the walls where no corner was placed.
    #[must_use]
    pub fn on(
        level: Level,
        placed: [Option<(CornerName, Pixel)>; 4],
        walls: [Option<Pixel>; 2],
    ) -> Vec<Self> {
        let corners = placed.into_iter().flatten();
        let clicks: Vec<Self> =
            corners.map(|(name, place)| Self { level, mark: Mark::Corner(name), place }).collect();
        if !clicks.is_empty() {
            return clicks;
        }
        let walls = [Side::Left, Side::Right].into_iter().zip(walls);
        let wall = |(side, place): (Side, Option<Pixel>)| {
            Some(Self { level, mark: Mark::Wall(side), place: place? })
        };
        walls.filter_map(wall).collect()
    }
}

/// All clicks on a film.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Clicks {
    /// Clicks on vertebrae, in any order.
    pub vertebrae: Vec<Click>,
    /// Points on the line through the centres of the vertebrae, in any order; their vertebrae are not known.
    pub midline: Vec<Pixel>,
}

impl Clicks {
    /// The landmarks that a person placed in these readings: corners, and the walls of vertebrae without one.
    #[must_use]
    pub fn of_readings(readings: &[Reading<VertebraLandmarks>]) -> Self {
        let of = |(&level, landmark): (&Level, &VertebraLandmarks)| {
            let placed = CornerName::ALL.map(|name| {
                let place = name.of(&landmark.corners);
                name.of(&landmark.origins).is_placed().then_some((name, place))
            });
            Click::on(level, placed, landmark.walls)
        };
        let vertebrae = readings.iter().flat_map(|reading| &reading.vertebrae).flat_map(of);
        Self { vertebrae: vertebrae.collect(), midline: Vec::new() }
    }
}

/// Equations `matrix · corners = values` of clicks, in millimetres about a place.
pub(super) struct Equations {
    pub matrix: DMatrix<f64>,
    pub values: DVector<f64>,
}

/// Clicks in the film's frontal frame about the mean of those on vertebrae.
pub(super) struct PlacedClicks {
    pub about: Frontal,
    vertebrae: Vec<(Level, Mark, Frontal)>,
    midline: Vec<Frontal>,
}

impl PlacedClicks {
    /// # Errors
    /// [`CompletionError`] for clicks that are not finite, or do not lie apart.
    pub fn new(image: &ImageGeometry, clicks: &Clicks) -> Result<Self, CompletionError> {
        let bad = clicks.vertebrae.iter().find(|click| !click.place.is_finite());
        if let Some(&Click { level, .. }) = bad {
            return Err(CompletionError::NotFinite { level });
        }
        let places = clicks.vertebrae.iter().map(|click| image.frontal(click.place));
        let count = clicks.vertebrae.len().max(1) as f64;
        let about = places.fold(Frontal::default(), |sum, place| sum + place) * (1.0 / count);
        let vertebrae = clicks
            .vertebrae
            .iter()
            .map(|click| (click.level, click.mark, image.frontal(click.place) - about));
        let vertebrae: Vec<_> = vertebrae.collect();
        let is_apart = |&(.., place): &(Level, Mark, Frontal)| place.norm_mm() > 1e-9;
        if vertebrae.len() < 2 || !vertebrae.iter().any(is_apart) {
            return Err(CompletionError::TooFew { clicks: vertebrae.len() });
        }
        let midline = clicks.midline.iter().map(|&place| image.frontal(place) - about);
        Ok(Self { about, vertebrae, midline: midline.collect() })
    }

    /// Equations of the clicks on vertebrae alone.
    pub fn of_vertebrae(&self) -> Equations {
        let rows = 2 * self.vertebrae.len();
        let (mut matrix, mut values) = (DMatrix::zeros(rows, PARAMETERS), DVector::zeros(rows));
        for (index, &(level, mark, place)) in self.vertebrae.iter().enumerate() {
            let row = 2 * index;
            (values[row], values[row + 1]) = (place.y_mm, place.z_mm);
            let corners = mark.corners();
            for &corner in corners {
                let column = coordinate(level, corner);
                let part = 1.0 / corners.len() as f64;
                (matrix[(row, column)], matrix[(row + 1, column + 1)]) = (part, part);
            }
        }
        Equations { matrix, values }
    }

    /// Equations of all clicks; a point of the midline lies on the nearest of the lines between the centres given.
    pub fn equations(&self, centres: &[Frontal; LEVELS]) -> Equations {
        let Equations { mut matrix, mut values } = self.of_vertebrae();
        for &point in &self.midline {
            let Some((level, part, normal)) = nearest_step(centres, point) else { continue };
            let row = values.nrows();
            matrix = matrix.insert_row(row, 0.0);
            values = values.insert_row(row, point.dot(normal));
            for (level, weight) in [(level, 1.0 - part), (level + 1, part)] {
                for corner in CornerName::ALL {
                    let column = coordinate(Level::ALL[level], corner);
                    matrix[(row, column)] = 0.25 * weight * normal.y_mm;
                    matrix[(row, column + 1)] = 0.25 * weight * normal.z_mm;
                }
            }
        }
        Equations { matrix, values }
    }
}

/// The step between neighbouring centres that lies nearest to a point, which part of it the point is beside, and its normal.
fn nearest_step(centres: &[Frontal; LEVELS], point: Frontal) -> Option<(usize, f64, Frontal)> {
    let steps = centres.windows(2).enumerate().filter_map(|(level, pair)| {
        let step = pair[1] - pair[0];
        let length = step.norm_mm();
        let part = ((point - pair[0]).dot(step) / (length * length)).clamp(0.0, 1.0);
        let normal = Frontal::new(-step.z_mm, step.y_mm) * (1.0 / length);
        let distance = point.distance_mm(pair[0] + step * part);
        distance.is_finite().then_some((distance, (level, part, normal)))
    });
    steps.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, step)| step)
}
