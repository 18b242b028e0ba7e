use csv::{Terminator, WriterBuilder};
use spineline::measure::{Film, FilmLandmarks, Origin, Reading, VertebraLandmarks};
use spineline::spatial::Pixel;
use spineline_files::{guarded, written_axis_deg};

use super::{
    AXIS, CONFIDENCES, CORNERS, CRESTS, OBSERVER, ORIGINS, PEDICLES, PLACED, POSTURE, REPEAT,
    SD_SHARE, VERTEBRA, WALLS,
};
use crate::LandmarkExportError;
use crate::film::stated_origins;

/// The text of a table; commas, points, line feeds.
pub fn text(rows: &[Vec<String>]) -> Result<String, LandmarkExportError> {
    let mut table = WriterBuilder::new().terminator(Terminator::Any(b'\n')).from_writer(Vec::new());
    let encode = |error: String| LandmarkExportError::Encode(error);
    for row in rows {
        table.write_record(row).map_err(|error| encode(error.to_string()))?;
    }
    let bytes = table.into_inner().map_err(|error| encode(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| encode(error.to_string()))
}

/// The heading and the rows of some films, all of one kind.
pub fn rows(films: &[&Film]) -> Result<Vec<Vec<String>>, LandmarkExportError> {
    let corners = |film: &&Film| matches!(film.landmarks, FilmLandmarks::Corners { .. });
    let marked = films.iter().filter(|film| corners(film)).count();
    if marked != 0 && marked != films.len() {
        return Err(LandmarkExportError::MixedKinds);
    }
    // Columns without values are left out.
    let optional: Vec<Optional> = Optional::ALL
        .into_iter()
        .filter(|part| films.iter().any(|film| part.is_in(film)))
        .collect();
    let mut heading = vec![POSTURE, OBSERVER, REPEAT, VERTEBRA];
    if marked > 0 {
        heading.extend(CORNERS);
        heading.push(AXIS);
        heading.extend(optional.iter().flat_map(|part| part.columns()));
    } else {
        heading.extend(PLACED);
    }
    let mut rows = vec![heading.into_iter().map(str::to_owned).collect()];
    for film in films {
        add_film(film, &optional, &mut rows)?;
    }
    Ok(rows)
}

/// Optional columns, after corners and axes.
#[derive(Clone, Copy)]
enum Optional {
    Confidences,
    Origins,
    Walls,
    Pedicles,
    SdShare,
}

impl Optional {
    const ALL: [Self; 5] =
        [Self::Confidences, Self::Origins, Self::Walls, Self::Pedicles, Self::SdShare];

    fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Confidences => &CONFIDENCES,
            Self::Origins => &ORIGINS,
            Self::Walls => &WALLS,
            Self::Pedicles => &PEDICLES,
            Self::SdShare => &[SD_SHARE],
        }
    }

    /// Whether some vertebra of a film has a value.
    fn is_in(self, film: &Film) -> bool {
        let readings = film.landmarks.corner_readings();
        let mut landmarks = readings.iter().flat_map(|reading| reading.vertebrae.values());
        landmarks.any(|landmark| self.cells(landmark).iter().any(|cell| !cell.is_empty()))
    }

    fn cells(self, landmark: &VertebraLandmarks) -> Vec<String> {
        let four = |values: Option<[String; 4]>| values.unwrap_or_default().to_vec();
        match self {
            Self::Confidences => {
                let values = landmark.confidence.map(|corners| corners.points());
                four(values.map(|values| values.map(|value| value.to_string())))
            }
            Self::Origins => four(
                stated_origins(landmark).map(|origins| origins.map(Origin::key).map(str::to_owned)),
            ),
            Self::Walls => sides(landmark.walls),
            Self::Pedicles => sides(landmark.pedicles),
            Self::SdShare => vec![landmark.sd_share.map_or(String::new(), |sd| sd.to_string())],
        }
    }
}

/// Column and row of the left and of the right place.
fn sides(places: [Option<Pixel>; 2]) -> Vec<String> {
    let cells = |place: Option<Pixel>| match place {
        Some(place) => [place.column_px.to_string(), place.row_px.to_string()],
        None => Default::default(),
    };
    places.into_iter().flat_map(cells).collect()
}

fn add_film(
    film: &Film,
    optional: &[Optional],
    rows: &mut Vec<Vec<String>>,
) -> Result<(), LandmarkExportError> {
    let posture = film.posture.key();
    match &film.landmarks {
        FilmLandmarks::Corners { iliac_crests, readings, .. } => {
            if let Some(crests) = iliac_crests {
                let mut row =
                    vec![posture.to_owned(), String::new(), String::new(), CRESTS.to_owned()];
                row.extend(cells([crests.left, crests.right]));
                let more: usize = optional.iter().map(|part| part.columns().len()).sum();
                row.extend(vec![String::new(); 5 + more]);
                rows.push(row);
            }
            for reading in readings {
                for (level, landmark) in &reading.vertebrae {
                    let mut row = vec![posture.to_owned()];
                    row.extend(start(reading, level.name())?);
                    row.extend(cells(landmark.corners.points()));
                    let axis_deg = landmark.axis_clockwise.map(written_axis_deg);
                    row.push(axis_deg.map_or(String::new(), |deg| deg.to_string()));
                    row.extend(optional.iter().flat_map(|part| part.cells(landmark)));
                    rows.push(row);
                }
            }
        }
        FilmLandmarks::Placements { readings, .. } => {
            for reading in readings {
                for (level, placed) in &reading.vertebrae {
                    let mut row = vec![posture.to_owned()];
                    row.extend(start(reading, level.name())?);
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

/// Observer, repeat and vertebra of a row.
pub(super) fn start<T>(
    reading: &Reading<T>,
    level: &str,
) -> Result<[String; 3], LandmarkExportError> {
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
    Ok([guarded(name).into_owned(), reading.id.repeat.to_string(), level.to_owned()])
}

pub(super) fn cells<const N: usize>(points: [Pixel; N]) -> impl Iterator<Item = String> {
    points.into_iter().flat_map(|point| [point.column_px, point.row_px]).map(|v| v.to_string())
}
