use std::collections::BTreeMap;

use serde::Deserialize;
use spineline::anatomy::ImageSide;
use spineline::measure::{CornerName, Corners, Origin, Reading};
use spineline::number::fixed;
use spineline::spatial::{Angle, Pixel};

use super::FLAG;
use crate::error::{CORRECT, GIVE_SIDE};
use crate::film::{HALF_PIXEL, Points, origin, pixel};
use crate::identity::Identity;
use crate::json::parse_foreign;
use crate::names::{PointName, parse_level, shown};
use crate::number::{Loose, Whole};
use crate::{
    LandmarkError, LandmarkFile, LandmarkFormat, LandmarkHint, LandmarkReadings, MarkedFilm,
};

/// For larger tilts, the next side of a nearly square body may be as high.
const STEEPEST_DEG: f64 = 40.0;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Annotation {
    shapes: Vec<Shape>,
    image_path: Option<String>,
    image_height: Option<Whole>,
    image_width: Option<Whole>,
    #[serde(rename = "spineline")]
    identity: Option<Identity>,
}

#[derive(Deserialize)]
struct Shape {
    label: String,
    /// Empty, or without numbers, if it was not placed.
    points: Option<Vec<Vec<Loose>>>,
    #[serde(default)]
    shape_type: Option<String>,
    /// Confidence of a program.
    #[serde(default)]
    score: Loose,
    #[serde(default)]
    flags: Option<BTreeMap<String, bool>>,
}

impl Shape {
    /// Whether any of its points has coordinates.
    fn is_placed(&self) -> bool {
        let mut numbers = self.points.iter().flatten().flatten();
        numbers.any(|number| number.0.is_some())
    }

    /// At most five of its points, as pixels of Spineline.
    fn places(&self, at: &str) -> Result<Vec<Pixel>, LandmarkError> {
        let place = |numbers: &Vec<Loose>| match numbers[..] {
            [Loose(Some(x)), Loose(Some(y))] => pixel(x - HALF_PIXEL, y - HALF_PIXEL, at),
            _ => Err(LandmarkError::missing(at, "a point of two numbers")),
        };
        self.points.iter().flatten().take(5).map(place).collect()
    }
}

/// Reads an annotation of labelme.
///
/// # Errors
/// [`LandmarkError`], which names the shape.
pub fn parse_labelme(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    let annotation: Annotation = parse_foreign(bytes)?;
    let (mut points, mut remarks) = (Points::default(), Vec::new());
    for (place, shape) in annotation.shapes.iter().enumerate() {
        let at = format!("shapes[{place}] `{}`", shown(&shape.label));
        if !shape.is_placed() {
            remarks.push(format!("{at} has no coordinates; it was skipped"));
            continue;
        }
        for (name, point) in landmarks_of(shape, hint, &at)? {
            points.insert(name, point, &at)?;
            points.set_confidence(name, shape.score.0, &at)?;
            points.set_origin(name, origin_of(shape, &at)?);
        }
    }
    if points.is_empty() {
        return Err(LandmarkError::missing("shapes", "a landmark"));
    }
    let identity = annotation.identity.unwrap_or_default();
    let landmarks = Reading {
        id: identity.reading(hint, "`spineline`")?,
        vertebrae: points.landmarks("the annotation")?,
    };
    let film = MarkedFilm {
        posture: identity.posture("`spineline`")?.or(hint.posture),
        picture: annotation.image_path.filter(|path| !path.is_empty()),
        size: annotation.image_width.zip(annotation.image_height).map(|(w, h)| (w.0, h.0)),
        iliac_crests: points.iliac_crests("the annotation")?,
        landmarks: LandmarkReadings::Corners(vec![landmarks]),
    };
    remarks.extend(points.remarks());
    Ok(LandmarkFile { format: LandmarkFormat::Labelme, films: vec![film], remarks })
}

/// The origin by a shape's flags that begin with [`FLAG`]; other flags belong to the user.
fn origin_of(shape: &Shape, at: &str) -> Result<Option<Origin>, LandmarkError> {
    let set = shape.flags.iter().flatten().filter(|(_, is_set)| **is_set);
    let keys = set.filter_map(|(flag, _)| flag.strip_prefix(FLAG));
    let found = keys.map(|key| origin(key, at)).collect::<Result<Vec<Origin>, _>>()?;
    match found[..] {
        [] => Ok(None),
        [one] => Ok(Some(one)),
        _ => Err(LandmarkError::Ambiguous {
            at: at.to_owned(),
            reason: "it is flagged with several origins".to_owned(),
            help: CORRECT,
        }),
    }
}

/// The landmark of a point, or the four corners of a quadrilateral.
fn landmarks_of(
    shape: &Shape,
    hint: &LandmarkHint,
    at: &str,
) -> Result<Vec<(PointName, Pixel)>, LandmarkError> {
    let places = shape.places(at)?;
    match (shape.shape_type.as_deref(), &places[..]) {
        (Some("point"), &[point]) => Ok(vec![(PointName::parse(&shape.label, at)?, point)]),
        (Some("polygon") | None, &[a, b, c, d]) => {
            let level = parse_level(&shape.label, at)?;
            let patient_left = hint.patient_left().ok_or(LandmarkError::Needs {
                format: "a quadrilateral of labelme",
                what: "the side of the picture on which the patient's left is",
                help: GIVE_SIDE,
            })?;
            let corners = corners_of([a, b, c, d], patient_left, at)?;
            let names = CornerName::ALL.map(|corner| PointName::Corner(level, corner));
            Ok(names.into_iter().zip(corners).collect())
        }
        (kind, _) => Err(LandmarkError::Syntax {
            at: at.to_owned(),
            reason: format!(
                "a {} of {} points, and only points and polygons of four are landmarks",
                shown(kind.unwrap_or("shape")),
                shape.points.as_ref().map_or(0, Vec::len)
            ),
        }),
    }
}

/// The corners of a quadrilateral around a body, drawn in either direction and from any corner.
fn corners_of(
    points: [Pixel; 4],
    patient_left: ImageSide,
    at: &str,
) -> Result<[Pixel; 4], LandmarkError> {
    if is_crossed(&points) {
        return Err(LandmarkError::Ambiguous {
            at: at.to_owned(),
            reason: "two of its sides cross, so which points are neighbours is not certain"
                .to_owned(),
            help: "draw its points in order around the body",
        });
    }
    let height = |i: usize| points[i].row_px + points[(i + 1) % 4].row_px;
    let top = (0..4).min_by(|&a, &b| height(a).total_cmp(&height(b))).unwrap_or(0);
    let turned = |i: usize| points[(top + i) % 4];
    let is_steep = |a: Pixel, b: Pixel| {
        let (across, down) = ((b.column_px - a.column_px).abs(), (b.row_px - a.row_px).abs());
        // In this form, two equal points count as steep.
        !(down <= Angle::from_deg(STEEPEST_DEG).rad().tan() * across && across > 0.0)
    };
    if is_steep(turned(0), turned(1)) || is_steep(turned(2), turned(3)) {
        return Err(LandmarkError::Ambiguous {
            at: at.to_owned(),
            reason: format!(
                "its uppermost or lowest side is tilted by more than {}°, so which one is the superior endplate \
                 is not certain",
                fixed(STEEPEST_DEG, 0)
            ),
            help: "name its four points instead, as T12_superior_left and so on",
        });
    }
    let ordered = |a: Pixel, b: Pixel| if a.column_px < b.column_px { [a, b] } else { [b, a] };
    let [upper_left, upper_right] = ordered(turned(0), turned(1));
    let [lower_left, lower_right] = ordered(turned(2), turned(3));
    let places = [upper_left, upper_right, lower_left, lower_right];
    Ok(Corners::from_image_sides(places, patient_left).points())
}

/// Whether two sides cross: then the outline turns twice to the left and twice to the right.
fn is_crossed(points: &[Pixel; 4]) -> bool {
    let turns = (0..4).map(|i| {
        let [a, b, c] = [points[i], points[(i + 1) % 4], points[(i + 2) % 4]];
        (b.column_px - a.column_px) * (c.row_px - b.row_px)
            - (b.row_px - a.row_px) * (c.column_px - b.column_px)
    });
    turns.clone().filter(|turn| *turn > 0.0).count() == 2 && turns.filter(|t| *t < 0.0).count() == 2
}
