//! Texts of clinical curves.

use spineline::analysis::Analysis;
use spineline::anatomy::Posture;
use spineline::clinical::{ClinicalCurve, convex_side};
use spineline::spatial::Angle;

use crate::api::{CurveSummary, Wire};

/// Size of a curve in a posture, positive in the direction of the erect curve, negative if the curve is reversed.
pub fn size_of(curve: &ClinicalCurve, posture: Posture) -> Option<Angle> {
    let sign = if curve.erect_size().rad() < 0.0 { -1.0 } else { 1.0 };
    curve.size_in(posture).map(|angle| angle * sign)
}

/// One curve, such as `main thoracic, T5–T12, Cobb angle 48.2°, convex to the patient's right`.
pub fn curve_text(curve: &ClinicalCurve, posture: Posture, angle: Angle) -> String {
    let ends = format!("{}–{}", curve.ends.superior, curve.ends.inferior);
    let shown = curve.size_in(posture).filter(|size| size.shown_side().is_some());
    let side = shown.and_then(convex_side);
    let convex = side.map_or_else(String::new, |side| {
        let turned = if angle.rad() < 0.0 { " (reversed)" } else { "" };
        format!(", convex to the patient's {side}{turned}")
    });
    format!("{}, {ends}, {} {}{convex}", curve.region, curve.size_name(), angle.abs())
}

pub fn summary_of(analysis: &Analysis) -> Option<CurveSummary> {
    let curve = analysis.movement.main_curve()?;
    let size = curve.erect_size().abs();
    let lenke = analysis.movement.lenke.map(|lenke| lenke.number.to_string());
    let kind = lenke.as_ref().map_or_else(String::new, |number| format!("Lenke {number}, "));
    let side = curve.convex.filter(|_| size.shown_side().is_some());
    let convex = side.map_or_else(String::new, |side| format!(" convex {side}"));
    let ends = format!("{}–{}", curve.ends.superior, curve.ends.inferior);
    let name = if curve.has_cobb() { "" } else { "tilt range " };
    Some(CurveSummary {
        size_deg: size.deg(),
        is_cobb: curve.has_cobb(),
        region: curve.region.to_string(),
        convex: curve.convex.map(Wire),
        text: format!("{kind}{} {name}{size}{convex} ({ends})", curve.region),
        lenke,
    })
}
