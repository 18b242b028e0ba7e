//! Texts that several results share.

use spineline::measure::{LengthScale, SpacingPlane};

/// The unit of lengths, such as `patient mm`.
pub const fn length_unit(scale: &LengthScale) -> &'static str {
    match scale.plane {
        SpacingPlane::Patient => "patient mm",
        SpacingPlane::Detector => "detector mm",
        SpacingPlane::Unknown => "mm of an unknown plane",
        SpacingPlane::Pixels => "pixels",
    }
}
