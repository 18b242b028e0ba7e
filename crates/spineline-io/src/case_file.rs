use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::analysis::{Case, Sex, Subject};
use spineline::anatomy::{ImageSide, Posture};
use spineline::measure::{
    Corners, Film, FilmMarks, IliacCrests, ImageGeometry, Mark, Placement, Reading, ReadingId,
    Spacing, SpacingPlane, SpacingSource,
};
use spineline::spatial::{Angle, Frontal, Pixel};

use crate::FileError;
use crate::json::parse;
use crate::keys::{ByLevel, LevelKey, PostureKey, SourceKey};

const FORMAT: &str = "spineline-case";
const VERSION: u32 = 1;

/// The films of one patient with everything that was marked on them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Spineline case, version 1")]
pub struct CaseFile {
    /// `spineline-case`.
    format: String,
    /// 1.
    version: u32,
    /// Identifier, without any name.
    case_id: String,
    /// Whether the films are made up.
    #[serde(default)]
    synthetic: bool,
    /// Who was X-rayed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    subject: Option<SubjectRecord>,
    /// One film per posture; only the erect one is needed.
    films: Vec<FilmRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SubjectRecord {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sex: Option<SexKey>,
    /// Age at the films.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    age_years: Option<f64>,
    /// Lenke class as clinicians recorded it, such as `1A`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lenke: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum SexKey {
    Female,
    Male,
    Other,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FilmRecord {
    posture: PostureKey,
    /// The picture; needed where corners are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    image: Option<ImageRecord>,
    /// Superior tips of the iliac crests.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    iliac_crests_px: Option<CrestsRecord>,
    /// One entry per observer and repeat.
    readings: Vec<ReadingRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ImageRecord {
    columns: u32,
    rows: u32,
    /// Distance between neighbouring columns; absent, as that of rows, where nobody knows the scale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    column_spacing_mm: Option<f64>,
    /// Distance between neighbouring rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    row_spacing_mm: Option<f64>,
    /// Plane in which the millimetres were measured; `pixels` where there are none.
    #[serde(default)]
    spacing_plane: PlaneKey,
    /// How the spacing became known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    spacing_source: Option<SourceKey>,
    /// Standard deviation of the scale, as a part of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    spacing_relative_sd: Option<f64>,
    /// Side of the picture on which the patient's left is.
    patient_left: ImageSideKey,
    /// Picture file, beside the case file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// SHA-256 of that file, in hexadecimal digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sha256: Option<String>,
    /// Whether the picture is to be shown with black and white exchanged, against what its file says.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    inverted: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum PlaneKey {
    Patient,
    Detector,
    #[default]
    Unknown,
    Pixels,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum ImageSideKey {
    ImageLeft,
    ImageRight,
}

/// The patient's left and right crest, `[column, row]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CrestsRecord {
    left: [f64; 2],
    right: [f64; 2],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ReadingRecord {
    observer: String,
    /// 1 for the first time.
    repeat: u32,
    vertebrae: ByLevel<VertebraRecord>,
}

/// Either four corners in pixels, `[column, row]`, named by the patient's sides, or a location and a tilt.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct VertebraRecord {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    superior_left: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    superior_right: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    inferior_left: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    inferior_right: Option<[f64; 2]>,
    /// Axis turned by hand, against the image's vertical, positive clockwise as seen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    axis_deg: Option<f64>,
    /// Midpoint in any frontal frame of the film: `[y to the patient's left, z cranial]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    location_mm: Option<[f64; 2]>,
    /// Tilt in that frame, positive to the patient's right.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tilt_deg: Option<f64>,
}

/// Reads a case from the text of its file.
///
/// # Errors
/// [`FileError`], which says where in the file.
pub fn parse_case(text: &str) -> Result<Case, FileError> {
    parse_case_file(text)?.into_case()
}

/// Reads a case with what only its file knows, such as the names of its pictures.
///
/// # Errors
/// [`FileError`], which says where in the file.
pub fn parse_case_file(text: &str) -> Result<CaseFile, FileError> {
    parse::<CaseFile>(text, FORMAT, VERSION)
}

/// The picture file behind a film of a case.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FilmSource {
    /// Its name, beside the case file.
    pub file: Option<String>,
    /// SHA-256 of its bytes, in hexadecimal digits.
    pub sha256: Option<String>,
    /// Whether it is to be shown with black and white exchanged, against what the file says.
    pub inverted: bool,
}

impl CaseFile {
    /// The picture file of a posture's film, where the case names one.
    #[must_use]
    pub fn source(&self, posture: Posture) -> Option<FilmSource> {
        let film = self.films.iter().find(|film| Posture::from(film.posture) == posture)?;
        let image = film.image.as_ref()?;
        Some(FilmSource {
            file: image.file.clone(),
            sha256: image.sha256.clone(),
            inverted: image.inverted,
        })
    }

    /// The same case with the picture file of a posture's film named; a film without a picture stays as it is.
    #[must_use]
    pub fn with_source(mut self, posture: Posture, source: FilmSource) -> Self {
        for film in &mut self.films {
            if let Some(image) =
                film.image.as_mut().filter(|_| Posture::from(film.posture) == posture)
            {
                image.file = source.file.clone();
                image.sha256 = source.sha256.clone();
                image.inverted = source.inverted;
            }
        }
        self
    }

    /// The case that this file holds.
    ///
    /// # Errors
    /// [`FileError::Vertebra`], [`FileError::MixedKinds`], [`FileError::NoImage`].
    pub fn into_case(self) -> Result<Case, FileError> {
        let subject = self.subject.map_or_else(Subject::default, |subject| Subject {
            sex: subject.sex.map(|sex| match sex {
                SexKey::Female => Sex::Female,
                SexKey::Male => Sex::Male,
                SexKey::Other => Sex::Other,
            }),
            age_years: subject.age_years,
            lenke: subject.lenke,
        });
        let films = self.films.into_iter().map(FilmRecord::into_film).collect::<Result<_, _>>()?;
        Ok(Case { id: self.case_id, synthetic: self.synthetic, subject, films })
    }

    /// The file of a case.
    #[must_use]
    pub fn from_case(case: &Case) -> Self {
        let subject = &case.subject;
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            case_id: case.id.clone(),
            synthetic: case.synthetic,
            subject: (*subject != Subject::default()).then(|| SubjectRecord {
                sex: subject.sex.map(|sex| match sex {
                    Sex::Female => SexKey::Female,
                    Sex::Male => SexKey::Male,
                    Sex::Other => SexKey::Other,
                }),
                age_years: subject.age_years,
                lenke: subject.lenke.clone(),
            }),
            films: case.films.iter().map(FilmRecord::from_film).collect(),
        }
    }
}

impl FilmRecord {
    fn into_film(self) -> Result<Film, FileError> {
        let posture = Posture::from(self.posture);
        let (mut marked, mut measured) = (Vec::new(), Vec::new());
        for reading in self.readings {
            let id = ReadingId::new(reading.observer, reading.repeat);
            let mut marks = Reading { id: id.clone(), vertebrae: Default::default() };
            let mut placements = Reading { id, vertebrae: Default::default() };
            for (LevelKey(level), record) in reading.vertebrae.0 {
                match record.kind() {
                    Some(Kind::Marked(mark)) => {
                        marks.vertebrae.insert(level, mark);
                    }
                    Some(Kind::Measured(placement)) => {
                        placements.vertebrae.insert(level, placement);
                    }
                    None => {
                        let place = format!("{posture} film, observer {}, {level}", marks.id);
                        return Err(FileError::Vertebra { place });
                    }
                }
            }
            match (marks.vertebrae.is_empty(), placements.vertebrae.is_empty()) {
                (false, false) => return Err(FileError::MixedKinds { posture }),
                (_, true) => marked.push(marks),
                (true, false) => measured.push(placements),
            }
        }
        if !measured.is_empty() {
            if marked.iter().any(|reading| !reading.vertebrae.is_empty()) {
                return Err(FileError::MixedKinds { posture });
            }
            let plane = self.image.map_or(PlaneKey::Unknown, |image| image.spacing_plane);
            let marks = FilmMarks::Placements { spacing_plane: plane.into(), readings: measured };
            return Ok(Film { posture, marks });
        }
        let image = self.image.ok_or(FileError::NoImage { posture })?;
        let marks = FilmMarks::Landmarks {
            image: image.geometry(posture)?,
            iliac_crests: self
                .iliac_crests_px
                .map(|crests| IliacCrests { left: pixel(crests.left), right: pixel(crests.right) }),
            readings: marked,
        };
        Ok(Film { posture, marks })
    }

    fn from_film(film: &Film) -> Self {
        let posture = film.posture.into();
        match &film.marks {
            FilmMarks::Landmarks { image, iliac_crests, readings } => Self {
                posture,
                image: Some(ImageRecord::of(image)),
                iliac_crests_px: iliac_crests.map(|crests| CrestsRecord {
                    left: pair(crests.left),
                    right: pair(crests.right),
                }),
                readings: readings.iter().map(|r| record(r, VertebraRecord::marked)).collect(),
            },
            FilmMarks::Placements { readings, .. } => Self {
                posture,
                image: None,
                iliac_crests_px: None,
                readings: readings.iter().map(|r| record(r, VertebraRecord::measured)).collect(),
            },
        }
    }
}

fn record<T>(reading: &Reading<T>, vertebra: impl Fn(&T) -> VertebraRecord) -> ReadingRecord {
    let vertebrae = reading
        .vertebrae
        .iter()
        .map(|(&level, value)| (LevelKey(level), vertebra(value)))
        .collect();
    ReadingRecord {
        observer: reading.id.observer.clone(),
        repeat: reading.id.repeat,
        vertebrae: ByLevel(vertebrae),
    }
}

enum Kind {
    Marked(Mark),
    Measured(Placement),
}

impl VertebraRecord {
    fn kind(&self) -> Option<Kind> {
        let corners =
            [self.superior_left, self.superior_right, self.inferior_left, self.inferior_right];
        let placed = (self.location_mm, self.tilt_deg);
        match (corners, placed) {
            ([Some(sl), Some(sr), Some(il), Some(ir)], (None, None)) => Some(Kind::Marked(Mark {
                corners: Corners {
                    superior_left: pixel(sl),
                    superior_right: pixel(sr),
                    inferior_left: pixel(il),
                    inferior_right: pixel(ir),
                },
                axis_clockwise: self.axis_deg.map(Angle::from_deg),
            })),
            ([None, None, None, None], (Some([y, z]), Some(tilt))) if self.axis_deg.is_none() => {
                let location = Frontal::new(y, z);
                Some(Kind::Measured(Placement { location, tilt: Angle::from_deg(tilt) }))
            }
            _ => None,
        }
    }

    fn marked(mark: &Mark) -> Self {
        Self {
            superior_left: Some(pair(mark.corners.superior_left)),
            superior_right: Some(pair(mark.corners.superior_right)),
            inferior_left: Some(pair(mark.corners.inferior_left)),
            inferior_right: Some(pair(mark.corners.inferior_right)),
            // Hand-set axes come in steps of 0.1°; nine digits keep them and drop the rounding of radians.
            axis_deg: mark.axis_clockwise.map(|axis| (axis.deg() * 1e9).round() / 1e9),
            ..Self::default()
        }
    }

    fn measured(placement: &Placement) -> Self {
        Self {
            location_mm: Some([placement.location.y_mm, placement.location.z_mm]),
            tilt_deg: Some(placement.tilt.deg()),
            ..Self::default()
        }
    }
}

fn pixel([column, row]: [f64; 2]) -> Pixel {
    Pixel::new(column, row)
}

fn pair(place: Pixel) -> [f64; 2] {
    [place.column_px, place.row_px]
}

impl ImageRecord {
    fn geometry(&self, posture: Posture) -> Result<ImageGeometry, FileError> {
        let spacing = match (self.column_spacing_mm, self.row_spacing_mm, self.spacing_plane) {
            (Some(_), Some(_), PlaneKey::Pixels) => {
                return Err(FileError::SpacingOfPixels { posture });
            }
            (Some(column_mm), Some(row_mm), plane) => Some(Spacing {
                column_mm,
                row_mm,
                plane: plane.into(),
                source: self.spacing_source.map_or(SpacingSource::Stated, |key| key.0),
                relative_sd: self.spacing_relative_sd,
            }),
            (None, None, PlaneKey::Pixels | PlaneKey::Unknown) => None,
            _ => return Err(FileError::SpacingIncomplete { posture }),
        };
        Ok(ImageGeometry {
            columns: self.columns,
            rows: self.rows,
            spacing,
            patient_left: match self.patient_left {
                ImageSideKey::ImageLeft => ImageSide::Left,
                ImageSideKey::ImageRight => ImageSide::Right,
            },
        })
    }

    fn of(image: &ImageGeometry) -> Self {
        let spacing = image.spacing;
        Self {
            columns: image.columns,
            rows: image.rows,
            column_spacing_mm: spacing.map(|s| s.column_mm),
            row_spacing_mm: spacing.map(|s| s.row_mm),
            spacing_plane: spacing.map_or(PlaneKey::Pixels, |s| s.plane.into()),
            spacing_source: spacing
                .map(|s| SourceKey(s.source))
                .filter(|source| source.0 != SpacingSource::Stated),
            spacing_relative_sd: spacing.and_then(|s| s.relative_sd),
            patient_left: match image.patient_left {
                ImageSide::Left => ImageSideKey::ImageLeft,
                ImageSide::Right => ImageSideKey::ImageRight,
            },
            file: None,
            sha256: None,
            inverted: false,
        }
    }
}

impl From<PlaneKey> for SpacingPlane {
    fn from(key: PlaneKey) -> Self {
        match key {
            PlaneKey::Patient => Self::Patient,
            PlaneKey::Detector => Self::Detector,
            PlaneKey::Unknown => Self::Unknown,
            PlaneKey::Pixels => Self::Pixels,
        }
    }
}

impl From<SpacingPlane> for PlaneKey {
    fn from(plane: SpacingPlane) -> Self {
        match plane {
            SpacingPlane::Patient => Self::Patient,
            SpacingPlane::Detector => Self::Detector,
            SpacingPlane::Unknown => Self::Unknown,
            SpacingPlane::Pixels => Self::Pixels,
        }
    }
}
