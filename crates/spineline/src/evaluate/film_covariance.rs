//! How far vertebrae of a film can lie from where they are predicted.

use nalgebra::DMatrix;

use super::baseline::{FilmFromTop, Links};
use super::rotation_prior::RotationPrior;
use crate::clinical::RegionBounds;
use crate::measure::Outline;
use crate::spatial::{Angle, Frontal};

/// Covariance of the vertebrae of a film of which T2 is known, by a distribution of joint rotations and the landmark noise of both films.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmCovariance {
    /// Of `(y, z)` of every vertebra relative to the base, caudal first.
    locations_mm2: DMatrix<f64>,
    /// Of the tilts relative to the base's.
    tilts_rad2: DMatrix<f64>,
}

impl FilmCovariance {
    /// Of a film before the erect one.
    #[must_use]
    pub fn of(
        prior: &RotationPrior,
        erect: &Outline,
        film: &Outline,
        knows_tilt: bool,
    ) -> Option<Self> {
        let links = Links::of(erect);
        let [locations_mm2, tilts_rad2] =
            FilmFromTop::of(erect, film).covariances(prior, &links, knows_tilt)?;
        let mut found = Self { locations_mm2, tilts_rad2 };
        for outline in [erect, film] {
            let noise = |i: usize| outline.noise_of(&outline.vertebrae[i]);
            let base = noise(0);
            for i in 1..outline.vertebrae.len() {
                let own = noise(i);
                let mm2 = base.location_mm.powi(2) + own.location_mm.powi(2);
                for row in [2 * i, 2 * i + 1] {
                    found.locations_mm2[(row, row)] += mm2;
                }
                found.tilts_rad2[(i, i)] += base.tilt.rad().powi(2) + own.tilt.rad().powi(2);
            }
        }
        Some(found)
    }

    /// Root mean square distance of a vertebra from its prediction.
    #[must_use]
    pub fn distance_mm(&self, vertebra: usize) -> f64 {
        let place = 2 * vertebra;
        (self.locations_mm2[(place, place)] + self.locations_mm2[(place + 1, place + 1)]).sqrt()
    }

    /// Standard deviation of the Ferguson angle of a region.
    #[must_use]
    pub fn ferguson_sd(&self, locations: &[Frontal], bounds: &RegionBounds) -> Angle {
        let [lower, upper] = bounds.ferguson_lines(|i| locations[i]);
        // A tilt turns by the shift across the line over the length of it.
        let across = |line: Frontal| [-line.z_mm, line.y_mm].map(|part| part / line.dot(line));
        let mut rates = DMatrix::zeros(1, self.locations_mm2.nrows());
        for (line, [from, to], sign) in [
            (upper, [bounds.apex, bounds.superior], 1.0),
            (lower, [bounds.inferior, bounds.apex], -1.0),
        ] {
            for (part, rate) in across(line).into_iter().enumerate() {
                rates[2 * to + part] += sign * rate;
                rates[2 * from + part] -= sign * rate;
            }
        }
        Angle::from_rad((&rates * &self.locations_mm2 * rates.transpose())[0].max(0.0).sqrt())
    }

    /// Standard deviation of the angle between the end vertebrae of a region.
    #[must_use]
    pub fn tilt_range_sd(&self, bounds: &RegionBounds) -> Angle {
        let (low, high) = (bounds.inferior, bounds.superior);
        let of = |i, j| self.tilts_rad2[(i, j)];
        Angle::from_rad((of(low, low) + of(high, high) - 2.0 * of(low, high)).max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy::Region;

    #[test]
    fn the_deviation_of_a_ferguson_angle_follows_from_its_differences() {
        let locations: Vec<Frontal> = (0..6)
            .map(|i| Frontal::new(20.0 * (f64::from(i) * 0.9).sin(), 30.0 * f64::from(i)))
            .collect();
        let bounds =
            RegionBounds { region: Region::MainThoracic, inferior: 1, apex: 3, superior: 5 };
        let root = DMatrix::from_fn(12, 12, |i, j| (0.7 * (3 * i + 5 * j) as f64).sin());
        let found = FilmCovariance {
            locations_mm2: &root * root.transpose(),
            tilts_rad2: DMatrix::zeros(6, 6),
        };
        // Oracle: central differences of the angle by every coordinate.
        let rates = DMatrix::from_fn(1, 12, |_, row| {
            let angle = |step_mm: f64| {
                let mut moved = locations.clone();
                let shift = [Frontal::new(step_mm, 0.0), Frontal::new(0.0, step_mm)][row % 2];
                moved[row / 2] = moved[row / 2] + shift;
                bounds.ferguson_angle(|i| moved[i]).rad()
            };
            (angle(1e-4) - angle(-1e-4)) / 2e-4
        });
        let variance = (&rates * &found.locations_mm2 * rates.transpose())[0];
        let sd = found.ferguson_sd(&locations, &bounds).rad();
        assert!((sd / variance.sqrt() - 1.0).abs() < 1e-6, "{sd}, {variance}");
    }
}
