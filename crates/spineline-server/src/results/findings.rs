//! Clinical angles and rotations of a study.

use spineline::analysis::{Analysis, FilmMovement};
use spineline::anatomy::Side;
use spineline::clinical::ClinicalCurve;
use spineline::motion::{Motion, SegmentEstimate};
use spineline::number::fixed;
use spineline::spatial::Angle;
use spineline::warning::counted;

use super::curves::size_of;
use crate::api::{CurveAnglesFinding, CurveFinding, RotationFinding, StudyFindings, Wire};

/// Maximum number of segments per posture in an answer.
const MAX_SEGMENTS: usize = 200;

pub fn of_study(analysis: &Analysis) -> StudyFindings {
    StudyFindings {
        curves: analysis.movement.clinical.iter().map(curve).collect(),
        lenke_text: analysis.lenke_words(),
        balance_text: analysis.balance_words(),
        film_scales_text: analysis.film_scale_words(),
        rotations: analysis.movement.films.iter().filter_map(|p| rotation(analysis, p)).collect(),
        inflections_text: analysis.inflection_words(),
        length_unit: analysis.movement.scale().plane.unit().to_owned(),
    }
}

fn curve(curve: &ClinicalCurve) -> CurveFinding {
    // Both in the direction of the erect curve.
    let sign = if curve.erect_size().rad() < 0.0 { -1.0 } else { 1.0 };
    let angles = curve.ferguson.iter().map(|(posture, ferguson)| CurveAnglesFinding {
        posture: Wire(*posture),
        size_deg: size_of(curve, *posture).map(Angle::deg),
        ferguson_deg: ferguson.deg() * sign,
    });
    CurveFinding {
        region: curve.region.to_string(),
        levels_text: format!("{} – {} – {}", curve.ends.inferior, curve.apex, curve.ends.superior),
        convex: curve.convex.map(Wire),
        size_name: curve.size_name().to_owned(),
        angles: angles.collect(),
        flexibility_text: curve
            .flexibility
            .zip(curve.convex)
            .map(|(part, convex)| flexibility_text(curve.size_name(), part, convex)),
    }
}

fn flexibility_text(name: &str, part: f64, convex: Side) -> String {
    format!("{name} falls by {} % when bending to the {convex}", fixed(100.0 * part, 0))
}

fn rotation(analysis: &Analysis, posture: &FilmMovement) -> Option<RotationFinding> {
    let motion = posture.motion.as_ref()?;
    let scale = analysis.movement.scale();
    let along = |segment: usize| {
        let mm = segment as f64 * analysis.movement.chain.segment_mm;
        scale.px(mm).unwrap_or(mm)
    };
    let stride = motion.rotations.len().div_ceil(MAX_SEGMENTS).max(1);
    let drawn: Vec<usize> = (0..motion.rotations.len()).step_by(stride).collect();
    let millidegrees = |angle: Angle| 1000.0 * angle.deg();
    Some(RotationFinding {
        posture: Wire(posture.outline.posture),
        mean_deg: motion.mean_rotation().deg(),
        along_mm: drawn.iter().map(|&segment| along(segment)).collect(),
        rotation_mdeg: drawn.iter().map(|&k| millidegrees(motion.rotations[k])).collect(),
        texts: texts(motion, posture.inflection_estimates.as_ref()),
        inflections_mm: analysis
            .movement
            .inflection_segments
            .iter()
            .flatten()
            .map(|&k| along(k))
            .collect(),
        least_mm: motion.least.iter().map(|&k| along(k)).collect(),
    })
}

fn texts(motion: &Motion, inflections: Option<&[SegmentEstimate; 2]>) -> Vec<String> {
    let places = ["L2–T9", "T7–T4"];
    let windows = places.iter().zip(motion.least).enumerate();
    let text = |(window, (name, least)): (usize, (&&str, usize))| {
        let turns = motion.rotations.get(least).map_or(0.0, |angle| angle.deg());
        let beside = inflections.map_or_else(String::new, |pair| {
            let SegmentEstimate { segment, distance_segments, rotation, .. } = pair[window];
            format!(
                "; the inflection is segment {segment}, at a distance of {}, and rotates {}°",
                counted(distance_segments, "segment"),
                fixed(rotation.deg(), 4)
            )
        });
        format!("{name}: least-rotating segment {least}, {}°{beside}", fixed(turns, 4))
    };
    windows.map(text).collect()
}
