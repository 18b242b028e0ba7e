use std::collections::BTreeMap;

use super::{MeasuredVertebra, Outline, Placement, ProgramNoise, SharedErrors};
use crate::anatomy::Level;
use crate::spatial::Angle;

/// Standard deviation of a film's measured values (means over its readings).
///
/// The uncertainty of a mean over several observers follows from the differences between them, or between their repeats
/// where those differ more. A bias that all observers share does not show in it.
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

    /// Of means, from the standard deviation of the readings of vertebrae whose corners were placed by all: completed corners are alike
    /// in all readings and do not depend on readers.
    pub(super) fn of_means(
        observers: &[&str],
        placed: &[BTreeMap<Level, Placement>],
        means: &BTreeMap<Level, (Placement, usize)>,
    ) -> Self {
        let means: BTreeMap<&Level, &(Placement, usize)> =
            means.iter().filter(|(_, (mean, _))| mean.program.is_none()).collect();
        let [mut location, mut tilt] = [ReadingSquares::default(), ReadingSquares::default()];
        for (level, (mean, _)) in &means {
            let own = || {
                let marked = placed.iter().zip(observers);
                marked.filter_map(|(reading, by)| Some((*by, reading.get(*level)?)))
            };
            location.add(own().map(|(by, place)| (by, place.location.y_mm - mean.location.y_mm)));
            location.add(own().map(|(by, place)| (by, place.location.z_mm - mean.location.z_mm)));
            tilt.add(own().map(|(by, place)| (by, (place.tilt - mean.tilt).wrapped().rad())));
        }
        let Some((of_location, of_tilt)) = location.spread().zip(tilt.spread()) else {
            return Noise::ONE_READING;
        };
        let read: usize = means.values().map(|(_, readings)| readings).sum();
        let readings_per_value = read as f64 / means.len() as f64;
        let [location_mm, tilt] =
            [&of_location, &of_tilt].map(|found| (found.variance / readings_per_value).sqrt());
        Noise {
            location_mm: location_mm.max(Noise::FLOOR_LOCATION_MM),
            tilt: Angle::from_rad(tilt.max(Noise::FLOOR_TILT.rad())),
            tilt_degrees_of_freedom: Some(of_tilt.freedom),
        }
    }
}

/// The noise of all vertebrae of a film, to be held while its landmarks move.
#[derive(Debug, Clone)]
pub(crate) struct OutlineNoise {
    /// Of landmarks alone.
    pub film: Noise,
    program: BTreeMap<Level, ProgramNoise>,
    shared: Option<SharedErrors>,
}

impl OutlineNoise {
    pub fn of(outline: &Outline) -> Self {
        let own = outline.vertebrae.iter().filter_map(|v| Some((v.level, v.program?)));
        let shared = outline.shared_errors.clone();
        Self { film: outline.noise, program: own.collect(), shared }
    }

    pub fn give_to(&self, outline: &mut Outline) {
        outline.noise = self.film;
        for vertebra in &mut outline.vertebrae {
            vertebra.program = self.program.get(&vertebra.level).copied();
        }
        outline.shared_errors.clone_from(&self.shared);
    }
}

impl Outline {
    /// Root mean square of the noise of some vertebrae; exactly the film's where a person placed all their corners.
    pub(crate) fn noise_over<'a>(
        &self,
        vertebrae: impl IntoIterator<Item = &'a MeasuredVertebra>,
    ) -> Noise {
        let all: Vec<&MeasuredVertebra> = vertebrae.into_iter().collect();
        if all.iter().all(|vertebra| vertebra.program.is_none()) {
            return self.noise;
        }
        let mean = |of: &dyn Fn(Noise) -> f64| {
            let squares = all.iter().map(|vertebra| of(self.noise_of(vertebra)).powi(2));
            (squares.sum::<f64>() / all.len() as f64).sqrt()
        };
        Noise {
            location_mm: mean(&|noise| noise.location_mm),
            tilt: Angle::from_rad(mean(&|noise| noise.tilt.rad())),
            tilt_degrees_of_freedom: self.noise.tilt_degrees_of_freedom,
        }
    }

    /// Noise of its base and top.
    pub(crate) fn noise_of_ends(&self) -> Noise {
        self.noise_over(self.vertebrae.first().into_iter().chain(self.vertebrae.last()))
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
