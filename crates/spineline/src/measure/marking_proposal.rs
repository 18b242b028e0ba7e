//! The next landmark, and its expected place.

use std::collections::BTreeMap;

use super::order::typical_distance_mm;
use super::{Corners, ImageGeometry, PartialReading};
use crate::anatomy::{Level, Morphometry, Side, named};
use crate::spatial::{Angle, Frontal, Pixel};

/// A corner by endplate and by the patient's side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum CornerName {
    SuperiorLeft,
    SuperiorRight,
    InferiorLeft,
    InferiorRight,
}

named!(CornerName);

impl CornerName {
    /// The order of [`Corners::points`] and of files.
    pub const ALL: [Self; 4] =
        [Self::SuperiorLeft, Self::SuperiorRight, Self::InferiorLeft, Self::InferiorRight];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::SuperiorLeft => "superior_left",
            Self::SuperiorRight => "superior_right",
            Self::InferiorLeft => "inferior_left",
            Self::InferiorRight => "inferior_right",
        }
    }

    /// The order of marking: once around the body from the patient's superior left, so that every click is next to the
    /// one before it.
    pub const ORDER: [Self; 4] =
        [Self::SuperiorLeft, Self::SuperiorRight, Self::InferiorRight, Self::InferiorLeft];

    /// This one of four corners.
    #[must_use]
    pub const fn of<P: Copy>(self, corners: &Corners<P>) -> P {
        match self {
            Self::SuperiorLeft => corners.superior_left,
            Self::SuperiorRight => corners.superior_right,
            Self::InferiorRight => corners.inferior_right,
            Self::InferiorLeft => corners.inferior_left,
        }
    }
}

/// What is marked next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NextLandmark {
    /// A corner of a vertebra.
    Corner(Level, CornerName),
    /// The tip of an iliac crest.
    Crest(Side),
}

/// A vertebra where it is to be expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProposedVertebra {
    /// Which one.
    pub level: Level,
    /// Its corners, all on the picture.
    pub corners: Corners<Pixel>,
}

/// Vertebrae next to a gap from which size, distance and bend are taken.
const LOOK_BACK: usize = 3;

impl PartialReading {
    /// The vertebrae in the order of marking: L4 to T2, which the model needs, then T1 and L5.
    #[must_use]
    pub fn order() -> [Level; 17] {
        let mut order = [Level::L5; 17];
        order[..15].copy_from_slice(&Level::MODEL);
        order[15] = Level::T1;
        order
    }

    /// What is marked next: the first missing corner in [`PartialReading::order`] and [`CornerName::ORDER`], then the left
    /// and the right crest. Who marks a crest first goes without T1 and L5, unless they were begun.
    #[must_use]
    pub fn next(&self) -> Option<NextLandmark> {
        let at_crests = self.crests.iter().any(Option::is_some);
        for level in Self::order() {
            let landmark = self.vertebrae.get(&level);
            if landmark.is_none() && at_crests && level.model_index().is_none() {
                continue;
            }
            let missing =
                |name: &CornerName| landmark.is_none_or(|m| name.of(&m.corners).is_none());
            if let Some(corner) = CornerName::ORDER.into_iter().find(missing) {
                return Some(NextLandmark::Corner(level, corner));
            }
        }
        let [left, right] = self.crests;
        let crests = [(Side::Left, left), (Side::Right, right)];
        let open = crests.into_iter().find(|(_, place)| place.is_none());
        open.map(|(side, _)| NextLandmark::Crest(side))
    }

    /// The next vertebra of which no corner is placed, carried on from its nearest neighbours.
    ///
    /// From the nearest sound body on a side, levels are stepped over one by one: the axis turns on as it did over up to
    /// three bodies, the midpoint moves along the mean axis by the typical distance of the two levels, and the body has
    /// the typical size, both in the scale of this spine. That scale is, for distances, that of the steps between the
    /// bodies, and for sizes that of their widths and heights. Between two bodies the ways from both are weighted by
    /// nearness. Corners beyond the edge are drawn to it; where the midpoint is beyond, there is no proposal.
    ///
    /// # References
    /// Typical sizes and distances: [`Morphometry`].
    #[must_use]
    pub fn propose_next(&self, image: &ImageGeometry) -> Option<ProposedVertebra> {
        let NextLandmark::Corner(level, _) = self.next()? else { return None };
        if self
            .vertebrae
            .get(&level)
            .is_some_and(|m| m.corners.points().iter().any(Option::is_some))
        {
            return None;
        }
        let sound = self.sound(image);
        let bodies: BTreeMap<Level, Body> = sound
            .iter()
            .filter_map(|(&level, corners)| Some((level, Body::of(level, corners)?)))
            .collect();
        let below: Vec<&Body> =
            bodies.range(..level).rev().map(|(_, b)| b).take(LOOK_BACK).collect();
        let above: Vec<&Body> = bodies.range(level..).map(|(_, b)| b).take(LOOK_BACK).collect();
        let expected = match (carry_on(&below, level), carry_on(&above, level)) {
            (Some(below), Some(above)) => below.between(&above),
            (one, other) => one.or(other)?,
        };
        if !image.contains(image.pixel(expected.location)) {
            return None;
        }
        let corners = expected.corners(level).map(|corner| on_picture(image, image.pixel(corner)));
        Some(ProposedVertebra { level, corners })
    }
}

/// A body in the film's frontal frame.
#[derive(Debug, Clone, Copy)]
struct Body {
    level: Level,
    location: Frontal,
    tilt: Angle,
    /// Its size over the typical one.
    scale: f64,
}

/// A body without landmarks.
#[derive(Debug, Clone, Copy)]
struct Expected {
    location: Frontal,
    tilt: Angle,
    scale: f64,
    /// Levels from the body that it was carried on from.
    levels: usize,
}

impl Body {
    fn of(level: Level, corners: &Corners<Frontal>) -> Option<Self> {
        let typical = Morphometry::of(level);
        let upper = corners.superior_left.distance_mm(corners.superior_right);
        let lower = corners.inferior_left.distance_mm(corners.inferior_right);
        let parts = [
            upper / typical.superior_width_mm,
            lower / typical.inferior_width_mm,
            corners.height_mm() / typical.body_height_mm,
        ];
        Some(Self {
            level,
            location: corners.measure_location().ok()?,
            tilt: corners.measure_tilt(),
            scale: parts.iter().sum::<f64>() / 3.0,
        })
    }
}

/// Carries bodies on to a level, the nearest body first.
fn carry_on(near: &[&Body], level: Level) -> Option<Expected> {
    let first = near.first()?;
    let scale = near.iter().map(|body| body.scale).sum::<f64>() / near.len() as f64;
    let last = near[near.len() - 1];
    let apart = index(first.level).abs_diff(index(last.level));
    let (turn, longer) = if apart == 0 {
        (Angle::ZERO, scale)
    } else {
        let way: f64 =
            near.windows(2).map(|pair| pair[0].location.distance_mm(pair[1].location)).sum();
        let (low, high) = (first.level.min(last.level), first.level.max(last.level));
        let turn = (first.tilt - last.tilt).wrapped() * (1.0 / apart as f64);
        (turn, way / typical_distance_mm(low, high))
    };
    let upward = level > first.level;
    let sense = if upward { 1.0 } else { -1.0 };
    let (mut location, mut tilt) = (first.location, first.tilt);
    let levels = index(level).abs_diff(index(first.level));
    for step in 0..levels {
        let here = if upward { index(first.level) + step } else { index(first.level) - step - 1 };
        let distance = longer * Morphometry::spacing_mm(Level::ALL[here], Level::ALL[here + 1]);
        location = location + Frontal::leaning(tilt + turn * 0.5) * (sense * distance);
        tilt = tilt + turn;
    }
    Some(Expected { location, tilt, scale, levels })
}

fn index(level: Level) -> usize {
    level as usize
}

impl Expected {
    fn between(&self, other: &Self) -> Self {
        let part = self.levels as f64 / (self.levels + other.levels) as f64;
        let mix = |a: f64, b: f64| a + (b - a) * part;
        Self {
            location: self.location + (other.location - self.location) * part,
            tilt: self.tilt + (other.tilt - self.tilt).wrapped() * part,
            scale: mix(self.scale, other.scale),
            levels: self.levels.min(other.levels),
        }
    }

    /// The diagonals of a trapezium divide its height as its sides.
    fn corners(&self, level: Level) -> Corners<Frontal> {
        let size = Morphometry::of(level);
        let [upper, lower, height] =
            [size.superior_width_mm, size.inferior_width_mm, size.body_height_mm]
                .map(|mm| mm * self.scale);
        let above = height * upper / (upper + lower);
        let below = height - above;
        let corner = |left: f64, up: f64| self.location + Frontal::new(left, up).rotated(self.tilt);
        Corners {
            superior_left: corner(0.5 * upper, above),
            superior_right: corner(-0.5 * upper, above),
            inferior_left: corner(0.5 * lower, -below),
            inferior_right: corner(-0.5 * lower, -below),
        }
    }
}

fn on_picture(image: &ImageGeometry, place: Pixel) -> Pixel {
    let last = |count: u32| f64::from(count.saturating_sub(1));
    Pixel::new(
        place.column_px.clamp(0.0, last(image.columns)),
        place.row_px.clamp(0.0, last(image.rows)),
    )
}
