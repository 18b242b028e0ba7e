//! Corners of all vertebrae from a part of the marks on a film: conditional mean and covariance.
//!
//! A spine is a chain of bodies (module `shape`): rotations and offsets between neighbours, wedges, shears and lengths. Their
//! mean and covariance were learned from films of erect scoliotic spines (module `model`); place, direction and scale are
//! unknown. Corners are a smooth function of the parameters, and marks are means of corners with the error of a click, so
//! that the most probable shape is found by Gauss–Newton, and its covariance follows at the solution (Laplace).
//! On films that are not erect the rotations of the joints have more freedom.
//!
//! # References
//! Landmarks: [wu-boostnet-2017]; model card in `crates/spineline-weights`. The figures of `validation/proposals.md` are of films of
//! patients it was not learned from.

mod clicks;
mod model;
mod shape;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix2};

pub use self::clicks::{Click, Clicks, Mark};
use self::clicks::{Equations, PlacedClicks};
use self::model::model_of;
pub use self::model::{ShapeModel, has_shape, provide_shape};
use self::shape::{
    CORNERS, FIRST_LENGTH, LENGTHS, LEVELS, PARAMETERS, Shape, coordinate, corners_at,
};
use super::{CornerName, Corners, ImageGeometry};
use crate::anatomy::{Level, Posture};
use crate::spatial::{Angle, Frontal, Pixel};

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

/// Corners of all vertebrae from L5 to T1, completed from clicks.
#[derive(Debug, Clone, PartialEq)]
pub struct Completion {
    corners: [Corners<Frontal>; LEVELS],
    covariance_mm2: DMatrix<f64>,
    iterations: usize,
}

/// Why corners could not be completed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CompletionError {
    /// The program has provided no table ([`provide_shape`]).
    #[error("this program was built without the shape of spines that completes corners")]
    NoShape,
    /// Fewer than two clicks on vertebrae, or all at one place.
    #[error(
        "corners cannot be completed from {clicks} clicks on vertebrae: two that lie apart are needed"
    )]
    TooFew {
        /// Clicks on vertebrae.
        clicks: usize,
    },
    /// A coordinate is not finite.
    #[error("{level}: the place of a click is not a finite number")]
    NotFinite {
        /// Vertebra.
        level: Level,
    },
    /// The most probable shape was not found.
    #[error(
        "corners could not be completed: the shape did not converge in {iterations} iterations; check the levels of the clicks"
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
    },
}

impl Completion {
    /// The corners of a vertebra, in the film's frontal frame ([`ImageGeometry::frontal`]).
    #[must_use]
    pub fn corners(&self, level: Level) -> Corners<Frontal> {
        self.corners[level as usize]
    }

    /// The corners of a vertebra on the film; they may lie beyond its edge.
    #[must_use]
    pub fn corners_px(&self, image: &ImageGeometry, level: Level) -> Corners<Pixel> {
        self.corners(level).map(|corner| image.pixel(corner))
    }

    /// Covariance of all corners in mm² (px² of the frontal frame where no spacing is known): levels from L5 to T1, corners in
    /// the order of [`CornerName::ALL`], towards the patient's left and cranial; 136 × 136.
    #[must_use]
    pub const fn covariance_mm2(&self) -> &DMatrix<f64> {
        &self.covariance_mm2
    }

    /// Covariance of two corners, or of a corner with itself, in mm².
    pub(crate) fn corner_covariance_mm2(
        &self,
        one: (Level, CornerName),
        other: (Level, CornerName),
    ) -> Matrix2<f64> {
        let (row, column) = (coordinate(one.0, one.1), coordinate(other.0, other.1));
        self.covariance_mm2.fixed_view::<2, 2>(row, column).into_owned()
    }

    /// Standard deviation of the corners of a vertebra: the root of the mean of all coordinates' variances.
    #[must_use]
    pub fn sd_mm(&self, level: Level) -> f64 {
        let variances = self.covariance_mm2.diagonal();
        variances.rows(corners_at(level), CORNERS).mean().sqrt()
    }

    /// Iterations until it converged.
    #[must_use]
    pub const fn iterations(&self) -> usize {
        self.iterations
    }
}

/// Completes the corners of all vertebrae from L5 to T1; `posture` is `None` where it is not known, as in blinded readings.
///
/// # Errors
/// [`CompletionError`].
///
/// ```
/// use spineline::anatomy::{ImageSide, Level, Posture, Side};
/// use spineline::measure::completion::{Click, Clicks, Mark, complete, provide_shape};
/// use spineline::measure::ImageGeometry;
/// use spineline::spatial::Pixel;
///
/// // The patient's left is on the right of the picture; an upright lumbar spine.
/// let image = ImageGeometry { columns: 1000, rows: 2400, patient_left: ImageSide::Right, spacing: None };
/// let click = |level, side, column, row| Click { level, mark: Mark::Wall(side), place: Pixel::new(column, row) };
/// let vertebrae = vec![
///     click(Level::L4, Side::Left, 560.0, 2000.0),
///     click(Level::L4, Side::Right, 440.0, 2000.0),
///     click(Level::L3, Side::Left, 558.0, 1900.0),
///     click(Level::L3, Side::Right, 442.0, 1900.0),
/// ];
/// provide_shape(spineline_weights::ERECT_SPINES);
/// let found = complete(&image, Some(Posture::Erect), &Clicks { vertebrae, midline: vec![] })?;
/// let l3 = found.corners_px(&image, Level::L3);
/// assert!(l3.superior_left.row_px < 1900.0 && l3.inferior_left.row_px > 1900.0);
/// let next = found.corners_px(&image, Level::L2);
/// assert!(next.inferior_right.row_px < l3.superior_right.row_px, "L2 lies above L3");
/// # Ok::<(), spineline::measure::completion::CompletionError>(())
/// ```
pub fn complete(
    image: &ImageGeometry,
    posture: Option<Posture>,
    clicks: &Clicks,
) -> Result<Completion, CompletionError> {
    let model = model_of(posture).ok_or(CompletionError::NoShape)?;
    complete_by(model, image, clicks)
}

/// As [`complete`], by a model of other films, such as one that leaves out the patients on whom it is tried.
///
/// # Errors
/// [`CompletionError`].
pub fn complete_by(
    model: &ShapeModel,
    image: &ImageGeometry,
    clicks: &Clicks,
) -> Result<Completion, CompletionError> {
    let count = clicks.vertebrae.len();
    let bad = clicks.vertebrae.iter().find(|click| !click.place.is_finite());
    if let Some(&Click { level, .. }) = bad {
        return Err(CompletionError::NotFinite { level });
    }
    let placed = PlacedClicks::new(image, clicks);
    if count < 2 || !placed.lie_apart() {
        return Err(CompletionError::TooFew { clicks: count });
    }
    let start = start(model, &placed.of_vertebrae());
    let Fit { shape, normal, iterations } = fit(model, start, &placed)?;
    let jacobian = shape.jacobian();
    let covariance_mm2 = &jacobian * normal.solve(&jacobian.transpose());
    let corners = shape.corners().map(|body| body.map(|corner| corner + placed.about));
    Ok(Completion { corners, covariance_mm2, iterations })
}

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

struct Fit {
    shape: Shape,
    /// The factor of the normal equations at the solution: the inverse covariance of the parameters.
    normal: Cholesky<f64, Dyn>,
    iterations: usize,
}

/// Gauss–Newton from a start to the most probable shape.
fn fit(model: &ShapeModel, start: Shape, clicks: &PlacedClicks) -> Result<Fit, CompletionError> {
    let mut shape = start;
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
fn centres(shape: &Shape) -> [Frontal; LEVELS] {
    shape.corners().map(|body| {
        body.points().into_iter().fold(Frontal::default(), |sum, corner| sum + corner) * 0.25
    })
}

#[cfg(test)]
mod tests;
