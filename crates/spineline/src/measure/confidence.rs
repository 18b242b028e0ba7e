//! Confidences of landmarks that a program found.

use super::{
    CornerName, FilmPlace, MeasureError, MeasureFault, Reading, ReadingId, VertebraLandmarks,
};
use crate::anatomy::{Level, Posture};
use crate::number::{fixed, mean};
use crate::warning::{WarningCode, Warnings};

/// Confidence below which a landmark is doubted: the program itself takes it to be as likely wrong as right. How well a
/// program's confidences are calibrated is its own affair (assumption).
const LOW_CONFIDENCE: f64 = 0.5;

/// Largest standard deviation of a corner as a part of the height of its body: a corner that is less certain is none (assumption).
const MAX_SD_SHARE: f64 = 1.0;

/// That confidences are from 0 to 1, and deviations a part of a body.
pub(super) fn check_confidence(
    posture: Posture,
    id: &ReadingId,
    level: Level,
    landmark: &VertebraLandmarks,
) -> Result<(), MeasureError> {
    let place = || FilmPlace::vertebra(posture, id, level);
    let confidences = landmark.confidence.map(|corners| corners.points());
    if let Some(value) = landmark.sd_share.filter(|sd| !(*sd > 0.0 && *sd <= MAX_SD_SHARE)) {
        return Err(MeasureFault::CornerSd { value, most: MAX_SD_SHARE }.at(place()));
    }
    match confidences.into_iter().flatten().find(|value| !(0.0..=1.0).contains(value)) {
        None => Ok(()),
        Some(value) => Err(MeasureFault::Confidence { value }.at(place())),
    }
}

/// A note with the confidences of a reading that has some, and a warning for every vertebra with a low one.
pub(super) fn warn_of_confidence(
    posture: Posture,
    reading: &Reading<VertebraLandmarks>,
    warnings: &mut Warnings,
) {
    let id = &reading.id;
    let bodies = reading.vertebrae.iter();
    // The least confident corner of every vertebra.
    let lowest: Vec<(Level, CornerName, f64)> = bodies
        .filter_map(|(&level, landmark)| {
            let corners = CornerName::ALL.into_iter().zip(landmark.confidence?.points());
            let (corner, value) = corners.min_by(|a, b| a.1.total_cmp(&b.1))?;
            Some((level, corner, value))
        })
        .collect();
    let Some(&(level, _, least)) = lowest.iter().min_by(|a, b| a.2.total_cmp(&b.2)) else { return };
    let all = reading.vertebrae.values().filter_map(|landmark| landmark.confidence);
    let Some(mean) = mean(all.flat_map(|corners| corners.points())) else { return };
    let text = format!(
        "observer {id}: a program found these landmarks, with a mean confidence of {} and a lowest of {} ({level}): check them on the film",
        fixed(mean, 2),
        fixed(least, 2)
    );
    warnings.film(WarningCode::LandmarksByProgram, posture, text);
    for (level, corner, value) in lowest.into_iter().filter(|&(.., value)| value < LOW_CONFIDENCE) {
        let text = format!(
            "observer {id}: the {} corner has a confidence of {} (limit {}): check the four corners of this vertebra on the film",
            corner.key().replace('_', " "),
            fixed(value, 2),
            fixed(LOW_CONFIDENCE, 2)
        );
        warnings.vertebra(WarningCode::LowConfidence, posture, level, text);
    }
}
