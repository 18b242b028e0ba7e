use serde_json::{Value, json};
use spineline::measure::{CornerName, Film, FilmLandmarks, Origin};
use spineline::spatial::Pixel;

use super::{Description, SlicerFrame};
use crate::LandmarkExportError;
use crate::film::stated_origins;
use crate::names::PointName;

const SCHEMA: &str = "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#";

/// The point lists of one film: one per reading, and one for the iliac crests.
pub fn write(film: &Film) -> Result<String, LandmarkExportError> {
    let FilmLandmarks::Corners { image, iliac_crests, readings } = &film.landmarks else {
        return Err(LandmarkExportError::NoCorners(film.posture));
    };
    let steps = image.scale().map_or([1.0, 1.0], |s| [s.column_mm, s.row_mm]);
    let mut lists = Vec::new();
    for (place, reading) in readings.iter().enumerate() {
        let description = Description {
            spineline: 1,
            film: film.posture.key().to_owned(),
            observer: reading.id.observer.clone(),
            repeat: reading.id.repeat,
            frame: SlicerFrame::Image,
            spacing_mm: Some(steps),
            origin: None,
        };
        let mut points = Vec::new();
        // The crests belong to the film; its first list carries them.
        if let Some(crests) = iliac_crests.filter(|_| place == 0) {
            points.push((PointName::CrestLeft, crests.left, None));
            points.push((PointName::CrestRight, crests.right, None));
        }
        for (&level, landmark) in &reading.vertebrae {
            let origins = stated_origins(landmark);
            points.extend(CornerName::ALL.into_iter().map(|corner| {
                let origin = origins.map(|origins| origins[corner as usize]);
                (PointName::Corner(level, corner), corner.of(&landmark.corners), origin)
            }));
        }
        lists.push(list(&description, &points, steps)?);
    }
    if lists.is_empty() {
        return Err(LandmarkExportError::Nothing { what: format!("{} film", film.posture) });
    }
    let file = json!({ "@schema": SCHEMA, "markups": lists });
    let mut text = serde_json::to_string_pretty(&file)
        .map_err(|error| LandmarkExportError::Encode(error.to_string()))?;
    text.push('\n');
    Ok(text)
}

fn list(
    about: &Description,
    points: &[(PointName, Pixel, Option<Origin>)],
    [column_mm, row_mm]: [f64; 2],
) -> Result<Value, LandmarkExportError> {
    let control = points
        .iter()
        .enumerate()
        .map(|(place, (name, point, origin))| {
            let origin = origin.map(|origin| origin.key().to_owned());
            let description = serde_json::to_string(&Description { origin, ..about.clone() })
                .map_err(|error| LandmarkExportError::Encode(error.to_string()))?;
            Ok(json!({
                "id": (place + 1).to_string(),
                "label": name.to_string(),
                "description": description,
                "associatedNodeID": "",
                "position": [column_mm * point.column_px, row_mm * point.row_px, 0.0],
                "orientation": [-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0],
                "selected": true,
                "locked": false,
                "visibility": true,
                "positionStatus": "defined",
            }))
        })
        .collect::<Result<Vec<Value>, LandmarkExportError>>()?;
    Ok(json!({
        "type": "Fiducial",
        "name": format!("{} {} {}", about.film, about.observer, about.repeat),
        "coordinateSystem": "LPS",
        "coordinateUnits": "mm",
        "locked": false,
        "fixedNumberOfControlPoints": false,
        "labelFormat": "%N-%d",
        "controlPoints": control,
    }))
}
