use std::collections::BTreeMap;

use serde::Deserialize;
use spineline::anatomy::{Level, Posture};
use spineline::measure::{
    Corners, IliacCrests, ImageGeometry, Placement, Reading, ReadingId, Spacing, TiltRule,
    VertebraLandmarks,
};
use spineline::number::fixed;
use spineline::spatial::{Frontal, Pixel};
use spineline_files::is_no_number;

use super::{Description, PLANE_TOLERANCE_MM, SlicerFrame};
use crate::film::{Points, merge_crests, named, origin, pixel};
use crate::json::parse_foreign;
use crate::names::{PointName, coordinate, observer, shown};
use crate::number::Loose;
use crate::{
    LandmarkError, LandmarkFile, LandmarkFormat, LandmarkHint, LandmarkReadings, MarkedFilm,
};

#[derive(Deserialize)]
struct MarkupsFile {
    markups: Vec<Markup>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Markup {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default)]
    name: String,
    coordinate_system: Option<serde_json::Value>,
    #[serde(default)]
    coordinate_units: Option<serde_json::Value>,
    #[serde(default)]
    control_points: Vec<ControlPoint>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct ControlPoint {
    #[serde(default)]
    label: String,
    #[serde(default)]
    description: String,
    #[serde(default)]
    position: Position,
    #[serde(default)]
    position_status: Option<String>,
}

/// A position of three numbers, or a missing one: `null`, an empty list or text, invalid numbers.
#[derive(Default)]
struct Position(Option<[f64; 3]>);

impl<'de> Deserialize<'de> for Position {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Spelling {
            Numbers(Vec<Loose>),
            Text(String),
        }
        match Option::<Spelling>::deserialize(deserializer)? {
            None => Ok(Self(None)),
            Some(Spelling::Text(text)) if is_no_number(&text) => Ok(Self(None)),
            Some(Spelling::Numbers(numbers)) => match numbers[..] {
                [] => Ok(Self(None)),
                [Loose(Some(x)), Loose(Some(y)), Loose(Some(z))] => Ok(Self(Some([x, y, z]))),
                [Loose(x), Loose(y), Loose(z)] if x.is_none() || y.is_none() || z.is_none() => {
                    Ok(Self(None))
                }
                _ => Err(serde::de::Error::custom("a position has three numbers")),
            },
            Some(Spelling::Text(_)) => {
                Err(serde::de::Error::custom("a position has three numbers"))
            }
        }
    }
}

/// A place in LPS, in millimetres.
type Lps = [f64; 3];

/// Reads point lists of Slicer.
///
/// The image's frame needs the pixel spacing: from the file if this program wrote it, else from the hint's picture.
///
/// # Errors
/// [`LandmarkError`], which names list and point.
pub fn parse_slicer(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    let file: MarkupsFile = parse_foreign(bytes)?;
    let mut remarks = Vec::new();
    let mut lists: BTreeMap<ListKey, List> = BTreeMap::new();
    for (place, markup) in file.markups.iter().enumerate() {
        let at = format!("markups[{place}] `{}`", shown(&markup.name));
        if markup.kind != "Fiducial" {
            remarks.push(format!(
                "{at} is a {}, not a point list; it was skipped",
                shown(&markup.kind)
            ));
            continue;
        }
        gather(markup, &at, hint, &mut lists, &mut remarks)?;
    }
    lists.retain(|_, list| !list.points.is_empty());
    if lists.is_empty() {
        return Err(LandmarkError::missing("markups", "a point list with a placed point"));
    }
    let mut films: BTreeMap<Option<Posture>, Film> = BTreeMap::new();
    for (key, list) in lists {
        let film = films.entry(key.0).or_default();
        list.add_to(key.1, hint, film)?;
    }
    let films =
        films.into_iter().map(|(posture, film)| film.finish(posture)).collect::<Result<_, _>>()?;
    Ok(LandmarkFile { format: LandmarkFormat::Slicer, films, remarks })
}

/// Lists of one film and reading are read together: some people make one list per vertebra.
type ListKey = (Option<Posture>, ReadingId);

struct List {
    at: String,
    about: Option<Description>,
    points: Points<Lps>,
}

fn gather(
    markup: &Markup,
    at: &str,
    hint: &LandmarkHint,
    lists: &mut BTreeMap<ListKey, List>,
    remarks: &mut Vec<String>,
) -> Result<(), LandmarkError> {
    let signs = signs(markup, at)?;
    let unit_mm = unit_mm(markup, at)?;
    let about = description(markup, at)?;
    let key = list_key(about.as_ref(), at, hint)?;
    let list = lists.entry(key).or_insert_with(|| List {
        at: at.to_owned(),
        about: about.clone(),
        points: Points::default(),
    });
    if list.about != about {
        return Err(LandmarkError::Ambiguous {
            at: at.to_owned(),
            reason: "two lists of one reading differ in frame or spacing".to_owned(),
            help: "give each list as a separate file",
        });
    }
    for (place, point) in markup.control_points.iter().enumerate() {
        let at = format!("{at}, controlPoints[{place}] `{}`", shown(&point.label));
        if let Some(status) = never_placed(point, &at)? {
            remarks.push(format!("{at} is {status}, so it was never placed; it was skipped"));
            continue;
        }
        let Some([x, y, z]) = point.position.0 else {
            remarks.push(format!("{at} has no position, so it was never placed; it was skipped"));
            continue;
        };
        let name = PointName::parse(&point.label, &at)?;
        let mut lps = [0.0; 3];
        for (place, (value, sign)) in lps.iter_mut().zip([x, y, z].into_iter().zip(signs)) {
            *place = coordinate(value * unit_mm, &at)? * sign;
        }
        list.points.insert(name, lps, &at)?;
        let about = own_description(point, &at)?.and_then(|about| about.origin);
        list.points.set_origin(name, about.map(|key| origin(&key, &at)).transpose()?);
    }
    Ok(())
}

/// Film and reading of a list, by its description, else by the user.
fn list_key(
    about: Option<&Description>,
    at: &str,
    hint: &LandmarkHint,
) -> Result<ListKey, LandmarkError> {
    let Some(about) = about else {
        return Ok((hint.posture, hint.reading.clone()));
    };
    let posture = named(&about.film, "posture", at)?;
    Ok((Some(posture), ReadingId::new(observer(&about.observer, at)?, about.repeat)))
}

/// The status of a point that was never placed.
fn never_placed<'a>(point: &'a ControlPoint, at: &str) -> Result<Option<&'a str>, LandmarkError> {
    match point.position_status.as_deref() {
        None | Some("defined") => Ok(None),
        Some(status @ ("undefined" | "preview" | "missing")) => Ok(Some(status)),
        Some(status) => Err(LandmarkError::Value {
            at: at.to_owned(),
            value: shown(status),
            expected: "`defined`, `undefined`, `preview` or `missing`",
        }),
    }
}

/// Conversion of the coordinates to LPS.
fn signs(markup: &Markup, at: &str) -> Result<[f64; 3], LandmarkError> {
    match &markup.coordinate_system {
        None => {
            Err(LandmarkError::missing(at, "`coordinateSystem`, which determines left and right,"))
        }
        Some(serde_json::Value::String(name)) if name == "LPS" => Ok([1.0, 1.0, 1.0]),
        Some(serde_json::Value::String(name)) if name == "RAS" => Ok([-1.0, -1.0, 1.0]),
        Some(other) => Err(LandmarkError::Value {
            at: format!("{at}, coordinateSystem"),
            value: shown(&other.to_string()),
            expected: "`LPS` or `RAS`",
        }),
    }
}

fn unit_mm(markup: &Markup, at: &str) -> Result<f64, LandmarkError> {
    let unit = match &markup.coordinate_units {
        None | Some(serde_json::Value::Null) => return Ok(1.0),
        // A coded unit has its code, the coding scheme and words.
        Some(serde_json::Value::Array(code)) => code.first().cloned().unwrap_or_default(),
        Some(unit) => unit.clone(),
    };
    match unit.as_str() {
        Some("mm") => Ok(1.0),
        Some("um") => Ok(1e-3),
        _ => Err(LandmarkError::Value {
            at: format!("{at}, coordinateUnits"),
            value: shown(&unit.to_string()),
            expected: "`mm` or `um`",
        }),
    }
}

/// The description of a point by this program; texts without its key `spineline` belong to the user.
fn own_description(point: &ControlPoint, at: &str) -> Result<Option<Description>, LandmarkError> {
    let text = point.description.trim();
    if !(text.starts_with('{') && text.contains("\"spineline\"")) {
        return Ok(None);
    }
    let about = serde_json::from_str::<Description>(text).ok();
    match about.filter(|about| about.spineline == 1 && about.repeat > 0) {
        Some(about) => Ok(Some(about)),
        None => Err(LandmarkError::Value {
            at: format!("{at}, `{}`, description", shown(&point.label)),
            value: shown(text),
            expected: "a description of version 1: film, observer, repeat from 1, and frame `image` or `patient`",
        }),
    }
}

/// The common description of a list's points by this program; points added in Slicer lack it.
fn description(markup: &Markup, at: &str) -> Result<Option<Description>, LandmarkError> {
    let mut found: Option<Description> = None;
    for point in &markup.control_points {
        let Some(about) = own_description(point, at)? else { continue };
        // The origin differs between points.
        let about = Description { origin: None, ..about };
        if found.as_ref().is_some_and(|first| *first != about) {
            return Err(LandmarkError::Ambiguous {
                at: at.to_owned(),
                reason: "its points carry descriptions of different films, readings or frames"
                    .to_owned(),
                help: "give every film and reading a separate list",
            });
        }
        found = Some(about);
    }
    Ok(found)
}

#[derive(Default)]
struct Film {
    crests: Option<IliacCrests>,
    marked: Vec<Reading<VertebraLandmarks>>,
    placed: Vec<Reading<Placement>>,
}

/// A place in a frontal plane of the patient.
fn frontal([left, _, superior]: Lps) -> Frontal {
    Frontal::new(left, superior)
}

impl List {
    fn add_to(
        &self,
        id: ReadingId,
        hint: &LandmarkHint,
        film: &mut Film,
    ) -> Result<(), LandmarkError> {
        let bodies = self.points.bodies(&self.at)?;
        match (self.frame(hint)?, hint.image) {
            (SlicerFrame::Image, _) => {
                let [column_mm, row_mm] = self.steps(hint)?;
                let to_pixel = |p: Lps| pixel(p[0] / column_mm, p[1] / row_mm, &self.at);
                self.mark(film, id, bodies, to_pixel)
            }
            (SlicerFrame::Patient, Some(image)) => {
                self.check_on_picture(&bodies, &image)?;
                self.mark(film, id, bodies, |p| Ok(image.pixel(frontal(p))))
            }
            (SlicerFrame::Patient, None) => {
                film.placed.push(Reading { id, vertebrae: self.placements(bodies)? });
                Ok(())
            }
        }
    }

    /// Refuses points in the patient that are not on the picture if its first pixel is their origin: the file has no other place of the
    /// picture in the patient.
    fn check_on_picture(
        &self,
        bodies: &BTreeMap<Level, Corners<Lps>>,
        image: &ImageGeometry,
    ) -> Result<(), LandmarkError> {
        let is_outside = |p: Lps| !image.contains(image.pixel(frontal(p)));
        let outside = bodies.iter().find(|(_, body)| body.points().into_iter().any(is_outside));
        let Some((level, _)) = outside else { return Ok(()) };
        Err(LandmarkError::Ambiguous {
            at: self.at.clone(),
            reason: format!(
                "its points lie in a coronal plane of the patient, and the file does not state where the picture lies in it; \
                 with the first pixel as the origin, {level} is not on the picture"
            ),
            help: "place the points on the picture itself, as Slicer loads it without a position in the patient; without a picture, `spineline.Film` in Python reads the list as locations and tilts",
        })
    }

    /// Adds bodies and crests on a picture.
    fn mark(
        &self,
        film: &mut Film,
        id: ReadingId,
        bodies: BTreeMap<Level, Corners<Lps>>,
        to_pixel: impl Fn(Lps) -> Result<Pixel, LandmarkError>,
    ) -> Result<(), LandmarkError> {
        let mut vertebrae = BTreeMap::new();
        for (level, body) in bodies {
            let [sl, sr, il, ir] = body.points().map(&to_pixel);
            let clicked = VertebraLandmarks::clicked([sl?, sr?, il?, ir?].into());
            let origins = self.points.origins(level);
            vertebrae.insert(level, VertebraLandmarks { origins, ..clicked });
        }
        let crests = match self.points.crests(&self.at)? {
            Some([left, right]) => {
                Some(IliacCrests { left: to_pixel(left)?, right: to_pixel(right)? })
            }
            None => None,
        };
        merge_crests(&mut film.crests, crests, &self.at)?;
        film.marked.push(Reading { id, vertebrae });
        Ok(())
    }

    fn placements(
        &self,
        bodies: BTreeMap<Level, Corners<Lps>>,
    ) -> Result<BTreeMap<Level, Placement>, LandmarkError> {
        let mut placed = BTreeMap::new();
        for (level, body) in bodies {
            let body = body.map(frontal);
            let location = body.measure_location().map_err(|fault| LandmarkError::Syntax {
                at: format!("{}, {level}", self.at),
                reason: fault.to_string(),
            })?;
            placed.insert(
                level,
                Placement {
                    endplates: Some(body.measure_endplates()),
                    ..Placement::new(location, TiltRule::default().tilt_of(&body))
                },
            );
        }
        Ok(placed)
    }

    /// The frame that the file or the caller names, checked against the plane of the points; without a name the plane
    /// decides.
    fn frame(&self, hint: &LandmarkHint) -> Result<SlicerFrame, LandmarkError> {
        let spread = |axis: usize| {
            let values = || self.points.points().map(|p| p[axis]);
            values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
        };
        let (posterior, superior) = (spread(1), spread(2));
        let plane = match (posterior <= PLANE_TOLERANCE_MM, superior <= PLANE_TOLERANCE_MM) {
            (false, true) => Ok(SlicerFrame::Image),
            (true, false) => Ok(SlicerFrame::Patient),
            _ => Err(LandmarkError::Plane {
                at: self.at.clone(),
                reason: format!(
                    "its points extend over {} mm from front to back and {} mm from foot to head, and \
                     do not lie in the plane of a picture or in a coronal plane",
                    fixed(posterior, 1),
                    fixed(superior, 1)
                ),
            }),
        }?;
        let named = self.about.as_ref().map(|about| about.frame).or(hint.slicer_frame);
        match named {
            Some(named) if named != plane => Err(LandmarkError::Plane {
                at: self.at.clone(),
                reason: format!(
                    "its frame is stated as {named:?}, but its points lie in {plane:?}"
                ),
            }),
            _ => Ok(plane),
        }
    }

    /// Millimetres per column and row in Slicer.
    fn steps(&self, hint: &LandmarkHint) -> Result<[f64; 2], LandmarkError> {
        let own = self.about.as_ref().and_then(|about| about.spacing_mm);
        let of_image =
            |image: ImageGeometry| image.scale().map_or([1.0, 1.0], |s| [s.column_mm, s.row_mm]);
        let steps = own.or(hint.image.map(of_image)).ok_or(LandmarkError::Needs {
            format: "a point list on a picture",
            what: "the pixel spacing of that picture",
            help: "name its film, as in `--landmarks erect=FILE`; give the spacing that Slicer used with `--spacing`",
        })?;
        for step in steps {
            if !Spacing::is_possible(step) {
                return Err(LandmarkError::Outside {
                    at: self.at.clone(),
                    value: step,
                    expected: "a pixel spacing from 0.01 to 5 mm",
                    limits: [Spacing::MIN_MM, Spacing::MAX_MM],
                });
            }
        }
        Ok(steps)
    }
}

impl Film {
    fn finish(self, posture: Option<Posture>) -> Result<MarkedFilm, LandmarkError> {
        if !self.marked.is_empty() && !self.placed.is_empty() {
            return Err(LandmarkError::Ambiguous {
                at: "markups".to_owned(),
                reason: "some lists lie on a picture and some in the patient".to_owned(),
                help: "give each list as a separate file",
            });
        }
        let landmarks = if self.placed.is_empty() {
            LandmarkReadings::Corners(self.marked)
        } else {
            LandmarkReadings::Placements(self.placed)
        };
        Ok(MarkedFilm { posture, picture: None, size: None, iliac_crests: self.crests, landmarks })
    }
}
