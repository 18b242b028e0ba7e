//! A lateral film → the sagittal profile: what no frontal film shows.

use std::collections::BTreeMap;

use super::{CornerFault, Corners, MeasureError, Reading, ReadingId, Spacing};
use crate::anatomy::{ImageSide, Level, SagittalProfile};
use crate::spatial::{Angle, Frontal, Pixel};
use crate::warning::{Step, Warnings};

/// The four corners of a vertebral body seen from the side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LateralCorners {
    /// Superior endplate, front.
    pub superior_anterior: Pixel,
    /// Superior endplate, back.
    pub superior_posterior: Pixel,
    /// Inferior endplate, front.
    pub inferior_anterior: Pixel,
    /// Inferior endplate, back.
    pub inferior_posterior: Pixel,
}

/// A film from the side, of the standing patient.
///
/// Only angles are taken from it, so its scale does not matter; the ratio of its spacings does.
#[derive(Debug, Clone, PartialEq)]
pub struct LateralFilm {
    /// Number of columns.
    pub columns: u32,
    /// Number of rows.
    pub rows: u32,
    /// Distances between its pixels; `None` where nobody knows them: then pixels are taken as square.
    pub spacing: Option<Spacing>,
    /// The side of the picture on which the patient's front is.
    pub patient_anterior: ImageSide,
    /// The readings; a film that nobody has marked yet has none, and the population's profile is used.
    pub readings: Vec<Reading<LateralCorners>>,
}

impl LateralFilm {
    /// The profile of this film: the turn of every joint between two marked vertebrae, mean over the readings; joints
    /// of which a vertebra is not marked keep those of `template`. `None` where no joint could be measured.
    ///
    /// Shoulders often hide T2 to T5 on lateral films.
    ///
    /// # Errors
    /// [`MeasureError::Lateral`] names reading, vertebra and fault.
    pub fn measure_profile(
        &self,
        template: &SagittalProfile,
        warnings: &mut Warnings,
    ) -> Result<Option<SagittalProfile>, MeasureError> {
        let mut pitches: BTreeMap<Level, Vec<Angle>> = BTreeMap::new();
        for reading in &self.readings {
            for (&level, corners) in &reading.vertebrae {
                pitches.entry(level).or_default().push(self.pitch(&reading.id, level, corners)?);
            }
        }
        let mean = |level: Level| {
            let all = pitches.get(&level)?;
            Some(all.iter().map(|pitch| pitch.rad()).sum::<f64>() / all.len() as f64)
        };
        let mut profile = template.clone();
        let mut missing = Vec::new();
        for (joint, pair) in Level::MODEL.windows(2).enumerate() {
            match mean(pair[0]).zip(mean(pair[1])) {
                Some((below, above)) => {
                    profile.turns_deg[joint] = Angle::from_rad(above - below).deg();
                }
                None => missing.push(format!("{}/{}", pair[0], pair[1])),
            }
        }
        if missing.len() == profile.turns_deg.len() {
            let text =
                "the lateral film is not marked: the sagittal profile is that of a population";
            warnings.push(Step::Measure, "lateral_not_marked", text);
            return Ok(None);
        }
        if !missing.is_empty() {
            let text = format!(
                "the lateral film does not show {}: the sagittal rotations there are those of a population",
                missing.join(", ")
            );
            warnings.push(Step::Measure, "lateral_incomplete", text);
        }
        Ok(Some(profile))
    }

    /// Lean of a vertebra's axis to the front, positive in flexion.
    fn pitch(
        &self,
        id: &ReadingId,
        level: Level,
        marked: &LateralCorners,
    ) -> Result<Angle, MeasureError> {
        let fault = |fault| MeasureError::Lateral { id: id.clone(), level, fault };
        // Seen so that the front is on the left: what is positive there is anterior, as left is on a frontal film.
        let body = Corners {
            superior_left: self.sagittal(marked.superior_anterior),
            superior_right: self.sagittal(marked.superior_posterior),
            inferior_left: self.sagittal(marked.inferior_anterior),
            inferior_right: self.sagittal(marked.inferior_posterior),
        };
        if !body.points().iter().all(|point| point.is_finite()) {
            return Err(fault(CornerFault::Flat));
        }
        body.measure_location().map_err(fault)?;
        if !body.points_along(Frontal::new(0.0, 1.0)) {
            return Err(fault(CornerFault::UpsideDown));
        }
        if !body.sides_agree() {
            return Err(fault(CornerFault::SidesExchanged));
        }
        // A tilt leans away from the positive side.
        Ok(-body.measure_tilt())
    }

    fn sagittal(&self, place: Pixel) -> Frontal {
        let (column_mm, row_mm) = self.spacing.map_or((1.0, 1.0), |s| (s.column_mm, s.row_mm));
        let forward = match self.patient_anterior {
            ImageSide::Left => -1.0,
            ImageSide::Right => 1.0,
        };
        Frontal::new(forward * column_mm * place.column_px, -row_mm * place.row_px)
    }
}
