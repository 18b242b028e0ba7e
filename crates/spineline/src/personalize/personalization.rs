//! The result of a fit.

use super::Gauge;
use super::start::Start;
use crate::least_squares::FitStatus;

/// Where a multiplier ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StiffnessBound {
    /// Between its bounds.
    Inside,
    /// At the lower bound: the data favour a softer value.
    Lower,
    /// At the upper bound: the data favour a stiffer value.
    Upper,
}

/// The fitted stiffness of one patient for one choice of line.
#[derive(Debug, Clone, PartialEq)]
pub struct Personalization {
    /// `ln α` of the lateral springs per group.
    pub log_multipliers: Vec<f64>,
    /// Where every multiplier ended.
    pub bounds: Vec<StiffnessBound>,
    /// Factor on the springs of all axes; 1 unless a force is known.
    pub absolute_scale: f64,
    /// Per film, in the order given: the load's components.
    pub loads: Vec<Vec<f64>>,
    /// How the minimisation ended.
    pub status: FitStatus,
    /// Iterations of the winning start.
    pub iterations: u32,
    /// Starts that were refined.
    pub starts: u32,
    /// Root mean square of the data's residuals: degrees for Ferguson angles, standard deviations for a shape.
    pub residual_rms: f64,
    /// Variance of the films about the model without a prior: sum of squares over the degrees of freedom, and at least
    /// 1, which is noise alone for a shape and the assumed 1° for Ferguson angles.
    pub variance_factor: f64,
    /// Singular values of the derivative of the data by the unknowns `(ln α, ln F)`: small ones are not identified.
    pub singular_values: Vec<f64>,
    /// The minima in which starts ended, the best first, without those far worse: warm starts for other readings of these films. Their
    /// loads are not yet scaled by a known force.
    pub(crate) minima: Vec<Start>,
}

impl Personalization {
    /// Whether one multiplier alone is inside its bounds, so that the scale constraint and the bounds of the others fix it.
    pub(crate) fn has_one_inside(&self, gauge: Gauge) -> bool {
        let inside = self.bounds.iter().filter(|&&bound| bound == StiffnessBound::Inside);
        gauge != Gauge::FrozenForce && inside.count() == 1 && self.bounds.len() > 1
    }

    /// Its end as a start.
    pub(crate) fn as_start(&self) -> Start {
        let unscaled =
            |load: &Vec<f64>| load.iter().map(|part| part / self.absolute_scale).collect();
        Start {
            log_multipliers: self.log_multipliers.clone(),
            loads: self.loads.iter().map(unscaled).collect(),
        }
    }
}
