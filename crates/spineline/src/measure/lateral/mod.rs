//! A lateral film → location and pitch of every vertebra on it: what no frontal film shows.

mod outline;

pub use outline::{LateralOutline, LateralVertebra};

use std::borrow::Cow;

use super::bodies::ReadBodies;
use super::copies::{Mark, all_same, as_one, warn_of_copies};
use super::corner_order::{MIRRORED, PLACES};
use super::film_checks::{check_observers, check_pixels};
use super::lengths::FilmSizes;
use super::order::{LevelStep, MIN_SPACING_SHARE};
use super::placing::{are_named_downwards, cranial_of, in_all, runs_down};
use super::plausibility::warn_of_corners;
use super::rounding::warn_of_rounded_corners;
use super::{
    CornerFault, Corners, Film, FilmPlace, ImageGeometry, MeasureError, MeasureFault, Placement,
    Reading, ReadingId, VertebraLandmarks,
};
use crate::anatomy::{FilmView, Level};
use crate::spatial::{Angle, Frontal, Pixel};
use crate::warning::{WarningCode, Warnings};

/// Angle by which the thoracic spine must be lordotic, and the lumbar one kyphotic, before front and back are doubted. A flat or slightly
/// reversed part alone is usual in scoliosis (assumption).
const MIN_REVERSED: Angle = Angle::from_deg(10.0);

/// A film from the side, of the standing patient, with the patient's front where a frontal film has the left.
///
/// Its scale and how it hung are found beside the erect film ([`SpatialOutline`](super::SpatialOutline)); the ratio of its
/// spacings is taken as stated.
#[derive(Debug, Clone, PartialEq)]
pub struct LateralFilm {
    /// Its picture: `patient_left` is the side of the picture on which the patient's front is.
    pub image: ImageGeometry,
    /// Whether it was exposed together with the erect film, as biplanar scanners do: then both have one scale and one vertical.
    pub simultaneous: bool,
    /// The readings, whose left corners are the anterior ones; a film without landmarks has none, and the population's profile is used.
    pub readings: Vec<Reading<Corners<Pixel>>>,
}

impl LateralFilm {
    /// Locations and pitches of the marked vertebrae as this film shows them, means over the readings.
    ///
    /// # Errors
    /// [`MeasureError`] names reading, vertebra and fault.
    pub fn measure(&self, warnings: &mut Warnings) -> Result<LateralOutline, MeasureError> {
        self.check_film()?;
        // Anterior is positive, as left is on a frontal film.
        let body = |corners: &Corners<Pixel>| corners.map(|place| self.image.frontal(place));
        let bodies: Vec<ReadBodies<'_>> =
            self.readings.iter().map(|one| ReadBodies::of(one, body)).collect();
        for ReadBodies { id, bodies } in &bodies {
            check_side(id, bodies)?;
            let all: Vec<_> = bodies.iter().map(|(_, body)| *body).collect();
            let of_all = || in_all(FilmView::Lateral, id, &all);
            if are_named_downwards(&all) {
                of_all().map_or(Ok(()), Err)?;
            }
            for (level, body) in bodies {
                check_body(id, *level, body).map_err(|error| of_all().unwrap_or(error))?;
            }
        }
        check_order(&bodies)?;
        let has_scale = self.image.scale().is_some();
        let sizes = FilmSizes::of_bodies(&bodies, has_scale, |typical| typical.superior_depth_mm);
        if let Some(size) = sizes.impossible() {
            return Err(MeasureFault::Length { size }.at(FilmView::Lateral));
        }
        warn_of_corners(FilmView::Lateral, &bodies, warnings);
        warn_of_copies(FilmView::Lateral, &self.readings, warnings);
        for Reading { id, vertebrae } in &self.readings {
            warn_of_rounded_corners(FilmView::Lateral, id, vertebrae.values(), warnings);
        }
        for (code, text) in sizes.doubts() {
            FilmView::Lateral.warn_of_film(code, text, warnings);
        }
        let outline = match as_one(&self.readings) {
            Cow::Borrowed(_) => LateralOutline::of(&bodies, has_scale, self.simultaneous),
            Cow::Owned(once) => {
                let bodies: Vec<_> = once.iter().map(|one| ReadBodies::of(one, body)).collect();
                LateralOutline::of(&bodies, has_scale, self.simultaneous)
            }
        };
        warn_of_reversed_curves(&outline, warnings);
        Ok(outline)
    }

    /// This film, where an original and its copies are one reading.
    pub(crate) fn with_copies_as_one(&self) -> Self {
        Self { readings: as_one(&self.readings).into_owned(), ..*self }
    }

    /// Whether one of its readings has the corners of a reading of a frontal film, whose left ones are the anterior or the posterior ones.
    pub(crate) fn has_corners_of(&self, film: &Film) -> bool {
        let is_copy = |own: &Reading<Corners<Pixel>>, other: &Reading<VertebraLandmarks>| {
            let same = |order: [usize; 4]| {
                all_same(own.vertebrae.iter().filter_map(|(level, corners)| {
                    let given = other.vertebrae.get(level)?.corners.points();
                    corners.is_same(&order.map(|place| given[place]).into())
                }))
            };
            same(PLACES) || same(MIRRORED)
        };
        let of_film = film.landmarks.corner_readings();
        self.readings.iter().any(|own| of_film.iter().any(|other| is_copy(own, other)))
    }

    /// What a frontal film is refused for too: observers, spacing, and landmarks outside of the picture.
    fn check_film(&self) -> Result<(), MeasureError> {
        check_pixels(FilmView::Lateral, self.image.spacing)?;
        check_observers(FilmView::Lateral, &self.readings)?;
        let ImageGeometry { columns, rows, .. } = self.image;
        for reading in &self.readings {
            for (&level, corners) in &reading.vertebrae {
                let outside =
                    corners.points().into_iter().find(|&corner| !self.image.contains(corner));
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
}

/// Refuses a reading in which front and back are exchanged in all bodies: the side of the film is wrong, and not the vertebrae.
fn check_side(id: &ReadingId, bodies: &[(Level, Corners<Frontal>)]) -> Result<(), MeasureError> {
    let count = bodies.len();
    let cranial = cranial_of(bodies.iter().map(|(_, body)| body.centre()));
    let is_exchanged = |body: &Corners<Frontal>| {
        body.measure_location().is_ok() && body.points_along(cranial) && !body.sides_agree()
    };
    // A spine that lies across the picture has another fault.
    let is_across = cranial.y_mm.abs() >= cranial.z_mm.abs();
    if count < 2 || is_across || !bodies.iter().all(|(_, body)| is_exchanged(body)) {
        return Ok(());
    }
    let fault = if runs_down(cranial) {
        MeasureFault::RowsFromBottom { count }
    } else {
        MeasureFault::LateralMirrored { count }
    };
    Err(fault.at(FilmPlace::reading(FilmView::Lateral, id)))
}

/// Refuses corners that make no body, or one that lies the wrong way round.
fn check_body(id: &ReadingId, level: Level, body: &Corners<Frontal>) -> Result<(), MeasureError> {
    let place = || FilmPlace::vertebra(FilmView::Lateral, id, level);
    let fault = |fault| Err(MeasureFault::LateralCorners { fault }.at(place()));
    match body.measure_location() {
        Err(found) => fault(found),
        Ok(_) if !body.points_along(Frontal::new(0.0, 1.0)) => fault(CornerFault::UpsideDown),
        Ok(_) if !body.sides_agree() => fault(CornerFault::SidesExchanged),
        Ok(_) => Ok(()),
    }
}

/// Warns where both curves of the side view are reversed, as where front and back of the whole film are exchanged.
fn warn_of_reversed_curves(outline: &LateralOutline, warnings: &mut Warnings) {
    // The turn of the film adds the same to all pitches.
    let flexion = |lowest: Level, highest: Level| {
        let mut marked =
            outline.vertebrae.iter().filter(|one| (lowest..=highest).contains(&one.level));
        let (low, high) = (marked.next()?, marked.next_back()?);
        let part = format!("from {} to {}", low.level, high.level);
        Some((part, (high.pitch - low.pitch).wrapped()))
    };
    let thoracic = flexion(Level::T12, Level::T5).filter(|(_, angle)| -*angle > MIN_REVERSED);
    let lumbar = flexion(Level::L5, Level::L1).filter(|(_, angle)| *angle > MIN_REVERSED);
    let Some(((thoracic, lordosis), (lumbar, kyphosis))) = thoracic.zip(lumbar) else { return };
    let text = format!(
        "the spine is lordotic by {} {thoracic} and kyphotic by {} {lumbar} (limit {} each): front and back may be exchanged; check `patient_anterior` and the labels",
        lordosis.abs().text(0),
        kyphosis.text(0),
        MIN_REVERSED.text(0)
    );
    FilmView::Lateral.warn_of_film(WarningCode::LateralLooksMirrored, text, warnings);
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
