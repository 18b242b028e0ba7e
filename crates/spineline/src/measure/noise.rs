use std::collections::BTreeMap;

use crate::spatial::Angle;

/// Standard deviation of a film's measured values (means over its readings).
///
/// The uncertainty of a mean over several observers follows from the differences between them, or between their repeats
/// where those differ more. A bias that all observers share does not show in it.
///
/// # Limit
/// It is the variance of one reading over the mean number of readings of a vertebra, alike for all vertebrae of the film. A vertebra with fewer
/// readings than the mean has more noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Of a coordinate of a location.
    pub location_mm: f64,
    /// Of a tilt.
    pub tilt: Angle,
    /// Degrees of freedom of the tilt's variance, where both deviations were measured by how readings differ; `None` for the assumption
    /// for one careful reading.
    pub tilt_degrees_of_freedom: Option<usize>,
}

impl Noise {
    /// Assumed noise of one careful reading: 0.5 mm per corner, so 0.25 mm at their crossing, and 0.7°.
    ///
    /// # References
    /// Tilt: intra-observer deviation of [vrtovec-2015]. Corners: assumption.
    pub const ONE_READING: Self =
        Self { location_mm: 0.25, tilt: Angle::from_deg(0.7), tilt_degrees_of_freedom: None };

    /// Assumed bias of an observer's tilts, which differences between observers show and one reading does not: as large as the
    /// deviation between the readings of one observer.
    pub const OBSERVER_BIAS: Angle = Self::ONE_READING.tilt;

    /// Rounding to a pixel and to 0.1° leaves at least about this noise.
    pub(super) const FLOOR_LOCATION_MM: f64 = 0.03;
    pub(super) const FLOOR_TILT: Angle = Angle::from_deg(0.03);
    /// The same for a corner: the crossing of a body's diagonals has half of its deviation.
    pub(super) const FLOOR_CORNER_MM: f64 = 2.0 * Self::FLOOR_LOCATION_MM;

    /// Standard deviation of a coordinate of a corner: twice the deviation of the crossing of a body's diagonals.
    #[must_use]
    pub const fn corner_mm(&self) -> f64 {
        2.0 * self.location_mm
    }

    /// Whether it was measured by how readings differ; else it is the assumption for one careful reading.
    #[must_use]
    pub const fn is_measured(&self) -> bool {
        self.tilt_degrees_of_freedom.is_some()
    }
}

/// Noise that corners found by a program add to a vertebra, in one reading or in the mean of several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProgramNoise {
    /// Standard deviation of a coordinate of the location by these corners.
    pub location_mm: f64,
    /// Standard deviation of the tilt by them; zero for an axis set by hand.
    pub tilt: Angle,
    /// The part of the vertebra's corners that a person placed, from 0 to 1.
    pub placed_share: f64,
    /// The same for the tilt: 1 where the axis was set by hand.
    pub placed_tilt_share: f64,
    /// Whether a person has looked at all of them.
    pub is_reviewed: bool,
}

impl ProgramNoise {
    /// The noise of the vertebra; corners placed by a person have the film's noise.
    pub(super) fn beside(&self, film: Noise) -> Noise {
        let total =
            |share: f64, placed: f64, own: f64| (share * placed * placed + own * own).sqrt();
        let location_mm = total(self.placed_share, film.location_mm, self.location_mm);
        let tilt = total(self.placed_tilt_share, film.tilt.rad(), self.tilt.rad());
        Noise {
            // Noise is never below pixel rounding.
            location_mm: location_mm.max(Noise::FLOOR_LOCATION_MM),
            tilt: Angle::from_rad(tilt.max(Noise::FLOOR_TILT.rad())),
            tilt_degrees_of_freedom: film.tilt_degrees_of_freedom,
        }
    }

    /// Of a mean over readings, of which some may be placed. The readings share the model that completed them, so that
    /// its part does not become smaller by averaging.
    pub(super) fn of_mean(readings: &[Option<Self>]) -> Option<Self> {
        readings.iter().any(Option::is_some).then(|| {
            let mean = |of: &dyn Fn(&Self) -> f64, placed: f64| {
                let all = readings.iter().map(|one| one.as_ref().map_or(placed, of));
                all.sum::<f64>() / readings.len() as f64
            };
            Self {
                location_mm: mean(&|one| one.location_mm.powi(2), 0.0).sqrt(),
                tilt: Angle::from_rad(mean(&|one| one.tilt.rad().powi(2), 0.0).sqrt()),
                placed_share: mean(&|one| one.placed_share, 1.0),
                placed_tilt_share: mean(&|one| one.placed_tilt_share, 1.0),
                is_reviewed: readings.iter().flatten().all(|one| one.is_reviewed),
            }
        })
    }
}

/// Squares of readings about their means, of all alike and of observers' means, and their degrees of freedom (one-way
/// analysis of variance).
#[derive(Default)]
pub(crate) struct ReadingSquares {
    all: (f64, usize),
    between: (f64, usize),
}

impl ReadingSquares {
    /// Takes in the readings of one value, with their observers.
    pub fn add<'a>(&mut self, readings: impl Iterator<Item = (&'a str, f64)>) {
        let mut by_observer: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        readings.for_each(|(observer, value)| by_observer.entry(observer).or_default().push(value));
        // The order of the readings must not change a bit.
        by_observer.values_mut().for_each(|own| own.sort_by(f64::total_cmp));
        let n: usize = by_observer.values().map(Vec::len).sum();
        if n < 2 {
            return;
        }
        let mean = by_observer.values().flatten().sum::<f64>() / n as f64;
        let squares = by_observer.values().flatten().map(|value| (value - mean).powi(2));
        self.all.0 += squares.sum::<f64>();
        self.all.1 += n - 1;
        let off = |own: &Vec<f64>| own.iter().map(|value| value - mean).sum::<f64>();
        self.between.0 +=
            by_observer.values().map(|own| off(own).powi(2) / own.len() as f64).sum::<f64>();
        self.between.1 += by_observer.len() - 1;
    }

    /// Of one reading, from the differences between observers, or between their repeats where those differ more; `None` where
    /// nothing was read twice.
    ///
    /// Where every observer has the same number of readings, this over the number of readings is the estimate of the variance of the mean by
    /// restricted maximum likelihood, with no component of variance below zero.
    pub fn spread(&self) -> Option<ReadingSpread> {
        let of = |(squares, freedom): (f64, usize)| ReadingSpread {
            variance: squares / freedom.max(1) as f64,
            freedom,
        };
        let (all, between) = (of(self.all), of(self.between));
        let larger = if between.variance > all.variance { between } else { all };
        (larger.freedom > 0).then_some(larger)
    }
}

/// The variance of one reading, as readings show it.
pub(crate) struct ReadingSpread {
    pub variance: f64,
    /// Degrees of freedom of the variance.
    pub freedom: usize,
}
