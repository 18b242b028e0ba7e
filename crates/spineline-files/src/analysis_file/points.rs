//! Points of films, and values by vertebra.

use std::collections::BTreeMap;

use spineline::anatomy::Level;
use spineline::measure::LengthScale;
use spineline::spatial::Frontal;

pub(super) fn point(p: Frontal) -> [f64; 2] {
    [p.y_mm, p.z_mm]
}

/// A point of a film that has a spacing.
pub(super) fn point_mm(scale: &LengthScale, p: Frontal) -> Option<[f64; 2]> {
    Some([scale.mm(p.y_mm)?, scale.mm(p.z_mm)?])
}

/// A point of a film that has none, in pixels.
pub(super) fn point_px(scale: &LengthScale, p: Frontal) -> Option<[f64; 2]> {
    Some([scale.px(p.y_mm)?, scale.px(p.z_mm)?])
}

pub(super) fn by_level<T>(values: impl Iterator<Item = T>, levels: &[Level]) -> BTreeMap<Level, T> {
    levels.iter().copied().zip(values).collect()
}
