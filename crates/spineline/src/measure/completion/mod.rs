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
mod error;
mod fit;
mod model;
mod patient;
mod shape;

use nalgebra::{DMatrix, Matrix2};

use self::clicks::PlacedClicks;
pub use self::clicks::{Click, Clicks, Mark};
pub use self::error::CompletionError;
use self::fit::{Fit, fit_to};
use self::model::model_of;
pub use self::model::{ShapeModel, has_shape, provide_shape};
use self::shape::{CORNERS, LEVELS, coordinate, corners_at};
use super::{CornerName, Corners, ImageGeometry};
use crate::anatomy::{Level, Posture};
use crate::spatial::{Frontal, Pixel};

/// Corners of all vertebrae from L5 to T1, completed from clicks.
#[derive(Debug, Clone, PartialEq)]
pub struct Completion {
    corners: [Corners<Frontal>; LEVELS],
    /// Of all corners in mm² (px² of the frontal frame where no spacing is known): levels from L5 to T1, corners in the order of
    /// [`CornerName::ALL`], towards the patient's left and cranial; 136 × 136.
    covariance_mm2: DMatrix<f64>,
    iterations: usize,
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
    complete_by(model_of(posture)?, image, clicks)
}

/// As [`complete`], by another model: of the patient, or of films that leave out the patients on whom it is tried.
///
/// # Errors
/// [`CompletionError`].
pub fn complete_by(
    model: &ShapeModel,
    image: &ImageGeometry,
    clicks: &Clicks,
) -> Result<Completion, CompletionError> {
    let placed = PlacedClicks::new(image, clicks)?;
    let Fit { shape, normal, iterations } = fit_to(model, &placed)?;
    let jacobian = shape.jacobian();
    let covariance_mm2 = &jacobian * normal.solve(&jacobian.transpose());
    let corners = shape.corners().map(|body| body.map(|corner| corner + placed.about));
    Ok(Completion { corners, covariance_mm2, iterations })
}

#[cfg(test)]
mod tests;
