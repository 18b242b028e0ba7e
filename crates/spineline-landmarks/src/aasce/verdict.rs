use spineline::anatomy::{ImageSide, Level, Posture};
use spineline::clinical::largest_tilt_difference;
use spineline::measure::{FilmLandmarks, ImageGeometry, MeasureError, TiltRule, measure_film};
use spineline::spatial::Angle;
use spineline::warning::{WarningCode, Warnings};

use crate::{LandmarkError, LandmarkReadings, MarkedFilm};

/// Result of the checks of a film's landmarks.
#[derive(Debug, Clone, PartialEq)]
pub enum AasceVerdict {
    /// No findings.
    Clean {
        /// The main angle as the set defines it: the range, over T1 to L5, of the tilt of the mean endplates, without a
        /// T1 or L5 that an analysis leaves out.
        main_angle: Angle,
    },
    /// The film needs a manual check.
    Faults(Vec<AasceFault>),
}

/// A finding on a film's landmarks.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AasceFault {
    /// No vertebra can be measured.
    #[error("{0}")]
    Marks(MeasureError),
    /// Two neighbours are so near or far, for this spine, that one may be doubled or skipped.
    #[error("{message}")]
    Spacing {
        /// The upper one.
        superior: Level,
        /// Description.
        message: String,
    },
}

/// Judges a film of the set by the checks that every film of a case goes through, and computes its main angle if it is clean.
///
/// # Errors
/// [`LandmarkError::Needs`] for a film without the size of its picture or without corners.
pub fn judge_aasce(
    film: &MarkedFilm,
    patient_left: ImageSide,
) -> Result<AasceVerdict, LandmarkError> {
    let help = "give a film of an AASCE folder with its pictures or `image_sizes.csv`";
    let needs = |what| LandmarkError::Needs { format: "a verdict", what, help };
    let (columns, rows) = film.size.ok_or(needs("the size of the picture"))?;
    let LandmarkReadings::Corners(readings) = &film.landmarks else {
        return Err(needs("corners"));
    };
    let image = ImageGeometry { columns, rows, spacing: None, patient_left };
    let landmarks =
        FilmLandmarks::Corners { image, iliac_crests: None, readings: readings.clone() };
    let posture = film.posture.unwrap_or(Posture::Erect);
    let mut warnings = Warnings::default();
    if let Err(error) = measure_film(
        &spineline::measure::Film::new(posture, landmarks),
        TiltRule::default(),
        &mut warnings,
    ) {
        return Ok(AasceVerdict::Faults(vec![AasceFault::Marks(error)]));
    }
    let odd = warnings.all().iter().filter(|warning| warning.code == WarningCode::SpacingUnusual);
    let faults: Vec<AasceFault> = odd
        .filter_map(|warning| {
            let message = warning.message.clone();
            warning.level.map(|superior| AasceFault::Spacing { superior, message })
        })
        .collect();
    if !faults.is_empty() {
        return Ok(AasceVerdict::Faults(faults));
    }
    let left_out = |level: &Level| {
        let mut all = warnings.all().iter();
        all.any(|warning| {
            warning.code == WarningCode::LevelLeftOut && warning.level == Some(*level)
        })
    };
    let usable = readings.iter().flat_map(|reading| &reading.vertebrae);
    let tilts = usable.filter(|(level, _)| !left_out(level)).map(|(_, landmark)| {
        landmark.corners.map(|corner| image.frontal(corner)).measure_endplate_tilt()
    });
    match largest_tilt_difference(tilts) {
        Some(main_angle) => Ok(AasceVerdict::Clean { main_angle }),
        None => Err(needs("a vertebra")),
    }
}
