//! The picture of a film: size, spacing, sides and file.

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use spineline::anatomy::{FilmView, ImageSide, Posture};
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane, SpacingSource};

use crate::FileError;
use crate::digest::{is_sha256, sha256_hex};
use crate::json::parse_value;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageRecord {
    columns: u32,
    rows: u32,
    /// Distance between neighbouring columns; absent, as between rows, where the scale is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    column_spacing_mm: Option<f64>,
    /// Distance between neighbouring rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    row_spacing_mm: Option<f64>,
    /// Height of a pixel over its width, without millimetres, where pixels are not taken as square.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pixel_aspect: Option<f64>,
    /// Plane in which the millimetres were measured; `pixels` without millimetres.
    #[serde(default = "unknown_plane")]
    spacing_plane: SpacingPlane,
    /// Source of the spacing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    spacing_source: Option<SpacingSource>,
    /// Standard deviation of the scale, as a part of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    spacing_relative_sd: Option<f64>,
    /// Side of the picture on which the patient's left is.
    patient_left: ImageSide,
    /// Name of the picture file, beside the case file, without a folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// SHA-256 of that file, in 64 hexadecimal digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sha256: Option<String>,
    /// Whether the picture is shown with grey levels inverted relative to its file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    inverted: bool,
}

/// The scale of this picture is found beside the erect film, so the plane of its spacing does not matter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct LateralImageRecord {
    columns: u32,
    rows: u32,
    /// Distance between neighbouring columns; absent, as between rows, where the scale is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    column_spacing_mm: Option<f64>,
    /// Distance between neighbouring rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    row_spacing_mm: Option<f64>,
    /// Height of a pixel over its width, without millimetres, where pixels are not taken as square.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pixel_aspect: Option<f64>,
    /// Side of the picture on which the patient's front is.
    patient_anterior: ImageSide,
    /// Name of the picture file, beside the case file, without a folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// SHA-256 of that file, in 64 hexadecimal digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sha256: Option<String>,
    /// Whether the picture is shown with grey levels inverted relative to its file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    inverted: bool,
}

const fn unknown_plane() -> SpacingPlane {
    SpacingPlane::Unknown
}

/// The picture file behind a film of a case.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FilmSource {
    /// Its name, beside the case file.
    pub file: Option<String>,
    /// SHA-256 of its bytes, in lower-case hexadecimal digits.
    pub sha256: Option<String>,
    /// Whether it is shown with grey levels inverted relative to its file.
    pub inverted: bool,
}

/// Whether a text names a file on every system, without a folder and a drive. A case names only pictures beside it.
#[must_use]
pub fn is_picture_name(text: &str) -> bool {
    !matches!(text, "" | "." | "..") && !text.contains(['/', '\\', ':'])
}

impl FilmSource {
    /// As a case states it; the digits of the SHA-256 may be capitals there.
    fn stated(file: Option<&String>, sha256: Option<&String>, inverted: bool) -> Self {
        let sha256 = sha256.map(|text| text.to_ascii_lowercase());
        Self { file: file.cloned(), sha256, inverted }
    }

    /// Why these bytes are not the film with the landmarks, if the case states another SHA-256.
    #[must_use]
    pub fn other_bytes(&self, bytes: &[u8]) -> Option<String> {
        let is_other = *self.sha256.as_ref()? != sha256_hex(bytes);
        is_other
            .then(|| "its file is not the one with the landmarks (different SHA-256)".to_owned())
    }

    /// Refuses a file in a folder, and a text that is not a SHA-256.
    pub(super) fn check(&self, film: &str) -> Result<(), FileError> {
        if let Some(file) = self.file.as_deref().filter(|file| !is_picture_name(file)) {
            let last = file.rsplit(['/', '\\', ':']).next().filter(|name| is_picture_name(name));
            let (film, name) = (film.to_owned(), last.map(str::to_owned));
            return Err(FileError::PictureFolder { film, name });
        }
        match self.sha256.clone().filter(|text| !is_sha256(text)) {
            Some(found) => Err(FileError::PictureHash { film: film.to_owned(), found }),
            None => Ok(()),
        }
    }
}

/// The geometry of the picture of a case's film, from the film's `image`.
///
/// A lateral film is taken as seen with the patient's front where a frontal film has the patient's left: `patient_left` is the side of
/// the picture on which the front is. The plane of its spacing is unknown.
pub fn parse_image(image: &Value, view: FilmView) -> Result<ImageGeometry, FileError> {
    match view {
        FilmView::Frontal(posture) => record::<ImageRecord>(image)?.geometry(posture),
        FilmView::Lateral => record::<LateralImageRecord>(image)?.geometry(),
    }
}

/// The `image` of a case's film, from the geometry that [`parse_image`] gives.
#[must_use]
pub fn image_value(view: FilmView, image: &ImageGeometry, source: FilmSource) -> Value {
    match view {
        FilmView::Frontal(_) => json(ImageRecord::of(image, source)),
        FilmView::Lateral => json(LateralImageRecord::of(image, source)),
    }
}

fn json(record: impl Serialize) -> Value {
    serde_json::to_value(record).expect("string keys only")
}

/// The `image` of a case's film with another geometry.
pub fn with_geometry(
    image: &Value,
    view: FilmView,
    change: impl FnOnce(&mut ImageGeometry),
) -> Result<Value, FileError> {
    let source = match view {
        FilmView::Frontal(_) => record::<ImageRecord>(image)?.source(),
        FilmView::Lateral => record::<LateralImageRecord>(image)?.source(),
    };
    let mut geometry = parse_image(image, view)?;
    change(&mut geometry);
    Ok(image_value(view, &geometry, source))
}

fn record<T: DeserializeOwned>(image: &Value) -> Result<T, FileError> {
    parse_value(&image.to_string())
}

impl ImageRecord {
    pub fn source(&self) -> FilmSource {
        FilmSource::stated(self.file.as_ref(), self.sha256.as_ref(), self.inverted)
    }

    pub fn set_source(&mut self, source: FilmSource) {
        self.file = source.file;
        self.sha256 = source.sha256;
        self.inverted = source.inverted;
    }

    pub fn plane(&self) -> SpacingPlane {
        self.spacing_plane
    }

    pub fn geometry(&self, posture: Posture) -> Result<ImageGeometry, FileError> {
        let source = self.spacing_source.unwrap_or(SpacingSource::Stated);
        let spacing = match (self.column_spacing_mm, self.row_spacing_mm, self.spacing_plane) {
            (Some(_), Some(_), _) if self.pixel_aspect.is_some() => {
                return Err(FileError::SpacingIncomplete { posture });
            }
            (Some(_), Some(_), SpacingPlane::Pixels) => {
                return Err(FileError::SpacingOfPixels { posture });
            }
            (Some(column_mm), Some(row_mm), plane) => Some(Spacing {
                column_mm,
                row_mm,
                plane,
                source,
                relative_sd: self.spacing_relative_sd,
            }),
            (None, None, SpacingPlane::Pixels | SpacingPlane::Unknown) => {
                self.pixel_aspect.map(|aspect| Spacing::of_aspect(aspect, source))
            }
            _ => return Err(FileError::SpacingIncomplete { posture }),
        };
        Ok(ImageGeometry {
            columns: self.columns,
            rows: self.rows,
            spacing,
            patient_left: self.patient_left,
        })
    }

    pub fn of(image: &ImageGeometry, source: FilmSource) -> Self {
        let (spacing, scale) = (image.spacing, image.scale());
        Self {
            columns: image.columns,
            rows: image.rows,
            column_spacing_mm: scale.map(|s| s.column_mm),
            row_spacing_mm: scale.map(|s| s.row_mm),
            pixel_aspect: spacing.filter(|s| !s.has_millimetres()).map(|s| s.aspect()),
            spacing_plane: spacing.map_or(SpacingPlane::Pixels, |s| s.plane),
            spacing_source: spacing
                .map(|s| s.source)
                .filter(|source| *source != SpacingSource::Stated),
            spacing_relative_sd: spacing.and_then(|s| s.relative_sd),
            patient_left: image.patient_left,
            file: source.file,
            sha256: source.sha256,
            inverted: source.inverted,
        }
    }
}

impl LateralImageRecord {
    /// As seen with the front where a frontal film has the left.
    pub fn geometry(&self) -> Result<ImageGeometry, FileError> {
        let spacing = match (self.column_spacing_mm, self.row_spacing_mm, self.pixel_aspect) {
            (Some(column_mm), Some(row_mm), None) => {
                Some(Spacing::stated(column_mm, row_mm, SpacingPlane::Unknown))
            }
            (None, None, aspect) => {
                aspect.map(|aspect| Spacing::of_aspect(aspect, SpacingSource::Stated))
            }
            _ => return Err(FileError::LateralSpacing),
        };
        Ok(ImageGeometry {
            columns: self.columns,
            rows: self.rows,
            spacing,
            patient_left: self.patient_anterior,
        })
    }

    pub fn of(image: &ImageGeometry, source: FilmSource) -> Self {
        Self {
            columns: image.columns,
            rows: image.rows,
            column_spacing_mm: image.scale().map(|s| s.column_mm),
            row_spacing_mm: image.scale().map(|s| s.row_mm),
            pixel_aspect: image.spacing.filter(|s| !s.has_millimetres()).map(|s| s.aspect()),
            patient_anterior: image.patient_left,
            file: source.file,
            sha256: source.sha256,
            inverted: source.inverted,
        }
    }

    pub fn set_source(&mut self, source: FilmSource) {
        self.file = source.file;
        self.sha256 = source.sha256;
        self.inverted = source.inverted;
    }

    pub fn source(&self) -> FilmSource {
        FilmSource::stated(self.file.as_ref(), self.sha256.as_ref(), self.inverted)
    }
}
