//! 95 % bands of predicted films.
//!
//! # Definition
//! `s_i` is the root mean square distance at which vertebra `i` can lie from its prediction ([`FilmCovariance`]): by a distribution of joint
//! rotations where T2 is known, the scale of the film, and the landmark noise of both films. A prediction of a film has the mean square
//!
//! ```text
//! m = mean of (E_LOC_i / s_i)² over the vertebrae between base and top, over c
//! c = 1 + E_LOC_T2² / mean of s_i²
//! ```
//!
//! `c` counts how far the prediction misses T2, whose location it knows. With the mean `m_0` of other patients and `m_f` of the `n` other
//! bends of this patient that the method predicts, the radius about vertebra `i` is
//!
//! ```text
//! r_i = 2.0 s_i sqrt(c (m_0 + Σ m_f) / (1 + n))
//! ```
//!
//! and 2.5 in place of 2.0 for all vertebrae of a film together. Angles have the same factor on their standard deviation. Decision 0061
//! has the values and the measured coverage.

use super::film_covariance::FilmCovariance;
use super::film_shape::FilmShape;
use crate::clinical::Regions;
use crate::number::mean;
use crate::spatial::Angle;

/// A film as a method predicts it, beside the measured film.
pub(crate) struct PredictedFilm<'a> {
    pub covariance: &'a FilmCovariance,
    /// Places in the chain of the vertebrae above the base that the film shows, caudal first.
    pub shown: &'a [usize],
    pub shape: &'a FilmShape,
}

/// How far the measured film can differ from a predicted one, in 95 % of films.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Radius about the predicted location of every vertebra above the base, caudal first: for one vertebra.
    pub radii_mm: Vec<f64>,
    /// Half-width of the Ferguson angle of every region.
    pub ferguson: [Angle; 3],
    /// Half-width of the angle between the end vertebrae of every region.
    pub tilt_range: [Angle; 3],
}

impl Band {
    /// The radii which hold all vertebrae of a film together, over the radii for one vertebra.
    pub const WHOLE_FILM: f64 = 1.25;
    /// Radii over root mean square distances, and half-widths over standard deviations.
    const REACH: f64 = 2.0;

    /// Mean radius.
    #[must_use]
    pub fn mean_radius_mm(&self) -> f64 {
        mean(self.radii_mm.iter().copied()).unwrap_or(f64::NAN)
    }

    /// Of a film, by the mean squares of other patients and of the other films of this patient.
    pub(crate) fn of(
        film: &PredictedFilm<'_>,
        regions: &Regions,
        of_other_patients: f64,
        other_films: &[f64],
    ) -> Self {
        let mean_square = (of_other_patients + other_films.iter().sum::<f64>())
            / (1.0 + other_films.len() as f64);
        let factor = Self::REACH * (mean_square * film.miss_of_top()).sqrt();
        let locations = &film.shape.locations;
        let above_base = 1..locations.len();
        Self {
            radii_mm: above_base.map(|i| factor * film.covariance.distance_mm(i)).collect(),
            ferguson: regions
                .bounds
                .map(|bounds| film.covariance.ferguson_sd(locations, &bounds) * factor),
            tilt_range: regions
                .bounds
                .map(|bounds| film.covariance.tilt_range_sd(&bounds) * factor),
        }
    }
}

impl PredictedFilm<'_> {
    /// Mean square of its location errors over those that are expected, without T2.
    pub fn mean_square(&self) -> f64 {
        let between = (self.shown.len() - 1).max(1);
        let pairs = self.shown.iter().zip(&self.shape.location_errors_mm).take(between);
        let squares = pairs.map(|(&i, mm)| (mm / self.covariance.distance_mm(i)).powi(2));
        squares.sum::<f64>() / between as f64 / self.miss_of_top()
    }

    /// Factor on all variances, by the error of T2.
    fn miss_of_top(&self) -> f64 {
        let squares = self.shown.iter().map(|&i| self.covariance.distance_mm(i).powi(2));
        let mean_mm2 = squares.sum::<f64>() / self.shown.len() as f64;
        1.0 + self.shape.location_errors_mm.last().map_or(0.0, |mm| mm * mm) / mean_mm2
    }
}
