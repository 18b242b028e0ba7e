use csv::{Terminator, WriterBuilder};
use spineline::measure::{Film, FilmLandmarks, Reading};
use spineline::spatial::Pixel;

use super::read::guarded;
use super::{AXIS, CONFIDENCES, CORNERS, CRESTS, OBSERVER, PLACED, POSTURE, REPEAT, VERTEBRA};
use crate::LandmarkExportError;

/// The table of some films, all of one kind; commas, points, line feeds.
pub fn write(films: &[&Film]) -> Result<String, LandmarkExportError> {
    let corners = |film: &&Film| matches!(film.landmarks, FilmLandmarks::Corners { .. });
    let marked = films.iter().filter(|film| corners(film)).count();
    if marked != 0 && marked != films.len() {
        return Err(LandmarkExportError::MixedKinds);
    }
    // Columns that no film needs are left out.
    let with_confidence = films.iter().any(|film| has_confidence(film));
    let mut heading = vec![POSTURE, OBSERVER, REPEAT, VERTEBRA];
    if marked > 0 {
        heading.extend(CORNERS);
        heading.push(AXIS);
        if with_confidence {
            heading.extend(CONFIDENCES);
        }
    } else {
        heading.extend(PLACED);
    }
    let mut rows = vec![heading.into_iter().map(str::to_owned).collect()];
    for film in films {
        add_film(film, with_confidence, &mut rows)?;
    }
    let mut table = WriterBuilder::new().terminator(Terminator::Any(b'\n')).from_writer(Vec::new());
    let encode = |error: String| LandmarkExportError::Encode(error);
    for row in rows {
        table.write_record(&row).map_err(|error| encode(error.to_string()))?;
    }
    let bytes = table.into_inner().map_err(|error| encode(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| encode(error.to_string()))
}

fn has_confidence(film: &Film) -> bool {
    let FilmLandmarks::Corners { readings, .. } = &film.landmarks else { return false };
    let mut landmarks = readings.iter().flat_map(|reading| reading.vertebrae.values());
    landmarks.any(|landmark| landmark.confidence.is_some())
}

fn add_film(
    film: &Film,
    with_confidence: bool,
    rows: &mut Vec<Vec<String>>,
) -> Result<(), LandmarkExportError> {
    let posture = film.posture.key();
    match &film.landmarks {
        FilmLandmarks::Corners { iliac_crests, readings, .. } => {
            if let Some(crests) = iliac_crests {
                let mut row =
                    vec![posture.to_owned(), String::new(), String::new(), CRESTS.to_owned()];
                row.extend(cells([crests.left, crests.right]));
                row.extend(vec![String::new(); if with_confidence { 9 } else { 5 }]);
                rows.push(row);
            }
            for reading in readings {
                for (level, landmark) in &reading.vertebrae {
                    let mut row = start(posture, reading, level.name())?;
                    row.extend(cells(landmark.corners.points()));
                    let axis = landmark.axis_clockwise;
                    // As in case files: steps of 0.1° without the rounding of radians.
                    row.push(axis.map_or(String::new(), |axis| {
                        ((axis.deg() * 1e9).round() / 1e9).to_string()
                    }));
                    if with_confidence {
                        let confidences = landmark.confidence.map(|corners| corners.points());
                        row.extend(confidences.map_or_else(Default::default, |values| {
                            values.map(|value| value.to_string())
                        }));
                    }
                    rows.push(row);
                }
            }
        }
        FilmLandmarks::Placements { readings, .. } => {
            for reading in readings {
                for (level, placed) in &reading.vertebrae {
                    let mut row = start(posture, reading, level.name())?;
                    let location = placed.location;
                    row.extend(
                        [location.y_mm, location.z_mm, placed.tilt.deg()].map(|v| v.to_string()),
                    );
                    rows.push(row);
                }
            }
        }
    }
    Ok(())
}

fn start<T>(
    posture: &str,
    reading: &Reading<T>,
    level: &str,
) -> Result<Vec<String>, LandmarkExportError> {
    let name = &reading.id.observer;
    if name.chars().any(char::is_control) {
        let reason = "it holds control characters";
        return Err(LandmarkExportError::Observer {
            name: name.escape_default().to_string(),
            reason,
        });
    }
    if name.trim() != name || name.is_empty() {
        let reason = "it is empty, or begins or ends with a blank";
        return Err(LandmarkExportError::Observer { name: name.clone(), reason });
    }
    // A spreadsheet runs what begins like a formula.
    let observer = if guarded(name) { format!("'{name}") } else { name.clone() };
    Ok(vec![posture.to_owned(), observer, reading.id.repeat.to_string(), level.to_owned()])
}

fn cells<const N: usize>(points: [Pixel; N]) -> impl Iterator<Item = String> {
    points.into_iter().flat_map(|point| [point.column_px, point.row_px]).map(|v| v.to_string())
}
