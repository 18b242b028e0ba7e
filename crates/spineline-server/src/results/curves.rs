//! Texts of clinical curves.

use spineline::analysis::Analysis;
use spineline::anatomy::Posture;
use spineline::clinical::{ClinicalCurve, convex_side};
use spineline::spatial::Angle;

use crate::api::{CurveSummary, Wire};

/// Cobb angle of a posture, positive in the direction of the erect curve; negative if the curve is reversed.
pub fn cobb_of(curve: &ClinicalCurve, posture: Posture) -> Option<Angle> {
    let sign = if curve.cobb_in(Posture::Erect)?.rad() < 0.0 { -1.0 } else { 1.0 };
    curve.cobb_in(posture).map(|angle| angle * sign)
}

/// One curve, such as `main thoracic, T5–T12, Cobb 48.2°, convex to the patient's right`.
pub fn curve_text(curve: &ClinicalCurve, posture: Posture, angle: Angle) -> String {
    let ends = format!("{}–{}", curve.ends.superior, curve.ends.inferior);
    let side = curve.cobb_in(posture).and_then(convex_side);
    let convex = side.map_or_else(String::new, |side| {
        let turned = if angle.rad() < 0.0 { " (reversed)" } else { "" };
        format!(", convex to the patient's {side}{turned}")
    });
    format!("{}, {ends}, Cobb {}{convex}", curve.region, angle.abs())
}

/// The largest curve of an erect spine.
pub fn main_curve(analysis: &Analysis) -> Option<&ClinicalCurve> {
    let size = |curve: &ClinicalCurve| {
        curve.cobb_in(Posture::Erect).map_or(0.0, |angle| angle.abs().rad())
    };
    analysis.clinical.iter().max_by(|a, b| size(a).total_cmp(&size(b)))
}

pub fn summary_of(analysis: &Analysis) -> Option<CurveSummary> {
    let curve = main_curve(analysis)?;
    let cobb = curve.cobb_in(Posture::Erect)?.abs();
    let lenke = analysis.lenke.map(|lenke| lenke.number.to_string());
    let kind = lenke.as_ref().map_or_else(String::new, |number| format!("Lenke {number}, "));
    let convex = curve.convex.map_or_else(String::new, |side| format!(" convex {side}"));
    let ends = format!("{}–{}", curve.ends.superior, curve.ends.inferior);
    Some(CurveSummary {
        cobb_deg: cobb.deg(),
        region: curve.region.to_string(),
        convex: curve.convex.map(Wire),
        text: format!("{kind}{} {cobb}{convex} ({ends})", curve.region),
        lenke,
    })
}
