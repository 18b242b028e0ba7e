//! The corners of one reading → midpoints and tilts in the film's own frame.

use std::collections::BTreeMap;

use super::confidence::check_confidence;
use super::corner_order::CornerOrder;
use super::plausibility::fits_exchanged;
use super::{
    CornerFault, Corners, Film, FilmLandmarks, FilmPlace, ImageGeometry, MeasureError,
    MeasureFault, Placement, ProgramCorners, Reading, ReadingId, TiltRule, VertebraLandmarks,
    VertebraOrigin,
};
use crate::anatomy::{FilmView, Level, Posture};
use crate::spatial::Frontal;
use crate::warning::{WarningCode, Warnings};

/// Whether an analysis can do without a vertebra that no model has. T1 is never needed. An L5 beyond the edge of the picture
/// is not either; but one whose corners are wrong may be what a film with shifted names shows, and stays an error.
fn is_needless(level: Level, error: &MeasureError) -> bool {
    match level {
        Level::T1 => true,
        Level::L5 => matches!(error.fault, MeasureFault::OffImage { .. }),
        _ => false,
    }
}

/// The vertebral body of a level in millimetres of the film, whose corners all lie on the picture.
fn body_of(
    posture: Posture,
    image: &ImageGeometry,
    reading: &Reading<VertebraLandmarks>,
    level: Level,
    landmark: &VertebraLandmarks,
) -> Result<Corners<Frontal>, MeasureError> {
    let place = || FilmPlace::vertebra(posture, &reading.id, level);
    let finite = landmark.axis_clockwise.is_none_or(|axis| axis.rad().is_finite());
    if !(finite && landmark.corners.points().iter().all(|corner| corner.is_finite())) {
        return Err(MeasureFault::NotFinite.at(place()));
    }
    check_confidence(posture, &reading.id, level, landmark)?;
    if let Some(corner) =
        landmark.corners.points().into_iter().find(|&corner| !image.contains(corner))
    {
        if fits_exchanged(image, reading) {
            let count = reading.vertebrae.len();
            let place = FilmPlace::reading(posture, &reading.id);
            return Err(MeasureFault::AxesExchanged { count }.at(place));
        }
        let (column_px, row_px) = (corner.column_px, corner.row_px);
        let (columns, rows) = (image.columns, image.rows);
        let fault = MeasureFault::OffImage { column_px, row_px, columns, rows };
        return Err(fault.at(place()));
    }
    Ok(landmark.corners.map(|corner| image.frontal(corner)))
}

/// Warns that T1 or L5 is left out because its landmarks cannot be used.
pub(super) fn warn_of_unusable_ends(film: &Film, warnings: &mut Warnings) {
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else { return };
    for reading in readings
        .iter()
        .filter(|one| one.vertebrae.keys().any(|level| level.model_index().is_none()))
    {
        let mut unusable = Vec::new();
        // What else is wrong has stopped the measurement before.
        let _ = place(film.posture, image, reading, TiltRule::default(), &mut unusable);
        for (level, error) in unusable {
            let text = format!("{error}; {level} is left out, as no result needs it");
            warnings.vertebra(WarningCode::LevelLeftOut, film.posture, level, text);
        }
    }
}

/// The corners of every reading that a program found. Says which vertebrae have corners that no person reviewed, and which completed
/// corners lack the landmarks that they were completed from.
pub(super) fn program_corners(film: &Film, warnings: &mut Warnings) -> Vec<Option<ProgramCorners>> {
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else { return Vec::new() };
    let mut all = Vec::new();
    for reading in readings {
        let id = &reading.id;
        let not_reviewed: Vec<String> = reading
            .vertebrae
            .iter()
            .filter(|(_, landmark)| !landmark.is_reviewed())
            .map(|(level, _)| level.to_string())
            .collect();
        if !not_reviewed.is_empty() {
            let text = format!(
                "observer {id}: corners of {} were found by a program, and no person has accepted or moved them: look at them on the film",
                not_reviewed.join(", ")
            );
            warnings.film(WarningCode::CornersNotReviewed, film.posture, text);
        }
        all.push(ProgramCorners::of(image, Some(film.posture), reading).unwrap_or_else(|error| {
            let text = format!(
                "observer {id}: some corners are said to be completed, but their uncertainty is not known ({error}); they count as clicked ones"
            );
            warnings.film(WarningCode::CompletedWithoutLandmarks, film.posture, text);
            None
        }));
    }
    all
}

/// A vertebral body of a reading whose corners can be used.
struct Body<'a> {
    level: Level,
    landmark: &'a VertebraLandmarks,
    corners: Corners<Frontal>,
    centre: Frontal,
}

/// One reading in millimetres of the film: midpoints and tilts. T1 is absent where its landmarks make no body, and L5 where
/// they lie beyond the picture: their errors are added to `unusable`.
pub(super) fn place(
    posture: Posture,
    image: &ImageGeometry,
    reading: &Reading<VertebraLandmarks>,
    rule: TiltRule,
    unusable: &mut Vec<(Level, MeasureError)>,
) -> Result<BTreeMap<Level, Placement>, MeasureError> {
    let fault = |level, fault| {
        let place = FilmPlace::vertebra(posture, &reading.id, level);
        MeasureFault::Corners { fault }.at(place)
    };
    let mut placed = Vec::with_capacity(reading.vertebrae.len());
    for (&level, landmark) in &reading.vertebrae {
        match body_of(posture, image, reading, level, landmark) {
            Ok(corners) => placed.push((level, landmark, corners)),
            Err(error) if matches!(error.fault, MeasureFault::AxesExchanged { .. }) => {
                return Err(error);
            }
            Err(error) if is_needless(level, &error) => unusable.push((level, error)),
            Err(error) => return Err(error),
        }
    }
    let all: Vec<Corners<Frontal>> = placed.iter().map(|(.., corners)| *corners).collect();
    let mut bodies = Vec::with_capacity(placed.len());
    for (level, landmark, corners) in placed {
        match corners.measure_location() {
            Ok(centre) => bodies.push(Body { level, landmark, corners, centre }),
            Err(found) => {
                let error = fault(level, found);
                if !is_needless(level, &error) {
                    return Err(in_all(posture.into(), &reading.id, &all).unwrap_or(error));
                }
                unusable.push((level, error));
            }
        }
    }
    for (levels, found) in wrong_bodies(posture, image, reading, &bodies)? {
        for level in levels {
            let error = fault(level, found);
            if !is_needless(level, &error) {
                return Err(in_all(posture.into(), &reading.id, &all).unwrap_or(error));
            }
            if let Some(place) = bodies.iter().position(|body| body.level == level) {
                bodies.remove(place);
                unusable.push((level, error));
            }
        }
    }
    // Where what was marked does not complete them, the corners count as placed, with a warning.
    let by_program = ProgramCorners::of(image, Some(posture), reading).ok().flatten();
    let placed =
        bodies.iter().map(|body| (body.level, body.placement(image, rule, by_program.as_ref())));
    Ok(placed.collect())
}

impl Body<'_> {
    fn placement(
        &self,
        image: &ImageGeometry,
        rule: TiltRule,
        by_program: Option<&ProgramCorners>,
    ) -> Placement {
        let Self { level, landmark, corners, centre } = self;
        let by_hand = landmark.axis_clockwise.map(|axis| image.tilt_from_clockwise(axis));
        Placement {
            location: *centre,
            tilt: by_hand.unwrap_or_else(|| rule.tilt_of(corners)),
            endplates: Some(corners.measure_endplates()),
            program: by_program.and_then(|found| found.noise(image, *level, landmark, rule)),
            origin: Some(VertebraOrigin::of(&landmark.origins)),
        }
    }
}

/// The error of names in reverse order, or of corners in another order, where it is in all bodies of a reading.
pub(super) fn in_all(
    view: FilmView,
    id: &ReadingId,
    bodies: &[Corners<Frontal>],
) -> Option<MeasureError> {
    let (place, count) = (FilmPlace::reading(view, id), bodies.len());
    if are_named_downwards(bodies) {
        return Some(MeasureFault::LevelsReversed { count }.at(place));
    }
    let fault = |order| MeasureFault::CornerOrder { view, count, order };
    CornerOrder::of(bodies).map(|order| fault(order).at(place))
}

/// Whether bodies, caudal first by their names, run down the picture, while each of them stands upright in it with its sides in place.
pub(super) fn are_named_downwards(bodies: &[Corners<Frontal>]) -> bool {
    let upright = Frontal::new(0.0, 1.0);
    let stands = |body: &Corners<Frontal>| {
        body.measure_location().is_ok() && body.points_along(upright) && body.sides_agree()
    };
    runs_down(cranial_of(bodies.iter().map(Corners::centre))) && bodies.iter().all(stands)
}

/// Where cranial is on a film, which may be held in any pose: the sum of the steps between the midpoints of the bodies, caudal first,
/// each of length 1, in the film's frontal frame. A single misplaced body does not turn it.
#[must_use]
pub fn cranial_of(midpoints: impl Iterator<Item = Frontal>) -> Frontal {
    let midpoints: Vec<Frontal> = midpoints.collect();
    midpoints.windows(2).fold(Frontal::default(), |sum, pair| {
        let step = pair[1] - pair[0];
        sum + step * (1.0 / step.norm_mm().max(f64::MIN_POSITIVE))
    })
}

/// Whether a spine runs from the top of the picture to its bottom, by its direction from [`cranial_of`].
#[must_use]
pub fn runs_down(cranial: Frontal) -> bool {
    -cranial.z_mm > cranial.y_mm.abs()
}

/// Bodies that are upside down, and bodies whose sides are exchanged; an error where the film is mirrored.
fn wrong_bodies(
    posture: Posture,
    image: &ImageGeometry,
    reading: &Reading<VertebraLandmarks>,
    bodies: &[Body<'_>],
) -> Result<[(Vec<Level>, CornerFault); 2], MeasureError> {
    let (place, count) = (FilmPlace::reading(posture, &reading.id), bodies.len());
    let cranial = cranial_of(bodies.iter().map(|body| body.centre));
    let upside_down = |body: &Body<'_>| bodies.len() > 1 && !body.corners.points_along(cranial);
    let levels_where = |is_wrong: &dyn Fn(&Body<'_>) -> bool| -> Vec<Level> {
        bodies.iter().filter(|body| is_wrong(body)).map(|body| body.level).collect()
    };
    let exchanged = levels_where(&|body| !body.corners.sides_agree());
    let turned = levels_where(&upside_down);
    if exchanged.len() == bodies.len() && bodies.len() > 1 && turned.is_empty() {
        // Exchanged columns and rows mirror the spine too, and lay it across the film.
        if cranial.y_mm.abs() > cranial.z_mm.abs() && fits_exchanged(image, reading) {
            return Err(MeasureFault::AxesExchanged { count }.at(place));
        }
        if runs_down(cranial) {
            return Err(MeasureFault::RowsFromBottom { count }.at(place));
        }
        return Err(MeasureFault::FilmMirrored { count }.at(place));
    }
    Ok([(turned, CornerFault::UpsideDown), (exchanged, CornerFault::SidesExchanged)])
}
