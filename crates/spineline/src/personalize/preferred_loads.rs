//! The loads of best fit to the rotations, as they were found.

use nalgebra::DMatrix;

use super::random_effects::OwnParts;
use super::tilt_errors::TiltErrors;

/// Loads of several films that share springs.
#[derive(Debug, Clone, PartialEq)]
pub struct PreferredLoads {
    /// `(fy, fz, mx)` about the origin of `G` per film, in N and N·mm, up to the level of stiffness.
    pub components: Vec<[f64; 3]>,
    /// `ln α` of the lateral springs per group.
    pub log_multipliers: Vec<f64>,
    /// Shared shift of the joints' centres up their discs, in thicknesses of the disc.
    pub centres_higher_discs: f64,
    /// Evenness with which joints turn over their length: 0 for hinges, 1 for a rod.
    pub evenness: f64,
    /// Deviation of `ln` stiffness among the joints of a group, of every joint by itself.
    pub joint_log_sd: f64,
    /// Deviation of `ln` stiffness by the random walk along the spine.
    pub trend_log_sd: f64,
    /// Deviation of the joints' centres along the spine about that, in thicknesses of the disc.
    pub centre_sd_discs: f64,
    /// Random effects of the joints, about which the fit is linear.
    pub(super) own: Vec<OwnParts>,
    /// Covariance of all components, film by film, with multipliers free.
    pub(super) covariance: DMatrix<f64>,
    /// Its part from tilts whose variance is estimated.
    pub(super) from_tilts: TiltErrors,
}
