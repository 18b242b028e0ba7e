//! The most probable shape for clicks.

use nalgebra::{Cholesky, DVector, Dyn};

use super::clicks::{Equations, PlacedClicks};
use super::error::CompletionError;
use super::model::ShapeModel;
use super::shape::{FIRST_LENGTH, LENGTHS, LEVELS, PARAMETERS, Shape};
use crate::spatial::{Angle, Frontal};

/// Standard deviation of a click as a part of the distance between the centres of neighbours: 0.7 mm at 26 mm.
///
/// # References
/// Assumption, between one careful reader and the AASCE readers, whose corners differ by more.
const CLICK_SD_PER_STEP: f64 = 0.0265;
/// Largest change of an angle or a logarithm at convergence.
const TOLERANCE: f64 = 1e-8;
const MAX_ITERATIONS: usize = 60;
/// Largest change of an angle or a logarithm in one iteration.
const MAX_STEP: f64 = 0.4;

/// The mean shape, placed, turned and scaled to the clicks by least squares.
fn start(model: &ShapeModel, equations: &Equations) -> Shape {
    let mut shape = Shape { parameters: model.mean.clone() };
    let own = &equations.matrix * shape.coordinates();
    let pairs = |values: &DVector<f64>| -> Vec<Frontal> {
        values.as_slice().chunks_exact(2).map(|pair| Frontal::new(pair[0], pair[1])).collect()
    };
    let (own, clicked) = (pairs(&own), pairs(&equations.values));
    let count = own.len() as f64;
    let mean = own.iter().fold(Frontal::default(), |sum, &place| sum + place) * (1.0 / count);
    let [mut along, mut across, mut square] = [0.0; 3];
    for (&own, &clicked) in own.iter().zip(&clicked) {
        let from = own - mean;
        along += from.dot(clicked);
        across += from.cross(clicked);
        square += from.dot(from);
    }
    let scale = along.hypot(across) / square;
    let turn = Angle::from_sin_cos(across, along);
    let place = (mean * -scale).rotated(turn);
    shape.parameters[0] = place.y_mm;
    shape.parameters[1] = place.z_mm;
    shape.parameters[2] = turn.rad();
    shape.parameters.rows_mut(FIRST_LENGTH, LENGTHS).add_scalar_mut(scale.ln());
    shape
}

pub(super) struct Fit {
    pub shape: Shape,
    /// The factor of the normal equations at the solution: the inverse covariance of the parameters.
    pub normal: Cholesky<f64, Dyn>,
    pub iterations: usize,
}

/// Gauss–Newton from the placed mean shape to the most probable one.
pub(super) fn fit_to(model: &ShapeModel, clicks: &PlacedClicks) -> Result<Fit, CompletionError> {
    let mut shape = start(model, &clicks.of_vertebrae());
    for iterations in 1..=MAX_ITERATIONS {
        let failed = CompletionError::NotConverged { iterations };
        let (equations, jacobian) = (clicks.equations(&centres(&shape)), shape.jacobian());
        let step_mm = shape.parameters.rows(FIRST_LENGTH, LEVELS - 1).mean().exp();
        let weight = (CLICK_SD_PER_STEP * step_mm).powi(-2);
        let rows = &equations.matrix * &jacobian;
        let off = &equations.values - &equations.matrix * shape.coordinates();
        let weighted = rows.transpose() * weight;
        let normal = &weighted * &rows + &model.precision;
        let from_mean = &model.mean - &shape.parameters;
        let right = weighted * off + &model.precision * from_mean;
        let normal = normal.cholesky().ok_or(failed)?;
        let mut change = normal.solve(&right);
        let largest = change.rows(2, PARAMETERS - 2).amax();
        if !largest.is_finite() {
            return Err(failed);
        }
        if largest > MAX_STEP {
            change *= MAX_STEP / largest;
        }
        shape.parameters += change;
        if largest < TOLERANCE {
            return Ok(Fit { shape, normal, iterations });
        }
    }
    Err(CompletionError::NotConverged { iterations: MAX_ITERATIONS })
}

/// Means of the corners of every vertebra.
pub(super) fn centres(shape: &Shape) -> [Frontal; LEVELS] {
    shape.corners().map(|body| body.centre())
}
