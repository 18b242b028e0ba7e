//! Shape of one patient's spine, from the erect film, for another film.

use nalgebra::DMatrix;

use super::clicks::{Clicks, PlacedClicks};
use super::error::CompletionError;
use super::fit::{Fit, fit_to};
use super::model::{BEND_SD, JOINTS, ShapeModel, model_of};
use super::shape::{ANGLES, FIRST_LENGTH, LENGTHS, PARAMETERS, PLACE};
use crate::anatomy::Posture;
use crate::measure::ImageGeometry;

/// Correlation of the shapes on two films of one patient: the best one for repeated films of 30 patients, with the errors of their labels
/// (`validation/proposals.md`).
const CORRELATION: f64 = 0.5;
/// Standard deviation of the logarithm of the common scale of two films of one patient: in millimetres (assumption), and without.
const FILM_SCALE_SD: f64 = 0.05;
const UNKNOWN_SCALE_SD: f64 = 10.0;

impl ShapeModel {
    /// The shape of one patient on a film that is not erect, from the clicks on the erect film: its mean lies between the mean of all
    /// patients and the erect film's shape, and the joints turn freely.
    ///
    /// # Errors
    /// [`CompletionError`] if the clicks do not complete the erect film.
    pub fn of_patient(
        erect: &ImageGeometry,
        clicks: &Clicks,
        film: &ImageGeometry,
    ) -> Result<Self, CompletionError> {
        let placed = PlacedClicks::new(erect, clicks)?;
        let all = model_of(Some(Posture::Erect))?;
        let Fit { shape, normal, iterations } = fit_to(all, &placed)?;
        let own = normal.inverse().remove_rows(0, PLACE).remove_columns(0, PLACE);
        let kept = CORRELATION.powi(2);
        let mut covariance = own * kept + &all.covariance * (1.0 - kept);
        for joint in 0..JOINTS {
            covariance[(joint, joint)] += BEND_SD.rad().powi(2);
        }
        let is_known = erect.scale().is_some() && film.scale().is_some();
        let scale_sd = if is_known { FILM_SCALE_SD } else { UNKNOWN_SCALE_SD };
        let mut lengths = covariance.view_mut((ANGLES, ANGLES), (LENGTHS, LENGTHS));
        lengths.add_scalar_mut(scale_sd.powi(2));
        let inverse =
            covariance.clone().cholesky().ok_or(CompletionError::NotConverged { iterations })?;
        let mut precision = DMatrix::zeros(PARAMETERS, PARAMETERS);
        let known = (PARAMETERS - PLACE, PARAMETERS - PLACE);
        precision.view_mut((PLACE, PLACE), known).copy_from(&inverse.inverse());
        // The lengths of all patients are over the geometric mean of their steps.
        let mut all_scaled = all.mean.clone();
        let step = shape.parameters.rows(FIRST_LENGTH, JOINTS).mean();
        all_scaled.rows_mut(FIRST_LENGTH, LENGTHS).add_scalar_mut(step);
        let mut mean = shape.parameters * CORRELATION + all_scaled * (1.0 - CORRELATION);
        mean.rows_mut(0, PLACE).fill(0.0);
        Ok(Self { mean, covariance, precision })
    }
}
