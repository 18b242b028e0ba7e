//! Films of one patient at different scales, as real films are.

use rand_distr::{Distribution, Normal};
use spineline::anatomy::Posture;
use spineline::measure::{FilmLandmarks, Spacing};

use crate::{Phantom, stream};

/// The streams of scales are far behind all others.
const STREAMS: u64 = 1 << 50;

impl Phantom {
    /// The same patient on films with different scales: the spacing of every film except the erect one is multiplied by
    /// a factor whose logarithm is normal about zero, and the films do not state the error of their scale.
    ///
    /// `subject` (from 0) and seed determine the factors; pixels are unchanged.
    #[must_use]
    pub fn with_film_lengths(mut self, log_sd: f64, subject: usize, seed: u64) -> Self {
        let mut rng = stream(seed, STREAMS + 8 * subject as u64 + self.scenario as u64);
        let normal = Normal::new(0.0, log_sd.abs()).expect("a finite deviation");
        for (film, true_film) in self.case.films.iter_mut().zip(&mut self.films) {
            let scale = match film.posture {
                Posture::Erect => 1.0,
                _ => normal.sample(&mut rng).exp(),
            };
            let scaled = |spacing: Spacing| Spacing {
                column_mm: scale * spacing.column_mm,
                row_mm: scale * spacing.row_mm,
                relative_sd: None,
                ..spacing
            };
            if let FilmLandmarks::Corners { image, .. } = &mut film.landmarks {
                image.spacing = image.spacing.map(scaled);
            }
            true_film.image.spacing = true_film.image.spacing.map(scaled);
            true_film.scale = scale;
        }
        self
    }
}
