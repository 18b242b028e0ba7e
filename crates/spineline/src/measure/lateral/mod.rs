//! A lateral film → location and pitch of every vertebra on it: what no frontal film shows.

mod outline;

pub use outline::{LateralOutline, LateralVertebra};

use super::bodies::{CheckedFilm, ReadBodies};
use super::corner_order::CornerOrder;
use super::film_checks::{check_observers, check_pixels};
use super::lengths::FilmSizes;
use super::order::{LevelStep, MIN_SPACING_SHARE};
use super::plausibility::warn_of_corners;
use super::{
    CornerFault, Corners, FilmPlace, ImageGeometry, MeasureError, MeasureFault, Placement, Reading,
    ReadingId, Spacing,
};
use crate::anatomy::{FilmView, ImageSide, Level};
use crate::spatial::{Frontal, Pixel};
use crate::warning::Warnings;

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
/// Its scale and how it hung are found beside the erect film ([`SpatialOutline`](super::SpatialOutline)); the ratio of its
/// spacings is taken as stated.
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
    /// Whether it was exposed together with the erect film, as biplanar scanners do: then both have one scale and one vertical.
    pub simultaneous: bool,
    /// The readings; a film without landmarks has none, and the population's profile is used.
    pub readings: Vec<Reading<LateralCorners>>,
}

impl LateralFilm {
    /// How its picture lies, as seen with the front where a frontal film has the left: `patient_left` is the side of the picture on which
    /// the front is.
    #[must_use]
    pub fn geometry(&self) -> ImageGeometry {
        ImageGeometry {
            columns: self.columns,
            rows: self.rows,
            spacing: self.spacing,
            patient_left: self.patient_anterior,
        }
    }

    /// Locations and pitches of the marked vertebrae as this film shows them, means over the readings.
    ///
    /// # Errors
    /// [`MeasureError`] names reading, vertebra and fault.
    pub fn measure(&self, warnings: &mut Warnings) -> Result<LateralOutline, MeasureError> {
        self.check_film()?;
        for reading in &self.readings {
            for (&level, corners) in &reading.vertebrae {
                self.check_body(&reading.id, level, &self.body(corners))
                    .map_err(|error| self.in_all(reading).unwrap_or(error))?;
            }
        }
        let bodies: Vec<ReadBodies<'_>> = self.bodies();
        check_order(&bodies)?;
        let has_scale = self.geometry().scale().is_some();
        let sizes = FilmSizes::of_bodies(&bodies, has_scale, |typical| typical.superior_depth_mm);
        if let Some(size) = sizes.impossible() {
            return Err(MeasureFault::Length { size }.at(FilmView::Lateral));
        }
        warn_of_corners(CheckedFilm::Lateral, &bodies, warnings);
        for (code, text) in sizes.doubts() {
            warnings.push(code, format!("lateral film: {text}"));
        }
        Ok(LateralOutline::of(&bodies, has_scale, self.simultaneous))
    }

    /// The error of corners in another order, where they are in all bodies of a reading.
    fn in_all(&self, reading: &Reading<LateralCorners>) -> Option<MeasureError> {
        let bodies: Vec<Corners<Frontal>> =
            reading.vertebrae.values().map(|corners| self.body(corners)).collect();
        let fault = |order| MeasureFault::LateralCornerOrder { count: bodies.len(), order };
        let place = FilmPlace::reading(FilmView::Lateral, &reading.id);
        CornerOrder::of(&bodies).map(|order| fault(order).at(place))
    }

    /// Refuses corners that make no body, or one that lies the wrong way round.
    fn check_body(
        &self,
        id: &ReadingId,
        level: Level,
        body: &Corners<Frontal>,
    ) -> Result<(), MeasureError> {
        let place = || FilmPlace::vertebra(FilmView::Lateral, id, level);
        let fault = |fault| Err(MeasureFault::LateralCorners { fault }.at(place()));
        match body.measure_location() {
            Err(found) => fault(found),
            Ok(_) if !body.points_along(Frontal::new(0.0, 1.0)) => fault(CornerFault::UpsideDown),
            Ok(_) if !body.sides_agree() => fault(CornerFault::SidesExchanged),
            Ok(_) => Ok(()),
        }
    }

    /// What a frontal film is refused for too: observers, spacing, and landmarks outside of the picture.
    fn check_film(&self) -> Result<(), MeasureError> {
        check_pixels(FilmView::Lateral, self.spacing)?;
        check_observers(FilmView::Lateral, &self.readings)?;
        let (image, columns, rows) = (self.geometry(), self.columns, self.rows);
        for reading in &self.readings {
            for (&level, corners) in &reading.vertebrae {
                let outside = corners.places().into_iter().find(|&corner| !image.contains(corner));
                if let Some(Pixel { column_px, row_px }) = outside {
                    let fault = if column_px.is_finite() && row_px.is_finite() {
                        MeasureFault::OffImage { column_px, row_px, columns, rows }
                    } else {
                        MeasureFault::NotFinite
                    };
                    return Err(fault.at(FilmPlace::vertebra(
                        FilmView::Lateral,
                        &reading.id,
                        level,
                    )));
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
        let image = self.geometry();
        let [superior_left, superior_right, inferior_left, inferior_right] =
            marked.places().map(|place| image.frontal(place));
        Corners { superior_left, superior_right, inferior_left, inferior_right }
    }
}

impl LateralCorners {
    /// The corners, to be moved.
    pub(crate) fn places_mut(&mut self) -> [&mut Pixel; 4] {
        [
            &mut self.superior_anterior,
            &mut self.superior_posterior,
            &mut self.inferior_anterior,
            &mut self.inferior_posterior,
        ]
    }

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
            let place = || FilmPlace::vertebra(FilmView::Lateral, reading.id, level);
            let fault = |fault| MeasureFault::LateralCorners { fault }.at(place());
            let (location, tilt) = (body.measure_location().map_err(fault)?, body.measure_tilt());
            placed.push((level, Placement::new(location, tilt)));
        }
        if let Some(step) =
            LevelStep::between(&placed).into_iter().find(|step| step.is_out_of_order())
        {
            let (inferior, superior, share) = (step.inferior, step.superior, step.share);
            let limit = MIN_SPACING_SHARE;
            let fault = MeasureFault::LateralOutOfOrder { inferior, superior, share, limit };
            return Err(fault.at(FilmPlace::reading(FilmView::Lateral, reading.id)));
        }
    }
    Ok(())
}
