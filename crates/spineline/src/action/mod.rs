//! Step 5: the line along which the force acts, in one posture.
//!
//! Candidates are compared on equal terms: through the two inflection segments as they lie in the
//! posture (the paper), parallel to the iliac line through T2 (Petit), the one that is estimated from the
//! rotations ([`crate::personalize::estimate`]), or one that the user gives.
//!
//! # References
//! [jalalian-loa], section 3.1 and figure 7; [petit-2004].

mod line_kind;

pub use line_kind::LineKind;

use crate::anatomy::named;
use crate::number::fixed;
use crate::spatial::{Angle, Frontal};

named! {
    /// Where the force is applied.
    pub enum Application {
        /// Along a line fixed in space, carried by rigid T2: a constant spatial wrench.
        Fixed = "fixed",
        /// At T2's midpoint, wherever that goes, in a direction fixed in space.
        AtT2 = "at_t2",
    }
}

/// A line of action in the frontal plane of `G`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOfAction {
    /// A point of the line (in posture `P`, for a line that moves with T2).
    pub point: Frontal,
    /// Unit vector along which a positive force pulls: cranial, or to the patient's left for a horizontal line.
    pub direction: Frontal,
    /// How the force is applied.
    pub application: Application,
}

/// Points that give no line.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineError {
    /// Two points nearly in one place.
    #[error(
        "the two inflections are {} mm apart, and the minimum for a line is {} mm",
        fixed(*gap_mm, 1),
        fixed(*limit_mm, 0)
    )]
    TooShort {
        /// Distance between the points.
        gap_mm: f64,
        /// The least distance.
        limit_mm: f64,
    },
}

impl LineOfAction {
    /// Points nearer than this give a direction that landmark noise turns by degrees.
    pub const MIN_GAP_MM: f64 = 20.0;

    /// The line through two points, from the caudal to the cranial one.
    ///
    /// # Accuracy
    /// Independent point errors of deviation `s` turn the line by about `s √2 / gap` rad.
    ///
    /// # Errors
    /// [`LineError::TooShort`] where the points are nearer than [`Self::MIN_GAP_MM`].
    ///
    /// ```
    /// use spineline::{action::LineOfAction, spatial::Frontal};
    /// let line = LineOfAction::through(Frontal::new(0.0, 100.0), Frontal::new(0.0, 200.0))?;
    /// // 50 N along it turn a joint that lies 10 mm to the patient's left by 500 N·mm to the left (about -X).
    /// assert_eq!(50.0 * line.lever_arm_mm(Frontal::new(10.0, 0.0)), -500.0);
    /// # Ok::<(), spineline::action::LineError>(())
    /// ```
    pub fn through(caudal: Frontal, cranial: Frontal) -> Result<Self, LineError> {
        let gap = cranial - caudal;
        let gap_mm = gap.norm_mm();
        if gap_mm.is_nan() || gap_mm < Self::MIN_GAP_MM {
            return Err(LineError::TooShort { gap_mm, limit_mm: Self::MIN_GAP_MM });
        }
        let direction = gap * (1.0 / gap_mm);
        Ok(Self { point: caudal, direction, application: Application::Fixed })
    }

    /// The line through T2 along the iliac line, towards the patient's left.
    #[must_use]
    pub fn along_iliac(t2: Frontal, iliac_normal: Option<Angle>) -> Self {
        let cranial = Frontal::leaning(iliac_normal.unwrap_or(Angle::ZERO));
        // A quarter turn about -X carries cranial to the patient's left.
        let direction = Frontal::new(cranial.z_mm, -cranial.y_mm);
        Self { point: t2, direction, application: Application::AtT2 }
    }

    /// A line fixed in space through a point, with a given lateral tilt from the cranial direction.
    #[must_use]
    pub fn leaning(point: Frontal, tilt: Angle) -> Self {
        Self { point, direction: Frontal::leaning(tilt), application: Application::Fixed }
    }

    /// The line where all lengths are multiplied by a factor.
    #[must_use]
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { point: self.point * factor, ..self }
    }

    /// Lever arm about a point: moment about +X of a unit force along the line.
    #[must_use]
    pub fn lever_arm_mm(&self, about: Frontal) -> f64 {
        (self.point - about).cross(self.direction)
    }

    /// The points of a polyline from which the line passes to its other side, each the nearer end of its step.
    ///
    /// A step that ends on the line does not count.
    #[must_use]
    pub fn crossings(&self, points: &[Frontal]) -> Vec<usize> {
        let arms: Vec<f64> = points.iter().map(|&point| self.lever_arm_mm(point)).collect();
        let crosses = |&step: &usize| arms[step] * arms[step + 1] < 0.0;
        let nearer = |step: usize| step + usize::from(arms[step + 1].abs() < arms[step].abs());
        (0..points.len().saturating_sub(1)).filter(crosses).map(nearer).collect()
    }

    /// Where the line crosses a height, in mm to the patient's left; infinite for a line that runs along the height.
    #[must_use]
    pub fn y_mm_at(&self, z_mm: f64) -> f64 {
        self.point.y_mm + (z_mm - self.point.z_mm) * self.direction.y_mm / self.direction.z_mm
    }

    /// Lateral tilt of the line, from the cranial direction.
    #[must_use]
    pub fn lateral_tilt(&self) -> Angle {
        self.direction.lateral_tilt()
    }

    /// Angle between two lines, whichever way they point, in [0, 90°].
    #[must_use]
    pub fn angle_to(&self, other: &Self) -> Angle {
        let sin = self.direction.cross(other.direction).abs();
        Angle::from_sin_cos(sin, self.direction.dot(other.direction).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_crosses_an_arch_twice_and_a_point_on_it_is_no_crossing() {
        // y = z (4 - z): the vertical line y = 2 is crossed at z = 0.59 and 3.41; y = 4 touches the top.
        let arch: Vec<Frontal> =
            (0..=4).map(f64::from).map(|z| Frontal::new(z * (4.0 - z), z)).collect();
        let upright = |y_mm| LineOfAction::leaning(Frontal::new(y_mm, 0.0), Angle::ZERO);
        assert_eq!(upright(2.0).crossings(&arch), [1, 3]);
        assert_eq!(upright(4.0).crossings(&arch), [0; 0]);
        assert_eq!(upright(2.0).crossings(&arch[..1]), [0; 0]);
    }
}
