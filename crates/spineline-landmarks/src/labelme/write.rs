use std::collections::BTreeMap;

use serde::Serialize;
use spineline::anatomy::Level;
use spineline::measure::{
    CornerName, IliacCrests, ImageGeometry, Origin, Reading, VertebraLandmarks,
};
use spineline::spatial::Pixel;

use super::FLAG;
use crate::film::{HALF_PIXEL, stated_origins};
use crate::identity::Identity;
use crate::names::PointName;

/// The version of labelme that these files follow.
const VERSION: &str = "5.5.0";

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Annotation<'a> {
    version: &'static str,
    flags: Nothing,
    shapes: Vec<Shape>,
    image_path: &'a str,
    /// The picture within the file: missing.
    image_data: Option<()>,
    image_height: u32,
    image_width: u32,
    spineline: Identity,
}

#[derive(Serialize)]
struct Nothing {}

#[derive(Serialize)]
struct Shape {
    label: String,
    points: [[f64; 2]; 1],
    group_id: Option<()>,
    shape_type: &'static str,
    flags: BTreeMap<String, bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    score: Option<f64>,
}

/// One reading of a film as a file of named points.
pub fn write(
    identity: Identity,
    image: &ImageGeometry,
    picture: &str,
    iliac_crests: Option<IliacCrests>,
    reading: &Reading<VertebraLandmarks>,
) -> String {
    let mut shapes: Vec<Shape> = Vec::new();
    for (&level, landmark) in reading.vertebrae.iter().rev() {
        shapes.extend(corners(level, landmark));
    }
    if let Some(crests) = iliac_crests {
        shapes.push(Shape::new(PointName::CrestLeft, crests.left, None, None));
        shapes.push(Shape::new(PointName::CrestRight, crests.right, None, None));
    }
    let annotation = Annotation {
        version: VERSION,
        flags: Nothing {},
        shapes,
        image_path: picture,
        image_data: None,
        image_height: image.rows,
        image_width: image.columns,
        spineline: identity,
    };
    spineline_files::to_text(&annotation)
}

fn corners(level: Level, landmark: &VertebraLandmarks) -> [Shape; 4] {
    let points = landmark.corners.points();
    let confidences = landmark.confidence.map(|corners| corners.points());
    let origins = stated_origins(landmark);
    std::array::from_fn(|i| {
        let name = PointName::Corner(level, CornerName::ALL[i]);
        let score = confidences.map(|values| values[i]);
        Shape::new(name, points[i], score, origins.map(|origins| origins[i]))
    })
}

impl Shape {
    fn new(name: PointName, point: Pixel, score: Option<f64>, origin: Option<Origin>) -> Self {
        Self {
            label: name.to_string(),
            points: [[point.column_px + HALF_PIXEL, point.row_px + HALF_PIXEL]],
            group_id: None,
            shape_type: "point",
            flags: origin.iter().map(|origin| (format!("{FLAG}{}", origin.key()), true)).collect(),
            score,
        }
    }
}
