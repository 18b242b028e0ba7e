//! The loads of best fit, and their estimation.

use nalgebra::{DMatrix, DVector};

use super::super::evidence::FilmEvidence;
use super::covariance::EstimatedCovariance;
use super::equations::{Model, NoLoads};
use crate::clinical::JointShares;

/// Loads of several films that share springs.
#[derive(Debug, Clone, PartialEq)]
pub struct BestFitLoads {
    /// `(fy, fz, mx)` about the origin of `G` per film, in N and N·mm, up to the level of stiffness.
    pub components: Vec<[f64; 3]>,
    /// Standard deviation of `ln` stiffness among the joints of a group, without the random walk along the spine.
    pub joint_log_sd: f64,
    /// All unknowns, where a fit to other readings starts.
    pub(super) unknowns: DVector<f64>,
    /// Covariance of all components, film by film, with the other unknowns free.
    pub(super) covariance: EstimatedCovariance,
}

impl BestFitLoads {
    /// Fits the loads of all films to their joint rotations. `depth_mm` is the sagittal place of the forces; the fit starts from
    /// the one to other readings of the same films, if that is given.
    ///
    /// # Errors
    /// [`NoLoads`].
    pub(crate) fn estimate(
        films: &[&FilmEvidence],
        depth_mm: f64,
        shares: &JointShares,
        start: Option<&Self>,
    ) -> Result<Self, NoLoads> {
        let model = Model::new(films, depth_mm, shares)?;
        let start = start.filter(|start| start.unknowns.len() == model.unknowns());
        let warm = start.map(|start| model.converge(start.unknowns.clone()));
        let (unknowns, at) = match warm {
            Some(Ok(found)) => found,
            _ => model.converge(model.start())?,
        };
        let loads = 3 * films.len();
        let components = unknowns.as_slice()[..loads].chunks_exact(3);
        Ok(Self {
            components: components.map(|load| [load[0], load[1], load[2]]).collect(),
            joint_log_sd: (0.5 * unknowns[unknowns.len() - 3]).exp(),
            covariance: EstimatedCovariance::of(
                &DMatrix::identity(loads, model.effects()),
                films,
                &model,
                &unknowns,
                &at,
            ),
            unknowns,
        })
    }
}
