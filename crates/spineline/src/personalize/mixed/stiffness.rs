//! Mean `ln` stiffness of groups of joints by the mixed model, with its prediction error.
//!
//! # Definition
//! Joint `j` has the `ln` stiffness `k_j` against its nominal spring, and group `G` the mean `m_G` over its `n_G` joints against the mean
//! over the `g` groups:
//!
//! ```text
//! k_j = -delta_j - ln sum_g p_jg / alpha_g,    m_G = 1/n_G sum_(j in G) k_j - 1/g sum_H 1/n_H sum_(j in H) k_j
//! ```
//!
//! # Prediction
//! With the best linear unbiased prediction of `b` and `u` [henderson-1975], its covariance `C^-1` and `l = dm_G/d(b, u)`, the prediction
//! error of `m_G` has the variance `l' C^-1 l`. It contains the noise of tilts, the deviations of joints within a group and the unknown
//! loads.
//!
//! # Line of action
//! A force along a line has no moment about its points. On a film whose line is given these moments `R w` are data: zero, with the covariance
//! that the uncertain points give them.

use nalgebra::{DMatrix, DVector, RowDVector};
use serde::{Deserialize, Serialize};

use super::super::evidence::FilmEvidence;
use super::covariance::EstimatedCovariance;
use super::equations::{Model, NoLoads};
use super::line_test::square_limit;
use super::proposed_line::ProposedLine;
use crate::clinical::JointShares;
use crate::multibody::JointGroups;

/// Predicted mean `ln` stiffness of a group of joints, against the mean over the groups.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GroupStiffness {
    /// Prediction.
    pub log_mean: f64,
    /// Standard deviation of the prediction error.
    pub log_sd: f64,
    /// Half of its 95 % interval.
    pub log_reach: f64,
}

impl GroupStiffness {
    /// Ends of the 95 % interval.
    #[must_use]
    pub fn log_interval_95(self) -> [f64; 2] {
        [self.log_mean - self.log_reach, self.log_mean + self.log_reach]
    }
}

/// Predicts the stiffness of groups from the joint rotations of all films, whose forces act along lines where these are given.
pub(crate) fn predict_stiffness(
    films: &[(&FilmEvidence, Option<ProposedLine>)],
    depth_mm: f64,
    shares: &JointShares,
    groups: &JointGroups,
) -> Result<Vec<GroupStiffness>, NoLoads> {
    let (evidence, lines): (Vec<_>, Vec<_>) = films.iter().cloned().unzip();
    let model = Model::new(&evidence, depth_mm, shares)?.on_lines(lines);
    let (x, at) = model.converge(model.start())?;
    let (of_joint, slopes): (Vec<f64>, Vec<RowDVector<f64>>) =
        model.log_stiffness(&x).into_iter().unzip();
    // Means over the joints of every group, less the mean over the groups.
    let mut parts = DMatrix::from_fn(groups.len(), of_joint.len(), |group, joint| {
        let own = |joint: &usize| *joint == group;
        let size = groups.of_joint().iter().filter(|joint| own(joint)).count();
        f64::from(u8::from(own(&groups.of_joint()[joint]))) / size as f64
    });
    let mean = parts.row_mean();
    parts.row_iter_mut().for_each(|mut row| row -= &mean);
    let means = &parts * DVector::from(of_joint);
    let numbers = parts * DMatrix::from_rows(&slopes);
    let covariance = EstimatedCovariance::of(&numbers, &evidence, &model, &x, &at);
    let of_group = |(group, &log_mean): (usize, &f64)| {
        let own = |whole: &DMatrix<f64>| DMatrix::from_element(1, 1, whole[(group, group)]);
        let variance = covariance.whole[(group, group)];
        let freedom = covariance.freedom(&DMatrix::from_element(1, 1, variance.recip()), own);
        let log_sd = variance.sqrt();
        GroupStiffness { log_mean, log_sd, log_reach: square_limit(freedom).sqrt() * log_sd }
    };
    Ok(means.iter().enumerate().map(of_group).collect())
}
