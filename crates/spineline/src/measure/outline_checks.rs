//! Whether the vertebrae of a film can form a spine, and what its readers should know about them.

use std::collections::BTreeMap;

use super::order::{LevelStep, MIN_SPACING_SHARE};
use super::{
    LengthScale, MeasureError, MeasureFault, MeasuredVertebra, Placement, PlacementSource,
};
use crate::anatomy::{Level, Posture};
use crate::number::fixed;
use crate::spatial::Angle;
use crate::warning::{WarningCode, Warnings};

/// Order and tilts of all marked vertebrae. T1, which no result needs, is left out where it alone is wrong.
pub(super) fn check_marked(
    posture: Posture,
    marked: &mut BTreeMap<Level, MeasuredVertebra>,
    scale: &LengthScale,
    warnings: &mut Warnings,
) -> Result<(), MeasureError> {
    let check = |marked: &BTreeMap<Level, MeasuredVertebra>, warnings: &mut Warnings| {
        let vertebrae: Vec<MeasuredVertebra> = marked.values().copied().collect();
        check_order(posture, &vertebrae, scale, warnings)
    };
    let mut with_t1 = warnings.clone();
    let error = match check(marked, &mut with_t1) {
        Err(error) if error.place().level == Some(Level::T1) => error,
        other => {
            *warnings = with_t1;
            return other;
        }
    };
    marked.remove(&Level::T1);
    check(marked, warnings)?;
    let text = format!(
        "{error}; T1 is left out, as no result needs it: check that the names of the vertebrae are not shifted"
    );
    warnings.vertebra(WarningCode::LevelLeftOut, posture, Level::T1, text);
    Ok(())
}

/// Says of every interpolated vertebra where it comes from, and what it is left out of.
pub(super) fn warn_of_interpolated(
    posture: Posture,
    vertebrae: &[MeasuredVertebra],
    scale: &LengthScale,
    warnings: &mut Warnings,
) {
    for vertebra in vertebrae {
        let Some(found) = vertebra.interpolated else { continue };
        let [below, above] = found.between;
        let text = format!(
            "{} is not marked; it is interpolated between {below} and {above} (standard deviation {} and {}), and takes no part in fits to this film and in location errors{}",
            vertebra.level,
            scale.text(found.location_sd_mm, 1),
            found.tilt_sd,
            if posture == Posture::Erect {
                "; the model's own place of it is as uncertain"
            } else {
                ""
            }
        );
        warnings.vertebra(WarningCode::LevelInterpolated, posture, vertebra.level, text);
    }
}

fn check_order(
    posture: Posture,
    vertebrae: &[MeasuredVertebra],
    scale: &LengthScale,
    warnings: &mut Warnings,
) -> Result<(), MeasureError> {
    const TILT_LIMIT: Angle = Angle::from_deg(120.0);
    if let Some(v) = vertebrae.iter().find(|v| v.tilt.abs() > TILT_LIMIT) {
        let (tilt_deg, limit_deg) = (v.tilt.deg(), TILT_LIMIT.deg());
        let (base, level) = (vertebrae[0].level, v.level);
        return Err(MeasureFault::TiltTooLarge { base, level, tilt_deg, limit_deg }.at(posture));
    }
    let placed: Vec<(Level, Placement)> =
        vertebrae.iter().map(|v| (v.level, Placement::new(v.location, v.tilt))).collect();
    for step in LevelStep::between(&placed) {
        let (inferior, superior, share) = (step.inferior, step.superior, step.share);
        if step.is_out_of_order() {
            let limit = MIN_SPACING_SHARE;
            return Err(MeasureFault::OutOfOrder { inferior, superior, share, limit }.at(posture));
        }
        if step.is_unusual() {
            let text = format!(
                "{inferior} and {superior} are {} apart, {} times the expected distance for this spine: check that no vertebra was skipped or marked twice",
                scale.text(step.distance_mm, 1),
                fixed(step.ratio, 1)
            );
            warnings.vertebra(WarningCode::SpacingUnusual, posture, superior, text);
        }
    }
    Ok(())
}

pub(super) fn warn_of_gaps(
    posture: Posture,
    vertebrae: &[MeasuredVertebra],
    readings: usize,
    warnings: &mut Warnings,
) {
    let incomplete = |v: &&MeasuredVertebra| v.is_measured() && v.readings < readings;
    for vertebra in vertebrae.iter().filter(incomplete) {
        let text = format!(
            "{} was marked in {} of {readings} readings; its mean is over those",
            vertebra.level, vertebra.readings
        );
        warnings.vertebra(WarningCode::ReadingsIncomplete, posture, vertebra.level, text);
    }
}

/// Says of a film that its levels are estimated.
pub(super) fn warn_of_source(posture: Posture, source: PlacementSource, warnings: &mut Warnings) {
    if source == PlacementSource::SurfaceMidline {
        let text = "no vertebra was seen: the levels were placed by arc length on a midline of the back surface, with typical proportions of vertebral heights; locations, tilts and all that follows from them are estimates, and the line is straighter than the spine";
        warnings.film(WarningCode::LevelsEstimated, posture, text);
    }
}
