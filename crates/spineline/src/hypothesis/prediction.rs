//! A film under the load of a hypothesis: its shape, and the prediction of a film that was not fitted.

use serde::{Deserialize, Serialize};

use super::{Hypothesis, HypothesisFilm, Spine};
use crate::anatomy::named;
use crate::evaluate::FilmShape;
use crate::measure::{FilmScale, Outline};
use crate::multibody::{FilmUnderLoad, LoadedFilm, PathEnding};
use crate::number::mean;
use crate::spatial::Angle;

named! {
    /// Role of a film in a prediction.
    pub enum Role {
        /// Stiffness and load were fitted to it.
        Fitted = "fitted",
        /// Neither bend nor fitted: the load is the one that brings T2 nearest.
        HeldOut = "held_out",
        /// A bend; stiffness was fitted to the other one, and the load is the one that brings T2 nearest.
        LeftOut = "left_out",
        /// A bend; stiffness was fitted to the other one, and the load is the most probable one for T2's place and the
        /// distribution of joint rotations.
        LeftOutWithPrior = "left_out_with_prior",
        /// The same for T2's place and tilt.
        LeftOutWithTilt = "left_out_with_tilt",
        /// A bend; stiffness was fitted to the other one, and the load to the whole shape of this one.
        LeftOutLoadFitted = "left_out_load_fitted",
    }
}

/// Joints that turn against the moment of a load, where the film shows both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CounterRotatingJoints {
    /// How many.
    pub joints: usize,
    /// How many of them by more than two deviations of their measurement.
    pub beyond_noise: usize,
    /// Their part in the work `Σ |rotation × moment|` of all joints.
    pub weight: f64,
}

/// A film by a hypothesis, beside the measured film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapePrediction {
    /// The shape, beside the film.
    pub shape: FilmShape,
    /// Role of the film.
    pub role: Role,
    /// Components of the load: N, or N·mm for couples; of the body's weight for [`super::LoadShape::Weight`].
    pub components: Vec<f64>,
    /// Turn of the whole spine about L4, about +X.
    pub base: Angle,
    /// Tilts, L4 first.
    pub tilts: Vec<Angle>,
    /// Root mean square of the errors of the joints' rotations, with L4's axis as it was read: a turn of the base is an error of the
    /// lowest joint.
    pub rotation_rms: Angle,
    /// Joints that turn against this load.
    pub against: CounterRotatingJoints,
}

impl ShapePrediction {
    /// A prediction at its own scale, in the lengths of the given film.
    pub(super) fn in_lengths_of(self, film: &HypothesisFilm<'_>, scale: FilmScale) -> Self {
        Self { shape: self.shape.in_lengths_of(&film.outline.length, scale), ..self }
    }
}

/// A prediction, or why it is missing.
pub(super) type Predicted = Result<ShapePrediction, PathEnding>;

/// A load with a base, and the stiffness from other films.
#[derive(Clone, Copy)]
pub(super) struct Predictor<'s, 'a> {
    pub hypothesis: Hypothesis,
    pub spine: &'s Spine<'a>,
    pub log_multipliers: &'s [f64],
    /// Of the films that are predicted.
    pub role: Role,
}

/// A load that was found for a film.
pub(super) struct FoundLoad {
    pub components: Vec<f64>,
    /// The turn of the base.
    pub base: Angle,
}

impl FoundLoad {
    /// The shape of the film under the load, if a human spine can have it.
    pub fn shape(
        self,
        loaded: &LoadedFilm,
        film: &HypothesisFilm<'_>,
        role: Role,
        spine: &Spine<'_>,
    ) -> Predicted {
        if loaded.is_beyond_human_range(spine.springs.model) {
            return Err(PathEnding::BeyondHumanRange);
        }
        let measured = &film.outline.vertebrae;
        let locations = (0..measured.len()).map(|i| loaded.location(i)).collect();
        let tilts: Vec<Angle> = (0..measured.len()).map(|i| loaded.tilt(i)).collect();
        Ok(ShapePrediction {
            shape: FilmShape::new(locations, film.outline),
            role,
            against: against(loaded, film, &self.components),
            components: self.components,
            base: self.base,
            rotation_rms: rotation_rms(film.outline, &tilts),
            tilts,
        })
    }
}

/// Root mean square of the errors of the rotations of joints between marked vertebrae.
fn rotation_rms(film: &Outline, tilts: &[Angle]) -> Angle {
    let measured = &film.vertebrae;
    let turned =
        (1..measured.len()).filter(|&i| measured[i].is_measured() && measured[i - 1].is_measured());
    let squares = turned.map(|i| {
        // L4's tilt on a turned base is the base's; as it was read it is zero.
        let simulated = tilts[i] - tilts[i - 1];
        (simulated - (measured[i].tilt - measured[i - 1].tilt)).wrapped().rad().powi(2)
    });
    Angle::from_rad(mean(squares).unwrap_or(f64::NAN).sqrt())
}

/// Joints that turn against the moment of a load of given components.
fn against(
    loaded: &LoadedFilm,
    film: &HypothesisFilm<'_>,
    components: &[f64],
) -> CounterRotatingJoints {
    let responses = film.responses_to(&loaded.units).by_component;
    let component = |i: usize| components.get(i).copied().unwrap_or(0.0);
    let joints = film.evidence.contradicted(&responses, [0, 1, 2].map(component));
    CounterRotatingJoints {
        joints: joints.len(),
        beyond_noise: joints.iter().filter(|joint| joint.beyond_noise).count(),
        weight: joints.iter().map(|joint| joint.weight).sum(),
    }
}
