//! Whether films are compatible with a line of action, and where their own line may run.

use nalgebra::{DMatrix, DVector, Matrix4, RowVector3, Vector4};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::estimate::{EstimatedLine, line_of};
use super::preferred::PreferredLoads;
use crate::spatial::{Angle, Frontal};

/// What is proposed of the line on one film.
#[derive(Debug, Clone, PartialEq)]
pub enum Proposal {
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

/// A test of a proposal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineTest {
    /// Sum of squares of what should vanish, in its standard deviations.
    pub chi_squared: f64,
    /// Numbers that should vanish: 2 for a line, 1 for a direction.
    pub restrictions: u32,
    /// Probability of a larger statistic if the proposal is true.
    pub p_value: f64,
}

/// Where a line may cross a height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Crossing {
    /// Between these places, in mm to the patient's left.
    Between([f64; 2]),
    /// Anywhere, or nearly so: the films do not tell.
    Open,
}

/// Proposals with less probability are rejected.
const SIGNIFICANCE: f64 = 0.05;
/// 95 % of chi-squared on one degree of freedom.
const LIMIT: f64 = 3.841_458_820_694_124;

impl LineTest {
    /// Whether the films reject it, with an error of 5 % if it is true.
    #[must_use]
    pub fn rejects(&self) -> bool {
        self.p_value < SIGNIFICANCE
    }
}

impl PreferredLoads {
    /// The line of one film's load; `None` for a pure couple.
    #[must_use]
    pub fn line(&self, film: usize, near: Frontal) -> Option<EstimatedLine> {
        line_of(self.components.get(film)?, near)
    }

    /// Tests a proposal on one film.
    ///
    /// # Definition
    /// A force along a line has no moment about points of it, and no part across its direction: these numbers are linear in
    /// the load. Their covariance is that of the load and, by the load's force, that of the points or the direction.
    #[must_use]
    pub fn test(&self, film: usize, proposal: &Proposal) -> Option<LineTest> {
        let [fy, fz, mx] = *self.components.get(film)?;
        let (rows, known) = match proposal {
            Proposal::Through { points, covariance } => {
                // The moment about a point falls with fz to the left and grows with fy upwards.
                let slope = [Vector4::new(-fz, fy, 0.0, 0.0), Vector4::new(0.0, 0.0, -fz, fy)];
                let known = DMatrix::from_fn(2, 2, |i, j| (covariance * slope[j]).dot(&slope[i]));
                (points.map(moment_about).to_vec(), known)
            }
            Proposal::Along { direction, sd } => {
                let row = RowVector3::new(direction.z_mm, -direction.y_mm, 0.0);
                let along = fy * direction.y_mm + fz * direction.z_mm;
                let known = (along * sd.rad()).powi(2);
                (vec![row], DMatrix::from_element(1, 1, known))
            }
        };
        let load = RowVector3::new(fy, fz, mx);
        let off = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.dot(&load)));
        let covariance = self.about(film, &rows) + known;
        let chi_squared = off.dot(&(covariance.cholesky()?.inverse() * &off));
        Some(LineTest {
            chi_squared,
            restrictions: rows.len() as u32,
            p_value: ChiSquared::new(rows.len() as f64).ok()?.sf(chi_squared),
        })
    }

    /// Where the film's line may cross a height, with 95 % confidence for this height alone.
    ///
    /// # Definition
    /// All places about which the moment vanishes as far as its test tells (Fieller's set).
    #[must_use]
    pub fn crossing(&self, film: usize, z_mm: f64) -> Option<Crossing> {
        let load = self.components.get(film)?;
        // The moment about (y, z) is a - b y.
        let rows = [RowVector3::new(z_mm, 0.0, 1.0), RowVector3::new(0.0, 1.0, 0.0)];
        let [a, b] = rows.map(|row| row.dot(&RowVector3::from(*load)));
        let c = self.about(film, &rows);
        // (a - b y)² <= limit (c00 - 2 c01 y + c11 y²)
        let square = b * b - LIMIT * c[(1, 1)];
        let half = a * b - LIMIT * c[(0, 1)];
        let rest = a * a - LIMIT * c[(0, 0)];
        let root = half * half - square * rest;
        if square <= 0.0 || root < 0.0 {
            return Some(Crossing::Open);
        }
        Some(Crossing::Between([(half - root.sqrt()) / square, (half + root.sqrt()) / square]))
    }

    /// Covariance of some linear numbers of a film's load.
    fn about(&self, film: usize, rows: &[RowVector3<f64>]) -> DMatrix<f64> {
        let own = self.covariance.fixed_view::<3, 3>(3 * film, 3 * film);
        DMatrix::from_fn(rows.len(), rows.len(), |i, j| (rows[i] * own * rows[j].transpose())[0])
    }
}

/// Moment about a point, of components `(fy, fz, mx)`.
fn moment_about(point: Frontal) -> RowVector3<f64> {
    RowVector3::new(point.z_mm, -point.y_mm, 1.0)
}
