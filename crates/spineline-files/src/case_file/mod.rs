//! The file of a case.

mod image;
mod lateral;
mod vertebra;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::analysis::{Case, Subject, is_case_id, is_lenke_class};
use spineline::anatomy::{FilmView, Posture};
use spineline::measure::{
    Film, FilmLandmarks, IliacCrests, PlacementSource, Reading, ReadingId, SpacingPlane,
};

use crate::FileError;
use crate::json::parse;
use crate::keys::ByLevel;
use image::ImageRecord;
pub use image::{FilmSource, image_value, is_picture_name, parse_image, with_geometry};
use lateral::LateralRecord;
pub use vertebra::written_axis_deg;
use vertebra::{Kind, VertebraRecord};

const FORMAT: &str = "spineline-case";
const VERSION: u32 = 1;

/// The films of one patient with their landmarks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Spineline case, version 1")]
pub struct CaseFile {
    /// `spineline-case`.
    format: String,
    /// 1.
    version: u32,
    /// Identifier, without any name: 1 to 64 letters, digits, `.`, `-` and `_`.
    case_id: String,
    /// Whether the films are synthetic.
    #[serde(default)]
    synthetic: bool,
    /// Data of the patient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    subject: Option<Subject>,
    /// One film per posture; only the erect one is needed.
    films: Vec<FilmRecord>,
    /// A lateral film, for the sagittal profile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lateral: Option<LateralRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FilmRecord {
    posture: Posture,
    /// The picture; needed where corners are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    image: Option<ImageRecord>,
    /// Superior tips of the iliac crests.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    iliac_crests_px: Option<IliacCrests>,
    /// Unit of `location_mm`; for films of locations and tilts only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lengths: Option<LengthsRecord>,
    /// Where locations and tilts come from.
    #[serde(default, skip_serializing_if = "is_of_vertebrae")]
    placement_source: PlacementSource,
    /// Whether a person compared the film with the patient's records: patient, posture and levels are right. Checks then do not doubt it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    checked: bool,
    /// One entry per observer and repeat.
    readings: Vec<ReadingRecord>,
}

/// Unit of the millimetres of locations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LengthsRecord {
    /// Plane in which they were measured.
    plane: SpacingPlane,
    /// Standard deviation of their scale, as a part of it: 0 where it is known exactly, absent where nothing is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    relative_sd: Option<f64>,
}

impl LengthsRecord {
    /// The meaning of files without this entry: the plane of their picture, if they have one; a scanner measures the patient.
    fn implied(image: Option<&ImageRecord>, source: PlacementSource) -> Self {
        let plane = match (image, source) {
            (Some(image), _) => image.plane(),
            (None, PlacementSource::Vertebrae) => SpacingPlane::Unknown,
            (None, PlacementSource::SurfaceMidline) => SpacingPlane::Patient,
        };
        Self { plane, relative_sd: None }
    }
}

fn is_of_vertebrae(source: &PlacementSource) -> bool {
    *source == PlacementSource::Vertebrae
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ReadingRecord {
    observer: String,
    /// Number of the repeat, from 1.
    #[schemars(range(min = 1))]
    repeat: u32,
    vertebrae: ByLevel<VertebraRecord>,
}

/// Reads a case from the text of its file.
///
/// # Errors
/// [`FileError`], which says where in the file.
pub fn parse_case(text: &str) -> Result<Case, FileError> {
    parse_case_file(text)?.into_case()
}

/// Reads a case with data that only its file has, such as the names of its pictures.
///
/// # Errors
/// [`FileError`], which says where in the file.
pub fn parse_case_file(text: &str) -> Result<CaseFile, FileError> {
    parse::<CaseFile>(text, FORMAT, VERSION)
}

impl CaseFile {
    /// Identifier of the case.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.case_id
    }

    /// The picture file of a film, where the case names one. Only [`CaseFile::into_case`] checks its name: do not open it before.
    #[must_use]
    pub fn source(&self, view: impl Into<FilmView>) -> Option<FilmSource> {
        match view.into() {
            FilmView::Frontal(posture) => {
                let film = self.films.iter().find(|film| film.posture == posture)?;
                Some(film.image.as_ref()?.source())
            }
            FilmView::Lateral => self.lateral.as_ref().map(LateralRecord::source),
        }
    }

    /// The same case with the picture file of a film named; a film without a picture stays as it is.
    #[must_use]
    pub fn with_source(mut self, view: impl Into<FilmView>, source: FilmSource) -> Self {
        match view.into() {
            FilmView::Frontal(posture) => {
                let films = self.films.iter_mut().filter(|film| film.posture == posture);
                let images = films.filter_map(|film| film.image.as_mut());
                images.for_each(|image| image.set_source(source.clone()));
            }
            FilmView::Lateral => {
                self.lateral.iter_mut().for_each(|lateral| lateral.set_source(source.clone()));
            }
        }
        self
    }

    /// The case that this file holds.
    ///
    /// # Errors
    /// [`FileError::CaseId`], [`FileError::Lenke`], [`FileError::PictureFolder`], [`FileError::PictureHash`],
    /// [`FileError::PictureTwice`], [`FileError::Vertebra`], [`FileError::Angle`], [`FileError::LengthsOfPixels`],
    /// [`FileError::MixedKinds`], [`FileError::NoImage`].
    pub fn into_case(self) -> Result<Case, FileError> {
        if !is_case_id(&self.case_id) {
            return Err(FileError::CaseId { found: self.case_id });
        }
        self.check_pictures()?;
        let subject = self.subject.unwrap_or_default();
        if let Some(found) = subject.lenke.clone().filter(|class| !is_lenke_class(class)) {
            return Err(FileError::Lenke { found });
        }
        let films = self.films.into_iter().map(FilmRecord::into_film).collect::<Result<_, _>>()?;
        let lateral = self.lateral.map(LateralRecord::film).transpose()?;
        Ok(Case { id: self.case_id, synthetic: self.synthetic, subject, films, lateral })
    }

    /// Refuses a picture that is not beside the case, or is named for two films.
    fn check_pictures(&self) -> Result<(), FileError> {
        let frontal = self
            .films
            .iter()
            .filter_map(|film| Some((film.posture.to_string(), film.image.as_ref()?.source())));
        let lateral = self.source(FilmView::Lateral).map(|source| ("lateral".to_owned(), source));
        let mut known: Vec<(String, FilmSource)> = Vec::new();
        for (b, source) in frontal.chain(lateral) {
            source.check(&b)?;
            for (a, other) in &known {
                let same = |x: &Option<String>, y: &Option<String>| {
                    x.clone().filter(|x| y.as_ref() == Some(x))
                };
                let picture =
                    same(&source.file, &other.file).or_else(|| same(&source.sha256, &other.sha256));
                if let Some(picture) = picture {
                    return Err(FileError::PictureTwice { a: a.clone(), b, picture });
                }
            }
            known.push((b, source));
        }
        Ok(())
    }

    /// The file of a case.
    #[must_use]
    pub fn from_case(case: &Case) -> Self {
        let subject = Some(&case.subject).filter(|subject| **subject != Subject::default());
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            case_id: case.id.clone(),
            synthetic: case.synthetic,
            subject: subject.cloned(),
            films: case.films.iter().map(FilmRecord::from_film).collect(),
            lateral: case.lateral.as_ref().map(LateralRecord::of),
        }
    }
}

impl FilmRecord {
    fn into_film(self) -> Result<Film, FileError> {
        let (posture, checked) = (self.posture, self.checked);
        let (mut marked, mut measured) = (Vec::new(), Vec::new());
        for reading in self.readings {
            let id = ReadingId::new(reading.observer, reading.repeat);
            let mut landmarks = Reading { id: id.clone(), vertebrae: Default::default() };
            let mut placements = Reading { id, vertebrae: Default::default() };
            for (level, record) in reading.vertebrae.0 {
                let place = || format!("{posture} film, observer {}, {level}", landmarks.id);
                match record.check(place)? {
                    Kind::Marked(landmark) => {
                        landmarks.vertebrae.insert(level, landmark);
                    }
                    Kind::Measured(placement) => {
                        placements.vertebrae.insert(level, placement);
                    }
                }
            }
            match (landmarks.vertebrae.is_empty(), placements.vertebrae.is_empty()) {
                (false, false) => return Err(FileError::MixedKinds { posture }),
                (_, true) => marked.push(landmarks),
                (true, false) => measured.push(placements),
            }
        }
        if !measured.is_empty() {
            if marked.iter().any(|reading| !reading.vertebrae.is_empty()) {
                return Err(FileError::MixedKinds { posture });
            }
            let source = self.placement_source;
            let implied = LengthsRecord::implied(self.image.as_ref(), source);
            let lengths = self.lengths.unwrap_or(implied);
            if lengths.plane == SpacingPlane::Pixels {
                return Err(FileError::LengthsOfPixels { posture });
            }
            let landmarks = FilmLandmarks::Placements {
                spacing_plane: lengths.plane,
                scale_relative_sd: lengths.relative_sd,
                source,
                readings: measured,
            };
            return Ok(Film { checked, ..Film::new(posture, landmarks) });
        }
        if self.lengths.is_some() {
            return Err(FileError::LengthsOfCorners { posture });
        }
        if self.placement_source != PlacementSource::Vertebrae {
            return Err(FileError::SourceOfCorners { posture });
        }
        let image = self.image.ok_or(FileError::NoImage { posture })?;
        let landmarks = FilmLandmarks::Corners {
            image: image.geometry(posture)?,
            iliac_crests: self.iliac_crests_px,
            readings: marked,
        };
        Ok(Film { checked, ..Film::new(posture, landmarks) })
    }

    fn from_film(film: &Film) -> Self {
        let posture = film.posture;
        match &film.landmarks {
            FilmLandmarks::Corners { image, iliac_crests, readings } => Self {
                posture,
                image: Some(ImageRecord::of(image, FilmSource::default())),
                iliac_crests_px: *iliac_crests,
                lengths: None,
                placement_source: PlacementSource::Vertebrae,
                checked: film.checked,
                readings: readings.iter().map(|r| record(r, VertebraRecord::marked)).collect(),
            },
            FilmLandmarks::Placements { spacing_plane, scale_relative_sd, source, readings } => {
                let lengths =
                    LengthsRecord { plane: *spacing_plane, relative_sd: *scale_relative_sd };
                let implied = LengthsRecord::implied(None, *source);
                Self {
                    posture,
                    image: None,
                    iliac_crests_px: None,
                    lengths: (lengths != implied).then_some(lengths),
                    placement_source: *source,
                    checked: film.checked,
                    readings: readings
                        .iter()
                        .map(|r| record(r, VertebraRecord::measured))
                        .collect(),
                }
            }
        }
    }
}

fn record<T>(reading: &Reading<T>, vertebra: impl Fn(&T) -> VertebraRecord) -> ReadingRecord {
    let vertebrae =
        reading.vertebrae.iter().map(|(&level, value)| (level, vertebra(value))).collect();
    ReadingRecord {
        observer: reading.id.observer.clone(),
        repeat: reading.id.repeat,
        vertebrae: ByLevel(vertebrae),
    }
}
