//! 95 % bands of predicted films, in files.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::anatomy::{Level, Levels, Region};
use spineline::evaluate::Band;
use spineline::spatial::Angle;

use super::points::by_level;

/// How far the measured film can differ from the predicted one, in 95 % of films.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(super) struct BandRecord {
    /// Radius about the predicted location of every vertebra above the base: for one vertebra.
    radius_mm: BTreeMap<Level, f64>,
    /// Half-width of the Ferguson angle, by region.
    ferguson_deg: BTreeMap<Region, f64>,
    /// Half-width of the angle between the end vertebrae, by region.
    tilt_range_deg: BTreeMap<Region, f64>,
}

impl BandRecord {
    pub fn new(band: &Band, levels: Levels) -> Self {
        let above_base = &levels.as_slice()[1..];
        let by_region = |angles: &[Angle; 3]| {
            Region::ALL.into_iter().zip(angles.iter().map(|angle| angle.deg())).collect()
        };
        Self {
            radius_mm: by_level(band.radii_mm.iter().copied(), above_base),
            ferguson_deg: by_region(&band.ferguson),
            tilt_range_deg: by_region(&band.tilt_range),
        }
    }
}
