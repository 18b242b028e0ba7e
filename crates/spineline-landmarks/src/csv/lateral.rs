use csv::{Terminator, WriterBuilder};
use spineline::measure::{LateralCorners, LateralFilm, Reading};

use super::columns::View;
use super::read::parse;
use super::write::{cells, start};
use super::{LATERAL_CORNERS, OBSERVER, REPEAT, VERTEBRA};
use crate::{LandmarkError, LandmarkExportError, LandmarkHint, LandmarkReadings};

/// Reads the readings of a lateral film from the bytes of its table.
///
/// # Errors
/// [`LandmarkError`], as [`parse_csv`](super::parse_csv).
pub fn parse_lateral_csv(
    bytes: &[u8],
    hint: &LandmarkHint,
) -> Result<Vec<Reading<LateralCorners>>, LandmarkError> {
    // The front is in place of the left of a frontal table.
    let file = parse(bytes, hint, View::Lateral)?;
    let mut readings = Vec::new();
    for film in file.films {
        let LandmarkReadings::Corners(found) = film.landmarks else { continue };
        readings.extend(found.into_iter().map(|reading| {
            Reading {
                id: reading.id,
                vertebrae: reading
                    .vertebrae
                    .into_iter()
                    .map(|(level, landmark)| {
                        let [
                            superior_anterior,
                            superior_posterior,
                            inferior_anterior,
                            inferior_posterior,
                        ] = landmark.corners.points();
                        let corners = LateralCorners {
                            superior_anterior,
                            superior_posterior,
                            inferior_anterior,
                            inferior_posterior,
                        };
                        (level, corners)
                    })
                    .collect(),
            }
        }));
    }
    Ok(readings)
}

/// The table of a lateral film; commas, points, line feeds.
pub fn write(film: &LateralFilm) -> Result<String, LandmarkExportError> {
    let nothing = || LandmarkExportError::Nothing { what: "lateral film".to_owned() };
    if film.readings.iter().all(|reading| reading.vertebrae.is_empty()) {
        return Err(nothing());
    }
    let mut table = WriterBuilder::new().terminator(Terminator::Any(b'\n')).from_writer(Vec::new());
    let encode = |error: String| LandmarkExportError::Encode(error);
    let heading = [OBSERVER, REPEAT, VERTEBRA].into_iter().chain(LATERAL_CORNERS);
    table.write_record(heading).map_err(|error| encode(error.to_string()))?;
    for reading in &film.readings {
        for (level, corners) in &reading.vertebrae {
            let places = [
                corners.superior_anterior,
                corners.superior_posterior,
                corners.inferior_anterior,
                corners.inferior_posterior,
            ];
            let row = start(reading, level.name())?.into_iter().chain(cells(places));
            table.write_record(row).map_err(|error| encode(error.to_string()))?;
        }
    }
    let bytes = table.into_inner().map_err(|error| encode(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| encode(error.to_string()))
}
