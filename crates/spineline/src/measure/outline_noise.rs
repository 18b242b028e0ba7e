//! Noise of several vertebrae of an outline.

use std::collections::BTreeMap;

use super::{MeasuredVertebra, Noise, Outline, ProgramNoise, SharedErrors};
use crate::anatomy::Level;
use crate::spatial::Angle;

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
