//! Cases from tables of landmarks.

use pyo3::prelude::*;
use spineline::analysis::{self, Subject, check_repeated};
use spineline::anatomy::{ImageSide, Posture};
use spineline::error::Error;
use spineline::measure::{Film, ImageGeometry, Spacing, SpacingPlane};
use spineline::spatial::Pixel;
use spineline_files::CaseFile;
use spineline_files::method_text::{named, posture};
use spineline_landmarks::{LandmarkHint, LandmarkReadings, MarkedFilm, parse_landmarks};

use crate::case::Case;
use crate::fault::Fault;

/// Values that a table of landmarks lacks.
struct Given<'a> {
    film: Option<&'a str>,
    mm_per_px: Option<(f64, f64)>,
    patient_left: &'a str,
    size_px: Option<(u32, u32)>,
    plane: &'a str,
}

/// Makes a case from the text of a landmark file.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python hands on what its own keywords are")]
pub fn case_from_landmarks(
    py: Python<'_>,
    text: &str,
    case_id: String,
    film: Option<&str>,
    mm_per_px: Option<(f64, f64)>,
    patient_left: &str,
    size_px: Option<(u32, u32)>,
    plane: &str,
    synthetic: bool,
) -> PyResult<Case> {
    let given = Given { film, mm_per_px, patient_left, size_px, plane };
    let made = || -> Result<Case, Fault> {
        let films = films(text, &given)?;
        check_repeated(&films).map_err(Error::from)?;
        let subject = Subject::default();
        let case = analysis::Case { id: case_id, synthetic, subject, films, lateral: None };
        Case::new(CaseFile::from_case(&case), None)
    };
    made().map_err(|fault| fault.raise(py))
}

fn films(text: &str, given: &Given<'_>) -> Result<Vec<Film>, Fault> {
    let help = "give `film`, such as \"erect\", or a column `posture`";
    let known = given.film.map(|film| posture(film).map_err(|reason| Fault::new(reason, help)));
    let known: Option<Posture> = known.transpose()?;
    let patient_left = side(given.patient_left)?;
    let hint = LandmarkHint {
        posture: known,
        patient_left: Some(patient_left),
        ..LandmarkHint::default()
    };
    let file = parse_landmarks(text.as_bytes(), &hint)?;
    one_film_per_posture(&file.films)?;
    let film = |marked: MarkedFilm| {
        let image = image(&marked, patient_left, given)?;
        Ok(marked.into_film(known, image)?)
    };
    file.films.into_iter().map(film).collect()
}

/// Refuses several pictures for one posture.
fn one_film_per_posture(films: &[MarkedFilm]) -> Result<(), Fault> {
    let is_twice = |(i, film): &(usize, &MarkedFilm)| {
        films[..*i].iter().any(|other| other.posture == film.posture)
    };
    let Some((_, twice)) = films.iter().enumerate().find(is_twice) else { return Ok(()) };
    let names: Vec<&str> = films.iter().filter_map(|film| film.picture.as_deref()).collect();
    let posture = twice.posture.map_or_else(|| "no posture".to_owned(), |p| p.to_string());
    let text = format!(
        "the file has several pictures with {posture}: {}",
        if names.is_empty() { "they have no names".to_owned() } else { names.join(", ") }
    );
    Err(Fault::new(text, "give a file per film, or a table with a column `posture`"))
}

/// The side of the picture that shows the patient's left.
fn side(patient_left: &str) -> Result<ImageSide, Fault> {
    named(patient_left).map_err(|_| {
        let text = format!("`patient_left` is `{patient_left}`");
        Fault::new(text, "give \"image-left\" or \"image-right\"")
    })
}

/// Size and sides of the picture; `None` for locations.
fn image(
    marked: &MarkedFilm,
    patient_left: ImageSide,
    given: &Given<'_>,
) -> Result<Option<ImageGeometry>, Fault> {
    let LandmarkReadings::Corners(readings) = &marked.landmarks else { return Ok(None) };
    let plane =
        given.plane.parse().ok().filter(|plane: &SpacingPlane| *plane != SpacingPlane::Pixels);
    let Some(plane) = plane else {
        let text = format!("`plane` is `{}`", given.plane);
        return Err(Fault::new(text, "give \"patient\", \"detector\" or \"unknown\""));
    };
    let corners = readings.iter().flat_map(|reading| reading.vertebrae.values());
    let corners = corners.flat_map(|vertebra| vertebra.corners.points());
    let crests = marked.iliac_crests.iter().flat_map(|crests| [crests.left, crests.right]);
    let (columns, rows) = given.size_px.unwrap_or_else(|| smallest_size(corners.chain(crests)));
    let spacing = given.mm_per_px.map(|(column, row)| Spacing::stated(column, row, plane));
    Ok(Some(ImageGeometry { columns, rows, spacing, patient_left }))
}

/// The smallest picture that contains all points.
fn smallest_size(points: impl Iterator<Item = Pixel>) -> (u32, u32) {
    // A point beyond the largest picture stays outside of it, and is refused.
    let size = |largest: f64| (largest.max(0.0).ceil() + 1.0).min(f64::from(u32::MAX)) as u32;
    let largest = points.fold((0.0_f64, 0.0_f64), |(column, row), point| {
        (column.max(point.column_px), row.max(point.row_px))
    });
    (size(largest.0), size(largest.1))
}
