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

/// The heading and the rows of a lateral film.
pub fn rows(film: &LateralFilm) -> Result<Vec<Vec<String>>, LandmarkExportError> {
    let heading = [OBSERVER, REPEAT, VERTEBRA].into_iter().chain(LATERAL_CORNERS);
    let mut rows = vec![heading.map(str::to_owned).collect()];
    for reading in &film.readings {
        for (level, corners) in &reading.vertebrae {
            let places = [
                corners.superior_anterior,
                corners.superior_posterior,
                corners.inferior_anterior,
                corners.inferior_posterior,
            ];
            rows.push(start(reading, level.name())?.into_iter().chain(cells(places)).collect());
        }
    }
    if rows.len() == 1 {
        return Err(LandmarkExportError::Nothing { what: "lateral film".to_owned() });
    }
    Ok(rows)
}
