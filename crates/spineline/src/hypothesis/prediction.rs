//! A film under the load of a hypothesis: its shape, and the prediction of a film that was not fitted.

use serde::{Deserialize, Serialize};

use super::near_t2::nearest_t2;
use super::{Hypothesis, HypothesisFilm, Spine};
use crate::anatomy::{Posture, named};
use crate::evaluate::{ScaledPrediction, at_scale_of_top, location_errors_mm};
use crate::measure::FilmScale;
use crate::multibody::{FilmUnderLoad, LoadedFilm, PathEnding, Wanted};
use crate::spatial::{Angle, Frontal};

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
    /// The posture.
    pub posture: Posture,
    /// Role of the film.
    pub role: Role,
    /// The film's scale against the erect film, at which the model was compared with it.
    pub scale: FilmScale,
    /// Components of the load: N, or N·mm for couples; of the body's weight for [`super::LoadShape::Weight`].
    pub components: Vec<f64>,
    /// Turn of the whole spine about L4, about +X.
    pub base: Angle,
    /// Locations L4 to T2, in `G`.
    pub locations: Vec<Frontal>,
    /// Tilts.
    pub tilts: Vec<Angle>,
    /// Distance between simulated and measured location of L3…T2: E_LOC.
    pub location_errors_mm: Vec<f64>,
    /// Root mean square of the errors of the joints' rotations, with L4's axis as it was read: a turn of the base is an error of the
    /// lowest joint.
    pub rotation_rms: Angle,
    /// Joints that turn against this load.
    pub against: CounterRotatingJoints,
}

impl ShapePrediction {
    /// Mean of the location errors.
    #[must_use]
    pub fn mean_location_error_mm(&self) -> f64 {
        self.location_errors_mm.iter().sum::<f64>() / self.location_errors_mm.len() as f64
    }
}

/// A prediction, or why it is missing.
pub(super) type Predicted = Result<ShapePrediction, PathEnding>;

/// The film under the load that brings T2 nearest, at the scale that T2 and its prior give.
pub(super) fn predict(
    hypothesis: Hypothesis,
    spine: &Spine<'_>,
    film: &HypothesisFilm<'_>,
    log_multipliers: &[f64],
    role: Role,
) -> Predicted {
    let mut reason = PathEnding::NotConverged;
    let found = at_scale_of_top(film.outline, |outline| {
        let film = film.at_scale_of(outline, spine);
        match predict_scaled(hypothesis, spine, &film, log_multipliers, role) {
            Ok(found) => Some((*found.locations.last()?, found)),
            Err(lost) => {
                reason = lost;
                None
            }
        }
    });
    let ScaledPrediction { scale, prediction, converged } = found.ok_or(reason)?;
    if !converged {
        return Err(PathEnding::NotConverged);
    }
    Ok(with_scale(prediction, scale, film))
}

/// A prediction at its own scale, in the lengths of the given film.
pub(super) fn with_scale(
    prediction: ShapePrediction,
    scale: FilmScale,
    film: &HypothesisFilm<'_>,
) -> ShapePrediction {
    let factor = scale.factor / film.outline.length.scale.factor;
    ShapePrediction {
        scale,
        locations: prediction.locations.iter().map(|&location| location * factor).collect(),
        location_errors_mm: prediction.location_errors_mm.iter().map(|mm| mm * factor).collect(),
        ..prediction
    }
}

fn predict_scaled(
    hypothesis: Hypothesis,
    spine: &Spine<'_>,
    film: &HypothesisFilm<'_>,
    log_multipliers: &[f64],
    role: Role,
) -> Predicted {
    let found = film.under(hypothesis.load, spine).and_then(|mut loaded| {
        let top = film.outline.vertebrae.last()?.location;
        let near = nearest_t2(hypothesis, &mut loaded, log_multipliers, top, spine)?;
        let springs = spine.with_multipliers(log_multipliers);
        // From where the search has left it, so that no other equilibrium is shown.
        let solved = loaded.solve(&springs, &near.components, near.base, Wanted::Shape);
        solved.then_some((loaded, near))
    });
    let (loaded, near) = found.ok_or(PathEnding::NotConverged)?;
    prediction(&loaded, film, role, spine, near.components, near.base)
}

/// The shape of a film under its loads, if a human spine can have it.
pub(super) fn prediction(
    loaded: &LoadedFilm,
    film: &HypothesisFilm<'_>,
    role: Role,
    spine: &Spine<'_>,
    components: Vec<f64>,
    base: Angle,
) -> Predicted {
    if loaded.is_beyond_human_range(spine.springs.model) {
        return Err(PathEnding::BeyondHumanRange);
    }
    let measured = &film.outline.vertebrae;
    let locations: Vec<Frontal> = (0..measured.len()).map(|i| loaded.location(i)).collect();
    let tilts: Vec<Angle> = (0..measured.len()).map(|i| loaded.tilt(i)).collect();
    // The turns of joints between marked vertebrae.
    let turned = || {
        (1..measured.len()).filter(|&i| measured[i].is_measured() && measured[i - 1].is_measured())
    };
    let squares: f64 = turned()
        .map(|i| {
            // L4's tilt on a turned base is the base's; as it was read it is zero.
            let simulated = tilts[i] - tilts[i - 1];
            (simulated - (measured[i].tilt - measured[i - 1].tilt)).wrapped().rad().powi(2)
        })
        .sum();
    let joints = turned().count() as f64;
    Ok(ShapePrediction {
        posture: film.outline.posture,
        role,
        scale: film.outline.length.scale,
        against: against(loaded, film, &components),
        components,
        base,
        location_errors_mm: location_errors_mm(&locations, film.outline),
        locations,
        tilts,
        rotation_rms: Angle::from_rad((squares / joints).sqrt()),
    })
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
