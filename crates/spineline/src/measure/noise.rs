use std::collections::BTreeMap;

use super::Placement;
use super::outline::mean_placement;
use crate::anatomy::Level;
use crate::spatial::Angle;

/// Standard deviation of a film's measured values (means over its readings).
///
/// Means over several observers are as unsure as these differ, or their repeats where those differ more. A bias that all observers
/// share does not show in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Of a coordinate of a location.
    pub location_mm: f64,
    /// Of a tilt.
    pub tilt: Angle,
    /// Whether it was measured from the spread of readings; else it is the assumption for one careful reading.
    pub measured: bool,
}

impl Noise {
    /// What one careful reading is taken to have: 0.5 mm per corner, so 0.25 mm at their crossing, and 0.7°.
    ///
    /// # References
    /// Tilt: intra-observer deviation of [vrtovec-2015]. Corners: assumption.
    pub const ONE_READING: Self =
        Self { location_mm: 0.25, tilt: Angle::from_deg(0.7), measured: false };

    /// Rounding to a pixel and to 0.1° leaves at least about so much.
    const FLOOR_LOCATION_MM: f64 = 0.03;
    const FLOOR_TILT: Angle = Angle::from_deg(0.03);

    /// Of means, from the spread of the readings: of observers about their mean and, where that is more, of all readings alike
    /// (one-way analysis of variance, with no component below zero).
    pub(super) fn of_means(
        observers: &[&str],
        placed: &[BTreeMap<Level, Placement>],
        means: &BTreeMap<Level, (Placement, usize)>,
    ) -> Self {
        let mut all = Squares::default();
        let mut between = Squares::default();
        for (&level, &(mean, _)) in means {
            let mut by_observer: BTreeMap<&str, Vec<Placement>> = BTreeMap::new();
            for (reading, observer) in placed.iter().zip(observers) {
                if let Some(placement) = reading.get(&level) {
                    by_observer.entry(*observer).or_default().push(*placement);
                }
            }
            all.add(by_observer.values().flatten().map(|placement| (*placement, 1.0)), mean);
            between
                .add(by_observer.values().map(|own| (mean_placement(own), own.len() as f64)), mean);
        }
        if all.freedom == 0 {
            return Noise::ONE_READING;
        }
        let readings_per_value = (all.freedom + means.len()) as f64 / means.len() as f64;
        let [location, tilt] = [0, 1].map(|i| {
            let [all, between] = [&all, &between].map(|squares| squares.mean(i));
            (all.max(between) / readings_per_value).sqrt()
        });
        Noise {
            location_mm: location.max(Noise::FLOOR_LOCATION_MM),
            tilt: Angle::from_rad(tilt.max(Noise::FLOOR_TILT.rad())),
            measured: true,
        }
    }
}

/// Sums of squares about means: of a coordinate of the location, and of the tilt.
#[derive(Default)]
struct Squares {
    sums: [f64; 2],
    freedom: usize,
}

impl Squares {
    fn add(&mut self, values: impl Iterator<Item = (Placement, f64)>, mean: Placement) {
        let mut squares: Vec<[f64; 2]> = values
            .map(|(placement, weight)| {
                let off = placement.location - mean.location;
                let turn = (placement.tilt - mean.tilt).wrapped().rad();
                // Two coordinates share the squared distance.
                [weight * 0.5 * off.dot(off), weight * turn * turn]
            })
            .collect();
        self.freedom += squares.len().saturating_sub(1);
        // The order of the readings must not change a bit.
        squares.sort_by(|a, b| a.partial_cmp(b).expect("readings were checked to be finite"));
        for square in squares {
            self.sums[0] += square[0];
            self.sums[1] += square[1];
        }
    }

    fn mean(&self, i: usize) -> f64 {
        if self.freedom == 0 { 0.0 } else { self.sums[i] / self.freedom as f64 }
    }
}
