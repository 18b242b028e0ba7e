//! Midlines of the back surface, from surface topography: lines without visible vertebrae.
//!
//! ```json
//! { "midlines": [{ "posture": "erect", "observer": "A", "repeat": 1, "cranial_end": "C7", "caudal_end": "S1",
//!     "axes": ["right", "caudal", "anterior"], "points_mm": [[-57.1, -229.8, 1079.9], [-56.4, -225.1, 1079.5]] }] }
//! ```
//!
//! Points run from the cranial to the caudal end. `axes` names the patient's direction of each coordinate, so sides are
//! never assumed; the depth is optional. Levels are placed by [`Midline::place_levels`].

use std::collections::BTreeMap;

use serde::Deserialize;
use spineline::anatomy::Posture;
use spineline::measure::{Placement, Reading};
use spineline::spatial::Frontal;
use spineline_marking::{Midline, MidlineEnd, MidlinePoint};

use super::identity::Identity;
use super::json::parse_foreign;
use super::names::{coordinate, shown};
use super::{
    LandmarkError, LandmarkFile, LandmarkFormat, LandmarkHint, LandmarkReadings, MarkedFilm,
};

/// Words for directions of axes, with coordinate and sign.
const DIRECTIONS: [(&str, usize, f64); 6] = [
    ("left", 0, 1.0),
    ("right", 0, -1.0),
    ("cranial", 1, 1.0),
    ("caudal", 1, -1.0),
    ("anterior", 2, 1.0),
    ("posterior", 2, -1.0),
];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MidlineFile {
    midlines: Vec<MidlineRecord>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MidlineRecord {
    posture: String,
    observer: Option<String>,
    repeat: Option<u32>,
    cranial_end: String,
    caudal_end: String,
    axes: Vec<String>,
    points_mm: Vec<Vec<f64>>,
}

/// Reads midlines; one film per posture.
///
/// # Errors
/// [`LandmarkError`], which names the midline.
pub fn parse_midlines(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    let file: MidlineFile = parse_foreign(bytes)?;
    let mut films: BTreeMap<Option<Posture>, Vec<Reading<Placement>>> = BTreeMap::new();
    for (place, record) in file.midlines.iter().enumerate() {
        let at = format!("midlines[{place}]");
        let identity = record.identity();
        let readings = films.entry(identity.posture(&at)?).or_default();
        let id = identity.reading(hint, &at)?;
        if readings.iter().any(|reading| reading.id == id) {
            let what = format!("the midline of observer {id} in this posture");
            return Err(LandmarkError::Duplicate { at, what, first: None });
        }
        let placed = record.midline(&at)?.place_levels();
        let vertebrae = placed.map_err(|fault| LandmarkError::Midline { at, fault })?;
        readings.push(Reading { id, vertebrae });
    }
    if films.is_empty() {
        return Err(LandmarkError::missing("midlines", "a midline"));
    }
    let films = films.into_iter().map(|(posture, readings)| MarkedFilm {
        posture,
        picture: None,
        size: None,
        iliac_crests: None,
        landmarks: LandmarkReadings::SurfaceMidlines(readings),
    });
    let remark = "no vertebra was seen: levels were placed by arc length, and are estimates";
    Ok(LandmarkFile {
        format: LandmarkFormat::SurfaceMidlines,
        films: films.collect(),
        remarks: vec![remark.to_owned()],
    })
}

impl MidlineRecord {
    fn identity(&self) -> Identity {
        Identity {
            film: Some(self.posture.clone()),
            observer: self.observer.clone(),
            repeat: self.repeat,
        }
    }

    fn midline(&self, at: &str) -> Result<Midline, LandmarkError> {
        let axes = self.directions(at)?;
        let points = self.points_mm.iter().enumerate().map(|(place, values)| {
            let at = format!("{at}, `points_mm[{place}]`");
            if values.len() != axes.len() {
                let reason = format!("{} numbers, but there are {} axes", values.len(), axes.len());
                return Err(LandmarkError::Syntax { at, reason });
            }
            let mut point = [0.0; 3];
            for (&(part, sign), &value) in axes.iter().zip(values) {
                point[part] = sign * coordinate(value, &at)?;
            }
            let [left_mm, cranial_mm, anterior_mm] = point;
            Ok(MidlinePoint { frontal: Frontal::new(left_mm, cranial_mm), anterior_mm })
        });
        Ok(Midline {
            points: points.collect::<Result<_, _>>()?,
            cranial_end: end(&self.cranial_end, at)?,
            caudal_end: end(&self.caudal_end, at)?,
        })
    }

    /// Coordinate and sign for each value of a point.
    fn directions(&self, at: &str) -> Result<Vec<(usize, f64)>, LandmarkError> {
        let mut axes: Vec<(usize, f64)> = Vec::new();
        for name in &self.axes {
            let known = DIRECTIONS.iter().find(|(word, ..)| word == name);
            let &(_, part, sign) = known.ok_or_else(|| LandmarkError::Choice {
                at: format!("{at}, `axes`"),
                what: "direction",
                name: shown(name),
                known: DIRECTIONS.map(|(word, ..)| word).to_vec(),
            })?;
            axes.push((part, sign));
        }
        let mut parts: Vec<usize> = axes.iter().map(|&(part, _)| part).collect();
        parts.sort_unstable();
        if matches!(parts[..], [0, 1] | [0, 1, 2]) {
            return Ok(axes);
        }
        Err(LandmarkError::Value {
            at: format!("{at}, `axes`"),
            value: shown(&self.axes.join(", ")),
            expected: "one of left and right, one of cranial and caudal, and at most one of anterior and posterior",
        })
    }
}

fn end(name: &str, at: &str) -> Result<MidlineEnd, LandmarkError> {
    name.parse().map_err(|_| LandmarkError::Value {
        at: at.to_owned(),
        value: shown(name),
        expected: "an end of a midline: C7, T1 to L5, or S1",
    })
}
