use spineline::measure::{Corners, LateralFilm, Reading};
use spineline::spatial::Pixel;

use super::columns::View;
use super::read::parse;
use super::write::{cells, start};
use super::{LATERAL_CORNERS, OBSERVER, REPEAT, VERTEBRA};
use crate::{LandmarkError, LandmarkExportError, LandmarkHint, LandmarkReadings};

/// Reads the readings of a lateral film from the bytes of its table, with the front in place of the left.
///
/// # Errors
/// [`LandmarkError`], as [`parse_csv`](super::parse_csv).
pub fn parse_lateral_csv(
    bytes: &[u8],
    hint: &LandmarkHint,
) -> Result<Vec<Reading<Corners<Pixel>>>, LandmarkError> {
    let file = parse(bytes, hint, View::Lateral)?;
    let mut readings = Vec::new();
    for film in file.films {
        let LandmarkReadings::Corners(found) = film.landmarks else { continue };
        readings.extend(found.into_iter().map(|Reading { id, vertebrae }| {
            let corners = vertebrae.into_iter().map(|(level, landmark)| (level, landmark.corners));
            Reading { id, vertebrae: corners.collect() }
        }));
    }
    Ok(readings)
}

/// The heading and the rows of a lateral film.
pub fn rows(film: &LateralFilm) -> Result<Vec<Vec<String>>, LandmarkExportError> {
    let heading = [OBSERVER, REPEAT, VERTEBRA].into_iter().chain(LATERAL_CORNERS);
    let mut rows = vec![heading.map(str::to_owned).collect()];
    for reading in &film.readings {
        for (level, corners) in &reading.vertebrae {
            let start = start(reading, level.name())?;
            rows.push(start.into_iter().chain(cells(corners.points())).collect());
        }
    }
    if rows.len() == 1 {
        return Err(LandmarkExportError::Nothing { what: "lateral film".to_owned() });
    }
    Ok(rows)
}
