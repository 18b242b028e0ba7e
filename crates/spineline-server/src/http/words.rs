//! The library's values in words.

use spineline::anatomy::Side;
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane, SpacingSource};

use super::api::{PlaneName, Wire};

/// What lengths on a picture are measured in.
pub fn plane_of(image: &ImageGeometry) -> PlaneName {
    Wire(image.spacing.map_or(SpacingPlane::Pixels, |spacing| spacing.plane))
}

/// Height of a pixel over its width, 1 where nobody knows.
pub fn pixel_aspect(spacing: Option<Spacing>) -> f64 {
    spacing.map_or(1.0, |spacing| spacing.row_mm / spacing.column_mm)
}

/// A spacing in words, with its source and uncertainty.
pub fn spacing_text(spacing: Option<Spacing>) -> String {
    let Some(spacing) = spacing else { return "no scale: angles only".to_owned() };
    let Spacing { column_mm, row_mm, plane, source, relative_sd } = spacing;
    let mut text = format!("{column_mm:.3} mm × {row_mm:.3} mm, {}", plane.unit());
    if source != SpacingSource::Stated {
        text.push_str(&format!(", {source}"));
    }
    if let Some(sd) = relative_sd {
        text.push_str(&format!(" (± {:.1} %)", 100.0 * sd));
    }
    text
}

/// The patient's side in words, such as `the patient's right`.
pub fn patients(side: Side) -> String {
    format!("the patient's {side}")
}
