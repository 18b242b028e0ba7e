//! Loads and bases beside the lines as a study store keeps them.

use serde::{Deserialize, Serialize};
use spineline::anatomy::Posture;
use spineline::hypothesis::{
    CounterRotatingJoints, Criteria, HypothesisFit, LostPrediction, ShapePrediction,
};
use spineline::measure::FilmScale;
use spineline::multibody::PathEnding;
use spineline::spatial::{Angle, Frontal};

use crate::stored_identifiability::Limit;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    hypothesis: String,
    status: String,
    log_multipliers: Vec<f64>,
    chi_squared: Limit,
    measured: usize,
    fitted: usize,
    predictions: Vec<StoredPrediction>,
    lost: Vec<StoredLoss>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredPrediction {
    posture: Posture,
    role: String,
    /// Factor, and standard deviation of its logarithm.
    scale: (f64, f64),
    components: Vec<f64>,
    base_rad: f64,
    locations_mm: Vec<[f64; 2]>,
    tilts_rad: Vec<f64>,
    location_errors_mm: Vec<f64>,
    rotation_rms_rad: f64,
    /// Joints, those beyond noise, and their part in the work.
    against: (usize, usize, f64),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredLoss {
    posture: Posture,
    role: String,
    is_beyond_human_range: bool,
}

/// The fits of loads and bases as text.
///
/// Where a fit has no sum of squares, it counts as infinite. Another number that is not finite makes a text that
/// [`parse_hypotheses`] refuses.
#[must_use]
pub fn hypotheses_text(fits: &[HypothesisFit]) -> String {
    let all: Vec<Stored> = fits.iter().map(stored).collect();
    crate::to_line(&all)
}

/// Reads what [`hypotheses_text`] wrote; `None` where it is something else.
#[must_use]
pub fn parse_hypotheses(text: &str) -> Option<Vec<HypothesisFit>> {
    let all: Vec<Stored> = serde_json::from_str(text).ok()?;
    all.into_iter().map(fit).collect()
}

fn stored(fit: &HypothesisFit) -> Stored {
    let loss = |lost: &LostPrediction| StoredLoss {
        posture: lost.posture,
        role: lost.role.key().to_owned(),
        is_beyond_human_range: lost.reason == PathEnding::BeyondHumanRange,
    };
    Stored {
        hypothesis: fit.hypothesis.key(),
        status: fit.status.key().to_owned(),
        log_multipliers: fit.log_multipliers.clone(),
        chi_squared: fit.criteria.chi_squared.into(),
        measured: fit.criteria.measured,
        fitted: fit.criteria.fitted,
        predictions: fit.predictions.iter().map(stored_prediction).collect(),
        lost: fit.lost.iter().map(loss).collect(),
    }
}

fn stored_prediction(one: &ShapePrediction) -> StoredPrediction {
    StoredPrediction {
        posture: one.posture,
        role: one.role.key().to_owned(),
        scale: (one.scale.factor, one.scale.log_sd),
        components: one.components.clone(),
        base_rad: one.base.rad(),
        locations_mm: one.locations.iter().map(|at| [at.y_mm, at.z_mm]).collect(),
        tilts_rad: one.tilts.iter().map(|tilt| tilt.rad()).collect(),
        location_errors_mm: one.location_errors_mm.clone(),
        rotation_rms_rad: one.rotation_rms.rad(),
        against: (one.against.joints, one.against.beyond_noise, one.against.weight),
    }
}

fn fit(stored: Stored) -> Option<HypothesisFit> {
    let loss = |lost: StoredLoss| {
        Some(LostPrediction {
            posture: lost.posture,
            role: lost.role.parse().ok()?,
            reason: if lost.is_beyond_human_range {
                PathEnding::BeyondHumanRange
            } else {
                PathEnding::NotConverged
            },
        })
    };
    let free = stored.fitted.checked_sub(1)?;
    Some(HypothesisFit {
        hypothesis: stored.hypothesis.parse().ok()?,
        status: stored.status.parse().ok()?,
        log_multipliers: stored.log_multipliers,
        criteria: Criteria::new(stored.chi_squared.into(), stored.measured, free),
        predictions: stored.predictions.into_iter().map(prediction).collect::<Option<_>>()?,
        lost: stored.lost.into_iter().map(loss).collect::<Option<_>>()?,
    })
}

fn prediction(stored: StoredPrediction) -> Option<ShapePrediction> {
    let (factor, log_sd) = stored.scale;
    let (joints, beyond_noise, weight) = stored.against;
    let locations = stored.locations_mm.into_iter();
    Some(ShapePrediction {
        posture: stored.posture,
        role: stored.role.parse().ok()?,
        scale: FilmScale { factor, log_sd },
        components: stored.components,
        base: Angle::from_rad(stored.base_rad),
        locations: locations.map(|[y_mm, z_mm]| Frontal { y_mm, z_mm }).collect(),
        tilts: stored.tilts_rad.into_iter().map(Angle::from_rad).collect(),
        location_errors_mm: stored.location_errors_mm,
        rotation_rms: Angle::from_rad(stored.rotation_rms_rad),
        against: CounterRotatingJoints { joints, beyond_noise, weight },
    })
}
