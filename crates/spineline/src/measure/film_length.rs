//! The length of the spine on a film, as a part of its length on the erect film.
//!
//! One patient's spine has one length, but films show different lengths: the patient stands nearer to the detector or tilted out of
//! its plane, magnification differs, and landmarks lie differently. A factor per film corrects this before films are compared;
//! angles do not depend on it.

use serde::{Deserialize, Serialize};

use crate::number::NORMAL_975;
use crate::spatial::Frontal;

/// How lengths of several films of one patient are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FilmLengthRule {
    /// Every film has its own scale. Its logarithm is normal about zero with this standard deviation, or with the standard deviation
    /// of both stated scales if both films state one ([`LengthScale::relative_sd`](super::LengthScale::relative_sd)).
    PerFilm {
        /// Standard deviation where a scale is not stated.
        relative_sd: f64,
    },
    /// All films are taken to have one scale (the paper).
    AsMarked,
}

impl FilmLengthRule {
    /// Standard deviation of the ratio of a bend's length to the erect one.
    ///
    /// Measured on midlines of the back of 30 patients, two bends each (-10 % to +7 %); radiographs may differ less.
    pub const RELATIVE_SD: f64 = 0.033;
}

impl Default for FilmLengthRule {
    fn default() -> Self {
        Self::PerFilm { relative_sd: Self::RELATIVE_SD }
    }
}

/// A scale, and the standard deviation of its logarithm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FilmScale {
    /// A length on the film over the same length on the erect film.
    pub factor: f64,
    /// Standard deviation of its logarithm; zero for a scale that is fixed.
    pub log_sd: f64,
}

impl FilmScale {
    /// The scale of the erect film, to which the others are compared.
    pub const ONE: Self = Self { factor: 1.0, log_sd: 0.0 };

    /// The 95 % interval.
    #[must_use]
    pub fn interval_95(&self) -> [f64; 2] {
        let half = NORMAL_975 * self.log_sd;
        [-half, half].map(|log| self.factor * log.exp())
    }
}

/// The length of the spine on a film against the erect one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmLength {
    /// From the locations alone, with the standard deviation by the landmarks.
    pub measured: FilmScale,
    /// Standard deviation of the logarithm of the scale before the film is measured; zero where the scale is fixed.
    pub prior_log_sd: f64,
    /// From both. The locations of the outline are divided by this factor.
    pub scale: FilmScale,
}

impl FilmLength {
    /// Of the erect film itself, and of films whose scale is fixed.
    pub const ERECT: Self =
        Self { measured: FilmScale::ONE, prior_log_sd: 0.0, scale: FilmScale::ONE };

    /// A film whose length differs from the erect one by more standard deviations of the prior gets a warning.
    const UNUSUAL: f64 = 3.0;

    /// Whether the scale is estimated.
    #[must_use]
    pub fn is_free(&self) -> bool {
        self.prior_log_sd > 0.0
    }

    /// Whether the length differs from the erect one by more than three standard deviations of the prior.
    #[must_use]
    pub fn is_unusual(&self) -> bool {
        self.is_free() && self.measured.factor.ln().abs() > Self::UNUSUAL * self.prior_log_sd
    }

    /// The scale from T2's location alone: it brings the simulated T2 nearest to the marked one, with the prior considered.
    ///
    /// # Definition
    /// The minimum over `u = ln factor` of `|e^u s - m|² / σ² + u² / τ²`, where `s` is T2 in the model and `m` on the film as
    /// marked, both from the base, `σ` the standard deviation of `m` and `τ` the prior's. The standard deviation is taken at the
    /// minimum, for the shape as it is simulated.
    #[must_use]
    pub fn from_top(&self, simulated: Frontal, marked: Frontal, sd_mm: f64) -> FilmScale {
        if !self.is_free() {
            return FilmScale::ONE;
        }
        let (square, product) = (simulated.dot(simulated), simulated.dot(marked));
        let (data, prior) = (sd_mm.powi(-2), self.prior_log_sd.powi(-2));
        // From above, where the function is convex, Newton's method descends to the only minimum.
        let mut log = (product / square).max(0.5).ln().max(0.0);
        for _ in 0..20 {
            let factor: f64 = log.exp();
            let slope = data * factor * (factor * square - product) + prior * log;
            let curvature = data * factor * (2.0 * factor * square - product) + prior;
            let step = slope / curvature;
            log -= step;
            if step.abs() < 1e-12 {
                break;
            }
        }
        let factor = log.exp();
        let curvature = data * factor * (2.0 * factor * square - product) + prior;
        FilmScale { factor, log_sd: curvature.powf(-0.5) }
    }
}
