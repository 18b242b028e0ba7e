//! Loads and bases other than the lines, in files.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::anatomy::{Levels, Posture};
use spineline::evaluate::Band;
use spineline::hypothesis::{HypothesisFit, LostPrediction, ShapePrediction};
use spineline::multibody::PathEnding;

use super::band::BandRecord;
use super::posture::ScaleRecord;
use crate::text::finite;

/// A load and base fitted to the bends, with its predictions. Lengths in mm, angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(super) struct HypothesisRecord {
    /// How the fit to all bends ended; `beyond_human_range` where a fitted film has a shape that no human spine can have.
    status: String,
    /// Multipliers of the lateral springs, in the order of the groups.
    multipliers: Vec<f64>,
    /// Measured numbers of the fit: n.
    measured_numbers: usize,
    /// Fitted numbers with the size of the residuals: K.
    fitted_numbers: usize,
    /// Root mean square of the residuals in standard deviations of their measurement; `null` without a fit.
    residual_rms: Option<f64>,
    /// n ln(χ²/n) + 2K + 2K(K + 1)/(n - K - 1).
    aicc: Option<f64>,
    /// n ln(χ²/n) + K ln n.
    bic: Option<f64>,
    predictions: Vec<PredictionRecord>,
    /// Films without a prediction, by role.
    lost: BTreeMap<String, Vec<Posture>>,
    /// The lost films whose shape is beyond the human range of motion, by role.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    beyond_human_range: BTreeMap<String, Vec<Posture>>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct PredictionRecord {
    posture: Posture,
    /// `fitted`; `held_out` (neutral, traction); `left_out` (a bend by the stiffness of the other, load by T2's place);
    /// `left_out_with_prior` (the same, load by T2's place and the distribution of joint rotations); `left_out_with_tilt` (the
    /// same, and T2's tilt); `left_out_load_fitted` (the same, load by the whole shape).
    role: String,
    /// Components of the load: N, N·mm for couples, the body's weight for `weight`; relative where no force is known.
    components: Vec<f64>,
    /// Rotation of the whole spine about L4; positive to the patient's right.
    base_deg: f64,
    /// Mean distance of simulated and measured locations of L3 to T2.
    mean_location_error_mm: f64,
    location_errors_mm: Vec<f64>,
    /// Root mean square of the errors of the joints' rotations.
    rotation_rms_deg: f64,
    /// Counter-rotating joints.
    joints_against: usize,
    /// Those beyond two deviations of their measurement.
    joints_against_beyond_noise: usize,
    /// Their part in the work of all joints.
    work_against: f64,
    /// Scale of the film against the erect film, from T2 for a film that was not fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    film_scale: Option<ScaleRecord>,
    /// L4 to T2.
    locations_mm: Vec<[f64; 2]>,
    tilts_deg: Vec<f64>,
    /// Absent for films to which the load was fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    band_95: Option<BandRecord>,
}

impl HypothesisRecord {
    /// `bands` belong to its predictions.
    pub(super) fn new(fit: &HypothesisFit, bands: &[Option<Band>], levels: Levels) -> Self {
        let by_role = |counts: &dyn Fn(&LostPrediction) -> bool| {
            let mut films: BTreeMap<String, Vec<Posture>> = BTreeMap::new();
            for lost in fit.lost.iter().filter(|lost| counts(lost)) {
                films.entry(lost.role.key().to_owned()).or_default().push(lost.posture);
            }
            films
        };
        Self {
            status: fit.ending_key().to_owned(),
            multipliers: fit.log_multipliers.iter().map(|log| log.exp()).collect(),
            measured_numbers: fit.criteria.measured,
            fitted_numbers: fit.criteria.fitted,
            residual_rms: finite(fit.criteria.residual_rms()),
            aicc: finite(fit.criteria.aicc),
            bic: finite(fit.criteria.bic),
            predictions: fit
                .predictions
                .iter()
                .zip(bands)
                .map(|(one, band)| PredictionRecord {
                    band_95: band.as_ref().map(|band| BandRecord::new(band, levels)),
                    ..PredictionRecord::new(one)
                })
                .collect(),
            lost: by_role(&|_| true),
            beyond_human_range: by_role(&|lost| lost.reason == PathEnding::BeyondHumanRange),
        }
    }
}

impl PredictionRecord {
    fn new(prediction: &ShapePrediction) -> Self {
        Self {
            posture: prediction.shape.posture,
            role: prediction.role.key().to_owned(),
            components: prediction.components.clone(),
            base_deg: prediction.base.deg(),
            mean_location_error_mm: prediction.shape.mean_location_error_mm(),
            location_errors_mm: prediction.shape.location_errors_mm.clone(),
            rotation_rms_deg: prediction.rotation_rms.deg(),
            joints_against: prediction.against.joints,
            joints_against_beyond_noise: prediction.against.beyond_noise,
            work_against: prediction.against.weight,
            film_scale: Some(prediction.shape.scale.into()),
            locations_mm: prediction.shape.locations.iter().map(|p| [p.y_mm, p.z_mm]).collect(),
            tilts_deg: prediction.tilts.iter().map(|tilt| tilt.deg()).collect(),
            band_95: None,
        }
    }
}
