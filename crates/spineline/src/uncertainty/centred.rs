use serde::{Deserialize, Serialize};

use super::distribution::Distribution;
use crate::spatial::Angle;

/// Moments and quantiles, in the unit of the quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Standard deviation; `None` of a single value.
    pub sd: Option<f64>,
    /// The 2.5, 25, 50, 75 and 97.5 % quantiles.
    pub quantiles: [f64; 5],
}

impl Spread {
    /// The parts at which quantiles are taken.
    pub const PARTS: [f64; 5] = [0.025, 0.25, 0.5, 0.75, 0.975];
    /// Fewest replicates with a 95 % interval: of fewer than 40 replicates, 2.5 % are less than one replicate, so the ends rest on
    /// the two outermost values.
    pub const MIN_COUNT: u64 = 40;

    /// The central 95 % of this many replicates, if they are enough.
    pub(super) fn interval_95(&self, count: u64) -> Option<[f64; 2]> {
        (count >= Self::MIN_COUNT).then(|| [self.quantiles[0], self.quantiles[4]])
    }
}

/// Values of one number over replicates, taken as differences from a reference, angles the short way round.
#[derive(Debug, Clone)]
pub(super) struct Centred {
    /// The number in the case itself; else the first value.
    reference: Option<f64>,
    /// Period of an angle, in degrees.
    period_deg: Option<f64>,
    differences: Distribution,
}

impl Centred {
    pub fn around(reference: Option<f64>, period_deg: Option<f64>) -> Self {
        Self { reference, period_deg, differences: Distribution::default() }
    }

    pub fn add(&mut self, value: f64) {
        let off = value - *self.reference.get_or_insert(value);
        self.differences.add(self.period_deg.map_or(off, |period| wrapped_deg(off, period)));
    }

    pub const fn count(&self) -> u64 {
        self.differences.count
    }

    /// Mean, standard deviation and quantiles; `None` without a value.
    pub fn spread(self) -> Option<Spread> {
        let reference = self.reference.unwrap_or_default();
        let (mean, sd) = (self.differences.mean, self.differences.sd());
        self.differences.quantiles(Spread::PARTS).map(|quantiles| Spread {
            mean: reference + mean,
            sd,
            quantiles: quantiles.map(|quantile| reference + quantile),
        })
    }
}

/// A difference of angles, as small as their period lets it be.
fn wrapped_deg(difference_deg: f64, period_deg: f64) -> f64 {
    let turns = 360.0 / period_deg;
    Angle::from_deg(difference_deg * turns).wrapped().deg() / turns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_about_half_a_turn_are_near_each_other() {
        let mut found = Centred::around(Some(179.0), Some(360.0));
        [-179.0, 177.0].into_iter().for_each(|deg| found.add(deg));
        let spread = found.spread().expect("two values");
        // 181° and 177°.
        assert!((spread.mean - 179.0).abs() < 1e-12, "{spread:?}");
        assert!(spread.sd.is_some_and(|sd| (sd - 8.0_f64.sqrt()).abs() < 1e-12), "{spread:?}");
        let mut line = Centred::around(Some(89.0), Some(180.0));
        line.add(-89.0);
        assert!((line.spread().expect("a value").mean - 91.0).abs() < 1e-12);
    }
}
