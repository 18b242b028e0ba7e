use nalgebra::DMatrix;

use super::Regions;
use crate::anatomy::Region;

/// Which part of every joint lies in which region: a row per joint, caudal first, and a column per region.
///
/// Regions end at inflections, and those lie anywhere between two vertebrae: such a joint has springs of both regions.
#[derive(Debug, Clone, PartialEq)]
pub struct JointShares(pub(crate) DMatrix<f64>);

impl JointShares {
    /// Every joint in one region.
    #[must_use]
    pub fn whole(regions: &Regions) -> Self {
        Self(DMatrix::from_fn(regions.joints(), Region::ALL.len(), |joint, region| {
            f64::from(u8::from(regions.of_joint(joint).index() == region))
        }))
    }

    /// Regions that end at two places along the spine; `vertebrae_mm` belong to the model (L4 to T2), and parts count by length.
    ///
    /// ```
    /// use spineline::{anatomy::Region, clinical::JointShares};
    /// let vertebrae_mm: Vec<f64> = (0..15).map(|i| 30.0 * f64::from(i)).collect();
    /// let shares = JointShares::between(&vertebrae_mm, [100.0, 285.0]);
    /// // A third of the joint between 90 and 120 mm is below the first end.
    /// assert!((shares.of(3, Region::ThoracolumbarLumbar) - 1.0 / 3.0).abs() < 1e-12);
    /// assert!((shares.of(3, Region::MainThoracic) - 2.0 / 3.0).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn between(vertebrae_mm: &[f64], ends_mm: [f64; 2]) -> Self {
        Self(DMatrix::from_fn(vertebrae_mm.len() - 1, Region::ALL.len(), |joint, region| {
            let (from, to) = (vertebrae_mm[joint], vertebrae_mm[joint + 1]);
            let below = |end: f64| ((end - from) / (to - from)).clamp(0.0, 1.0);
            let [low, high] = ends_mm.map(below);
            [low, high - low, 1.0 - high][region]
        }))
    }

    /// The part of a joint that lies in a region.
    #[must_use]
    pub fn of(&self, joint: usize, region: Region) -> f64 {
        self.0[(joint, region.index())]
    }
}
