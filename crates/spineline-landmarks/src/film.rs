//! The common type into which every format is read.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use spineline::anatomy::{ImageSide, Level, Named, Posture};
use spineline::measure::{
    CornerName, Corners, Film, FilmLandmarks, IliacCrests, ImageGeometry, Origin, Placement,
    PlacementSource, Reading, ReadingId, SpacingPlane, VertebraLandmarks, check_landmarks,
};
use spineline::spatial::{Angle, Pixel};
use spineline_files::column_name;

use super::LandmarkError;
use super::error::GIVE_POSTURE;
use super::names::{PointName, coordinate, shown};

/// From the centre of the first pixel, where Spineline counts from, to its corner, where labelme and DICOM do.
pub(super) const HALF_PIXEL: f64 = 0.5;

/// A format of landmarks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LandmarkFormat {
    /// The table of Spineline.
    Csv,
    /// Point lists of 3D Slicer.
    Slicer,
    /// labelme.
    Labelme,
    /// Keypoints of COCO.
    Coco,
    /// A MATLAB file of AASCE.
    AasceMat,
    /// A folder of AASCE.
    AasceFolder,
    /// A DICOM report of Spineline.
    DicomSr,
    /// Midlines of the back surface.
    SurfaceMidlines,
}

/// The landmarks of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkFile {
    /// Format of the file.
    pub format: LandmarkFormat,
    /// Films, at least one.
    pub films: Vec<MarkedFilm>,
    /// Text on skipped parts.
    pub remarks: Vec<String>,
}

/// The landmarks of one radiograph from a file; sides are the patient's.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkedFilm {
    /// Posture, if the file contains it.
    pub posture: Option<Posture>,
    /// Name of the picture, with folders if the file has them; for a DICOM film its SOP Instance UID.
    pub picture: Option<String>,
    /// Columns and rows of the picture, if the file contains them.
    pub size: Option<(u32, u32)>,
    /// Tips of the iliac crests, in pixels.
    pub iliac_crests: Option<IliacCrests>,
    /// The readings.
    pub landmarks: LandmarkReadings,
}

/// Landmarks of the vertebrae of a film.
#[derive(Debug, Clone, PartialEq)]
pub enum LandmarkReadings {
    /// Corners in pixels.
    Corners(Vec<Reading<VertebraLandmarks>>),
    /// Locations and tilts in millimetres of any frontal frame.
    Placements(Vec<Reading<Placement>>),
    /// Levels that were placed by arc length on midlines of the back surface.
    SurfaceMidlines(Vec<Reading<Placement>>),
}

/// Plane of the points of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SlicerFrame {
    /// A picture without a position in the patient, as DX and CR films are: the first pixel is the origin, the columns
    /// run along `L` and the rows along `P` of LPS, each by its spacing, or by 1 mm for a picture without spacing.
    /// These directions are nominal, not the patient's.
    Image,
    /// A coronal plane of the patient: `L` of LPS is the patient's left, `S` is cranial.
    Patient,
}

/// Data on landmarks from the caller, for files without them.
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkHint {
    /// Posture.
    pub posture: Option<Posture>,
    /// Side of the picture on which the patient's left is: needed by formats that name sides of the picture.
    pub patient_left: Option<ImageSide>,
    /// The picture, if known.
    pub image: Option<ImageGeometry>,
    /// Observer, for formats without one.
    pub reading: ReadingId,
    /// Frame of a Slicer file without one.
    pub slicer_frame: Option<SlicerFrame>,
    /// Columns of a table.
    pub columns: ColumnHint,
}

/// Columns of a table with other names, and columns without landmarks; both as [`column_name`] writes them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ColumnHint {
    /// The column of the format that a column of the table holds. The table must have all of them.
    pub renamed: BTreeMap<String, String>,
    /// Columns of the table that are skipped.
    pub ignored: BTreeSet<String>,
    /// Whether the table came from memory: errors then name its rows, and not lines of a file.
    pub counts_rows: bool,
}

impl ColumnHint {
    /// The column of the format under this heading; `None` if it is skipped.
    pub(super) fn column(&self, heading: &str) -> Option<String> {
        let name = column_name(heading);
        let renamed = self.renamed.get(&name).map(|column| column_name(column));
        (!self.ignored.contains(&name)).then(|| renamed.unwrap_or(name))
    }

    /// Where a line is; a table from memory has its heading on the first one.
    pub(super) fn line_place(&self, line: u64) -> String {
        match line {
            line if !self.counts_rows => format!("line {line}"),
            0 | 1 => "the heading of the table".to_owned(),
            line => format!("row {} of the table", line - 1),
        }
    }
}

impl Default for LandmarkHint {
    fn default() -> Self {
        Self {
            posture: None,
            patient_left: None,
            image: None,
            reading: ReadingId::new("A", 1),
            slicer_frame: None,
            columns: ColumnHint::default(),
        }
    }
}

impl LandmarkHint {
    /// The side of the picture on which the patient's left is, by the picture or the hint.
    pub(super) fn patient_left(&self) -> Option<ImageSide> {
        self.patient_left.or(self.image.map(|image| image.patient_left))
    }
}

impl MarkedFilm {
    /// The film of a case. Corners need the picture, for its size and sides; `posture` is used if the file has none.
    ///
    /// # Errors
    /// [`LandmarkError::Needs`], [`LandmarkError::OtherPicture`], [`LandmarkError::Ambiguous`] for another posture, and errors
    /// of the core in the landmarks ([`LandmarkError::Marks`]).
    pub fn into_film(
        self,
        posture: Option<Posture>,
        image: Option<ImageGeometry>,
    ) -> Result<Film, LandmarkError> {
        let posture = match (self.posture, posture) {
            (Some(stated), Some(given)) if stated != given => {
                return Err(LandmarkError::Ambiguous {
                    at: "the film".to_owned(),
                    reason: format!("the file states {stated}, but {given} was given"),
                    help: "give the file for the film that it states, or correct what it states",
                });
            }
            (stated, given) => stated.or(given).ok_or(LandmarkError::Needs {
                format: "a film",
                what: "the posture of the patient",
                help: GIVE_POSTURE,
            })?,
        };
        let landmarks = match self.landmarks {
            LandmarkReadings::Corners(readings) => {
                let image = image.ok_or(LandmarkError::Needs {
                    format: "a film with corners",
                    what: "the size and sides of its picture",
                    help: "choose a film of its posture, as in `--film erect=1`",
                })?;
                let given = (image.columns, image.rows);
                if let Some(stated) = self.size.filter(|&stated| stated != given) {
                    return Err(LandmarkError::OtherPicture { stated, given });
                }
                FilmLandmarks::Corners { image, iliac_crests: self.iliac_crests, readings }
            }
            LandmarkReadings::Placements(readings) => {
                FilmLandmarks::placed(SpacingPlane::Unknown, readings)
            }
            LandmarkReadings::SurfaceMidlines(readings) => FilmLandmarks::Placements {
                // A scanner measures the patient.
                spacing_plane: SpacingPlane::Patient,
                scale_relative_sd: None,
                source: PlacementSource::SurfaceMidline,
                readings,
            },
        };
        let film = Film::new(posture, landmarks);
        check_landmarks(&film)?;
        Ok(film)
    }
}

/// Points of one reading by name.
#[derive(Debug)]
pub(super) struct Points<P> {
    found: BTreeMap<PointName, (P, String)>,
    confidences: BTreeMap<PointName, f64>,
    origins: BTreeMap<PointName, Origin>,
}

impl<P> Default for Points<P> {
    fn default() -> Self {
        let (found, confidences, origins) = Default::default();
        Self { found, confidences, origins }
    }
}

impl<P: Copy> Points<P> {
    /// The confidence of a point, where the file has one.
    pub fn set_confidence(
        &mut self,
        name: PointName,
        value: Option<f64>,
        at: &str,
    ) -> Result<(), LandmarkError> {
        if let Some(value) = value {
            self.confidences.insert(name, confidence(value, at)?);
        }
        Ok(())
    }

    /// The origin of a point, if the file states it.
    pub fn set_origin(&mut self, name: PointName, origin: Option<Origin>) {
        self.origins.extend(origin.map(|origin| (name, origin)));
    }

    /// The origins of a body's corners; one without is clicked.
    pub fn origins(&self, level: Level) -> Corners<Origin> {
        let own = |corner| self.origins.get(&PointName::Corner(level, corner)).copied();
        CornerName::ALL.map(|corner| own(corner).unwrap_or(Origin::Clicked)).into()
    }

    /// The confidences of a body's corners; confidences of only some corners are an error.
    fn confidences(
        &self,
        level: Level,
        reading: &str,
    ) -> Result<Option<Corners<f64>>, LandmarkError> {
        let get = |corner| self.confidences.get(&PointName::Corner(level, corner)).copied();
        all_or_none(CornerName::ALL.map(get)).map_err(|missing| {
            let what = format!("{reading}, {level}");
            LandmarkError::Confidences { what, missing }.of(None, Some(level))
        })
    }

    /// A remark if confidences of iliac crests are left out: a case cannot hold them.
    pub fn remarks(&self) -> Vec<String> {
        let crests = [PointName::CrestLeft, PointName::CrestRight];
        let has = crests.iter().any(|crest| self.confidences.contains_key(crest));
        has.then(|| "confidences of iliac crests are not kept".to_owned()).into_iter().collect()
    }

    pub fn insert(&mut self, name: PointName, point: P, at: &str) -> Result<(), LandmarkError> {
        if let Some((_, first)) = self.found.get(&name) {
            return Err(LandmarkError::Duplicate {
                at: at.to_owned(),
                what: name.to_string(),
                first: Some(first.clone()),
            });
        }
        self.found.insert(name, (point, at.to_owned()));
        Ok(())
    }

    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    pub fn points(&self) -> impl Iterator<Item = P> {
        self.found.values().map(|(point, _)| *point)
    }

    /// Vertebrae with all four corners; fewer corners are an error.
    pub fn bodies(&self, reading: &str) -> Result<BTreeMap<Level, Corners<P>>, LandmarkError> {
        let mut bodies = BTreeMap::new();
        for name in self.found.keys() {
            let PointName::Corner(level, _) = *name else { continue };
            let get = |corner| self.found.get(&PointName::Corner(level, corner)).map(|p| p.0);
            let corners = all_or_none(CornerName::ALL.map(get));
            let corners = corners.map_err(|missing| {
                let what = format!("{reading}, {level}");
                LandmarkError::Incomplete { what, missing }.of(None, Some(level))
            })?;
            if let Some(corners) = corners {
                bodies.insert(level, corners);
            }
        }
        Ok(bodies)
    }

    /// Both crests or none.
    pub fn crests(&self, reading: &str) -> Result<Option<[P; 2]>, LandmarkError> {
        let get = |name| self.found.get(&name).map(|point| point.0);
        match (get(PointName::CrestLeft), get(PointName::CrestRight)) {
            (Some(left), Some(right)) => Ok(Some([left, right])),
            (None, None) => Ok(None),
            (left, _) => Err(LandmarkError::Incomplete {
                what: format!("{reading}, iliac crests"),
                missing: vec![
                    if left.is_none() { PointName::CrestLeft } else { PointName::CrestRight }
                        .to_string(),
                ],
            }),
        }
    }
}

/// The values of the four corners of a body, or none; otherwise the names of the corners that lack one.
fn all_or_none<T>(values: [Option<T>; 4]) -> Result<Option<Corners<T>>, Vec<String>> {
    match values {
        [None, None, None, None] => Ok(None),
        [Some(sl), Some(sr), Some(il), Some(ir)] => Ok(Some([sl, sr, il, ir].into())),
        some => {
            let corners = CornerName::ALL.into_iter().zip(some);
            let missing = corners.filter(|(_, value)| value.is_none());
            Err(missing.map(|(corner, _)| corner.key().to_owned()).collect())
        }
    }
}

impl Points<Pixel> {
    pub fn landmarks(
        &self,
        reading: &str,
    ) -> Result<BTreeMap<Level, VertebraLandmarks>, LandmarkError> {
        let landmark = |(level, corners)| {
            let confidence = self.confidences(level, reading)?;
            let origins = self.origins(level);
            let clicked = VertebraLandmarks::clicked(corners);
            Ok((level, VertebraLandmarks { confidence, origins, ..clicked }))
        };
        self.bodies(reading)?.into_iter().map(landmark).collect()
    }

    pub fn iliac_crests(&self, reading: &str) -> Result<Option<IliacCrests>, LandmarkError> {
        Ok(self.crests(reading)?.map(|[left, right]| IliacCrests { left, right }))
    }
}

/// A confidence from 0 to 1.
pub(super) fn confidence(value: f64, at: &str) -> Result<f64, LandmarkError> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(LandmarkError::Outside {
        at: at.to_owned(),
        value,
        expected: "a confidence from 0 to 1",
        limits: [0.0, 1.0],
    })
}

/// An angle of at most half a turn.
pub(super) fn degrees(deg: f64, at: &str) -> Result<Angle, LandmarkError> {
    Angle::within_half_turn(deg).ok_or_else(|| LandmarkError::Outside {
        at: at.to_owned(),
        value: deg,
        expected: "an angle in degrees from -180 to 180",
        limits: [-180.0, 180.0],
    })
}

/// A value by its name in files, in small or capital letters.
pub(super) fn named<T: Named>(
    name: &str,
    what: &'static str,
    at: &str,
) -> Result<T, LandmarkError> {
    column_name(name).parse().map_err(|_| LandmarkError::Choice {
        at: at.to_owned(),
        what,
        name: shown(name),
        known: T::ALL.iter().map(|value| value.key()).collect(),
    })
}

/// The origin of a corner by its name in files.
pub(super) fn origin(name: &str, at: &str) -> Result<Origin, LandmarkError> {
    named(name, "origin", at)
}

/// The origins of a vertebra for a file; `None` if a person clicked all corners, the default.
pub(super) fn stated_origins(landmark: &VertebraLandmarks) -> Option<[Origin; 4]> {
    let is_clicked = landmark.origins == Corners::all(Origin::Clicked);
    (!is_clicked).then(|| landmark.origins.points())
}

/// A pixel with plausible coordinates.
pub(super) fn pixel(column: f64, row: f64, at: &str) -> Result<Pixel, LandmarkError> {
    Ok(Pixel::new(coordinate(column, at)?, coordinate(row, at)?))
}

/// The crests of a film, once.
pub(super) fn merge_crests(
    all: &mut Option<IliacCrests>,
    found: Option<IliacCrests>,
    at: &str,
) -> Result<(), LandmarkError> {
    match (&*all, found) {
        (_, None) => {}
        (Some(first), Some(second)) if *first == second => {}
        (Some(_), Some(_)) => {
            return Err(LandmarkError::Duplicate {
                at: at.to_owned(),
                what: "the pair of iliac crests of a film".to_owned(),
                first: None,
            });
        }
        (None, Some(found)) => *all = Some(found),
    }
    Ok(())
}
