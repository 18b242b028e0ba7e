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
            found.add_errors(&outline.covariance());
        }
        Some(found)
    }

    /// Adds the errors of a film's landmarks: left, cranial and tilt of every vertebra.
    ///
    /// # Definition
    /// `G` counts places and tilts from the base, so the error of vertebra `i` is `e_i - e_0`. Two vertebrae share the error of the base:
    /// with independent `e` of the variance `σ²` their covariance is `σ²`, and the variance of each is `2 σ²`. The error of the base's tilt
    /// turns the whole film. This is a rotation of the lowest joint and belongs to the distribution of rotations.
    fn add_errors(&mut self, errors: &DMatrix<f64>) {
        let from_base = |i: usize, j: usize| {
            let (k, l) = (i % 3, j % 3);
            errors[(i, j)] - errors[(i, l)] - errors[(k, j)] + errors[(k, l)]
        };
        let (size, place) = (self.tilts_rad2.nrows(), |row: usize| 3 * (row / 2) + row % 2);
        self.locations_mm2 +=
            DMatrix::from_fn(2 * size, 2 * size, |i, j| from_base(place(i), place(j)));
        self.tilts_rad2 += DMatrix::from_fn(size, size, |i, j| from_base(3 * i + 2, 3 * j + 2));
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
    fn the_noise_of_an_angle_is_the_same_with_and_without_the_base() {
        // Closed form: errors of three places 30 mm apart turn two lines against each other by (e_0 - 2 e_1 + e_2) / 30 mm.
        let (location_mm, tilt_rad) = (0.3, 0.01);
        let [place, tilt]: [f64; 2] = [location_mm, tilt_rad].map(|sd: f64| sd * sd);
        let errors = DMatrix::from_fn(18, 18, |i, j| match (i == j, i % 3) {
            (false, _) => 0.0,
            (true, 2) => tilt,
            (true, _) => place,
        });
        let mut found = FilmCovariance {
            locations_mm2: DMatrix::zeros(12, 12),
            tilts_rad2: DMatrix::zeros(6, 6),
        };
        found.add_errors(&errors);
        let locations: Vec<Frontal> =
            (0..6).map(|i| Frontal::new(0.0, 30.0 * f64::from(i))).collect();
        for inferior in [0, 2] {
            let bounds = RegionBounds {
                region: Region::MainThoracic,
                inferior,
                apex: inferior + 1,
                superior: inferior + 2,
            };
            let ferguson = found.ferguson_sd(&locations, &bounds).rad();
            assert!((ferguson - 6.0_f64.sqrt() * location_mm / 30.0).abs() < 1e-12, "{ferguson}");
            let range = found.tilt_range_sd(&bounds).rad();
            assert!((range - 2.0_f64.sqrt() * tilt_rad).abs() < 1e-12, "{range}");
        }
        assert_eq!(found.distance_mm(0), 0.0);
        // Two coordinates, each with the error of the vertebra and of the base.
        assert!((found.distance_mm(3) - 2.0 * location_mm).abs() < 1e-12);
    }

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
