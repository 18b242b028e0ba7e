//! Names of the interface for things of the library, and words that several views share.

use spineline::action::LineKind;
use spineline::anatomy::Side;
use spineline::measure::{LengthScale, SpacingPlane};

use crate::api::{LineName, SideName};

pub const fn side_name(side: Side) -> SideName {
    match side {
        Side::Left => SideName::Left,
        Side::Right => SideName::Right,
    }
}

/// The interface has no line given by hand.
pub const fn line_name(kind: LineKind) -> Option<LineName> {
    match kind {
        LineKind::Inflection => Some(LineName::InflectionLine),
        LineKind::Iliac => Some(LineName::IliacLine),
        LineKind::Estimated => Some(LineName::EstimatedLine),
        LineKind::Given => None,
    }
}

pub const fn line_kind(name: LineName) -> LineKind {
    match name {
        LineName::InflectionLine => LineKind::Inflection,
        LineName::IliacLine => LineKind::Iliac,
        LineName::EstimatedLine => LineKind::Estimated,
    }
}

/// The unit of lengths, such as `patient mm`.
pub const fn length_unit(scale: &LengthScale) -> &'static str {
    match scale.plane {
        SpacingPlane::Patient => "patient mm",
        SpacingPlane::Detector => "detector mm",
        SpacingPlane::Unknown => "mm of an unknown plane",
        SpacingPlane::Pixels => "pixels",
    }
}
