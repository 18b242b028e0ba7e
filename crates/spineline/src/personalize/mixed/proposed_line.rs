//! A line of action that is proposed for a film, known up to an error.

use nalgebra::{DMatrix, Matrix4, RowVector3, Vector4};

use crate::spatial::{Angle, Frontal};

/// A proposal for the line on one film.
#[derive(Debug, Clone, PartialEq)]
pub enum ProposedLine {
    /// It runs through two points, which are known up to a covariance of `(y, z)` of the first and of the second, in mm².
    Through {
        /// The points.
        points: [Frontal; 2],
        /// Their covariance.
        covariance: Matrix4<f64>,
    },
    /// It has this direction, known up to an angle.
    Along {
        /// A unit vector.
        direction: Frontal,
        /// Standard deviation of its angle.
        sd: Angle,
    },
}

impl ProposedLine {
    /// Numbers of a load `(fy, fz, mx)` that vanish for a force along the line, as rows that multiply the load, and the covariance that the
    /// uncertain line gives them.
    pub(super) fn restrictions(
        &self,
        [fy, fz, _]: [f64; 3],
    ) -> (Vec<RowVector3<f64>>, DMatrix<f64>) {
        match self {
            Self::Through { points, covariance } => {
                // The moment about a point falls with fz to the left and grows with fy upwards.
                let slope = [Vector4::new(-fz, fy, 0.0, 0.0), Vector4::new(0.0, 0.0, -fz, fy)];
                let known = DMatrix::from_fn(2, 2, |i, j| (covariance * slope[j]).dot(&slope[i]));
                (points.map(moment_about).to_vec(), known)
            }
            Self::Along { direction, sd } => {
                let row = RowVector3::new(direction.z_mm, -direction.y_mm, 0.0);
                let along = fy * direction.y_mm + fz * direction.z_mm;
                let known = (along * sd.rad()).powi(2);
                (vec![row], DMatrix::from_element(1, 1, known))
            }
        }
    }
}

/// Moment about a point, of components `(fy, fz, mx)`.
fn moment_about(point: Frontal) -> RowVector3<f64> {
    RowVector3::new(point.z_mm, -point.y_mm, 1.0)
}
