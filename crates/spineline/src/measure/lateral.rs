//! A lateral film → the sagittal profile: what no frontal film shows.

use std::collections::BTreeMap;

use super::bodies::{CheckedFilm, ReadBodies};
use super::order::{MIN_SPACING_SHARE, steps};
use super::outline::{nameless, repeated};
use super::plausibility::warn_of_corners;
use super::spacing::is_spacing;
use super::{
    CornerFault, Corners, ImageGeometry, MeasureError, Placement, Reading, ReadingId, Spacing,
};
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
    /// Distances between its pixels; `None` where unknown: then pixels are taken as square.
    pub spacing: Option<Spacing>,
    /// The side of the picture on which the patient's front is.
    pub patient_anterior: ImageSide,
    /// The readings; a film without landmarks has none, and the population's profile is used.
    pub readings: Vec<Reading<LateralCorners>>,
}

impl LateralFilm {
    /// The profile of this film: the turn of every joint between two marked vertebrae, mean over the readings; joints
    /// of which a vertebra is not marked keep those of `template`. `None` where no joint could be measured.
    ///
    /// Shoulders often hide T2 to T5 on lateral films.
    ///
    /// # Errors
    /// [`MeasureError::Lateral`] and [`MeasureError::LateralFilm`] name reading, vertebra and fault.
    pub fn measure_profile(
        &self,
        template: &SagittalProfile,
        warnings: &mut Warnings,
    ) -> Result<Option<SagittalProfile>, MeasureError> {
        self.check_film()?;
        let mut pitches: BTreeMap<Level, Vec<Angle>> = BTreeMap::new();
        for reading in &self.readings {
            for (&level, corners) in &reading.vertebrae {
                pitches.entry(level).or_default().push(self.pitch(&reading.id, level, corners)?);
            }
        }
        let bodies: Vec<ReadBodies<'_>> = self.bodies();
        check_order(&bodies)?;
        warn_of_corners(CheckedFilm::Lateral, &bodies, warnings);
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

    /// Sagittal angle of a vertebra's axis, positive in flexion.
    fn pitch(
        &self,
        id: &ReadingId,
        level: Level,
        marked: &LateralCorners,
    ) -> Result<Angle, MeasureError> {
        let fault = |fault| MeasureError::Lateral { id: id.clone(), level, fault };
        let body = self.body(marked);
        body.measure_location().map_err(fault)?;
        if !body.points_along(Frontal::new(0.0, 1.0)) {
            return Err(fault(CornerFault::UpsideDown));
        }
        if !body.sides_agree() {
            return Err(fault(CornerFault::SidesExchanged));
        }
        // A tilt to the positive side is negative.
        Ok(-body.measure_tilt())
    }

    /// What a frontal film is refused for too: observers, spacing, and landmarks outside of the picture.
    fn check_film(&self) -> Result<(), LateralFault> {
        let spacings = self.spacing.map(|s| [("column", s.column_mm), ("row", s.row_mm)]);
        for (direction, value) in spacings.into_iter().flatten() {
            if !is_spacing(value) {
                return Err(LateralFault::Spacing { direction, value });
            }
        }
        if let Some(nameless) = nameless(&self.readings) {
            return Err(LateralFault::NoObserver { repeat: nameless.id.repeat });
        }
        if let Some(twice) = repeated(&self.readings) {
            return Err(LateralFault::DuplicateReading { id: twice.id.clone() });
        }
        let (columns, rows) = (self.columns, self.rows);
        let image = ImageGeometry { columns, rows, spacing: None, patient_left: ImageSide::Left };
        for reading in &self.readings {
            for (&level, corners) in &reading.vertebrae {
                let outside = corners.places().into_iter().find(|&corner| !image.contains(corner));
                if let Some(Pixel { column_px, row_px }) = outside {
                    let id = reading.id.clone();
                    return Err(if column_px.is_finite() && row_px.is_finite() {
                        LateralFault::OffImage { id, level, column_px, row_px, columns, rows }
                    } else {
                        LateralFault::NotFinite { id, level }
                    });
                }
            }
        }
        Ok(())
    }

    fn bodies(&self) -> Vec<ReadBodies<'_>> {
        self.readings.iter().map(|one| ReadBodies::of(one, |marked| self.body(marked))).collect()
    }

    /// A body in millimetres, seen so that the front is on the left: what is positive there is anterior, as left is on a
    /// frontal film.
    fn body(&self, marked: &LateralCorners) -> Corners<Frontal> {
        let [superior_left, superior_right, inferior_left, inferior_right] =
            marked.places().map(|place| self.sagittal(place));
        Corners { superior_left, superior_right, inferior_left, inferior_right }
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

impl LateralCorners {
    fn places(&self) -> [Pixel; 4] {
        [
            self.superior_anterior,
            self.superior_posterior,
            self.inferior_anterior,
            self.inferior_posterior,
        ]
    }
}

/// Every vertebra lies above the next lower one, along the axes of both.
fn check_order(readings: &[ReadBodies<'_>]) -> Result<(), MeasureError> {
    for reading in readings {
        let mut placed = Vec::new();
        for &(level, body) in &reading.bodies {
            let fault = |fault| MeasureError::Lateral { id: reading.id.clone(), level, fault };
            let (location, tilt) = (body.measure_location().map_err(fault)?, body.measure_tilt());
            placed.push((level, Placement::new(location, tilt)));
        }
        if let Some(step) = steps(&placed).into_iter().find(|step| step.is_out_of_order()) {
            let (inferior, superior, share) = (step.inferior, step.superior, step.share);
            let (id, limit) = (reading.id.clone(), MIN_SPACING_SHARE);
            let fault = LateralFault::OutOfOrder { id, inferior, superior, share, limit };
            return Err(fault.into());
        }
    }
    Ok(())
}

/// What is wrong with a lateral film, other than the four corners of one vertebra.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LateralFault {
    /// A reading without the name or code of its observer.
    #[error("lateral film: a reading (repeat {repeat}) has no observer")]
    NoObserver {
        /// Repeat of the reading.
        repeat: u32,
    },
    /// Two readings carry the same observer and repeat.
    #[error("lateral film: the reading of observer {id} is given twice")]
    DuplicateReading {
        /// Reading.
        id: ReadingId,
    },
    /// The distance between pixels is none that a film has.
    #[error(
        "lateral film: {direction} spacing is {value} mm, and must be above 0.0001 mm and at most 5 mm"
    )]
    Spacing {
        /// Which of the two spacings.
        direction: &'static str,
        /// What it is.
        value: f64,
    },
    /// A coordinate is no finite number.
    #[error("lateral film, observer {id}, {level}: a coordinate is not a number")]
    NotFinite {
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
    },
    /// A landmark outside of the picture.
    #[error(
        "lateral film, observer {id}, {level}: a corner at column {column_px}, row {row_px} lies outside of the {columns} × {rows} picture"
    )]
    OffImage {
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
        /// Column of the corner.
        column_px: f64,
        /// Row of the corner.
        row_px: f64,
        /// Columns of the picture.
        columns: u32,
        /// Rows of the picture.
        rows: u32,
    },
    /// A vertebra is marked at or below the next lower one.
    #[error(
        "lateral film, observer {id}: {superior} lies {:.0} % of the expected distance above {inferior}, and the minimum is {:.0} %", 100.0 * share, 100.0 * limit
    )]
    OutOfOrder {
        /// Reading.
        id: ReadingId,
        /// Lower vertebra.
        inferior: Level,
        /// Upper vertebra.
        superior: Level,
        /// How far above along the axes of both, as a part of the usual distance in this spine.
        share: f64,
        /// The least.
        limit: f64,
    },
}

impl LateralFault {
    /// The name that the same fault of a frontal film has.
    pub(super) const fn code(&self) -> &'static str {
        match self {
            Self::NoObserver { .. } => "no_observer",
            Self::DuplicateReading { .. } => "duplicate_reading",
            Self::Spacing { .. } => "spacing",
            Self::NotFinite { .. } => "not_finite",
            Self::OffImage { .. } => "off_image",
            Self::OutOfOrder { .. } => "out_of_order",
        }
    }

    /// What the user can do about it.
    pub(super) const fn help(&self) -> &'static str {
        match self {
            Self::NoObserver { .. } => "name the observer of every reading, or give a code",
            Self::DuplicateReading { .. } => {
                "give each reading of a film its own observer and repeat"
            }
            Self::Spacing { .. } => "state the distance between pixel centres in mm",
            Self::NotFinite { .. } => "mark this vertebra again",
            Self::OffImage { .. } => {
                "corner points are [column, row] in pixels of the full-size picture"
            }
            Self::OutOfOrder { .. } => {
                "check the names of these two vertebrae: one is marked twice, skipped or exchanged"
            }
        }
    }
}
