//! The lateral film of a case: with the erect film it gives the sagittal profile.

use serde::{Deserialize, Serialize};
use spineline::anatomy::ImageSide;
use spineline::measure::{
    ImageGeometry, LateralCorners, LateralFilm, Reading, ReadingId, Spacing, SpacingPlane,
    SpacingSource,
};

use super::image::FilmSource;
use super::{pair, pixel};
use crate::FileError;
use crate::keys::ByLevel;

/// A lateral film of the standing patient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct LateralRecord {
    image: LateralImageRecord,
    /// Whether it was exposed together with the erect film, as biplanar scanners do; then both have one scale and one vertical.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    simultaneous: bool,
    /// One entry per observer and repeat; empty without landmarks.
    #[serde(default)]
    readings: Vec<LateralReadingRecord>,
}

/// The scale of this picture is found beside the erect film, so the plane of its spacing does not matter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
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
    /// Picture file, beside the case file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// SHA-256 of that file, in hexadecimal digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sha256: Option<String>,
    /// Whether the picture is shown with grey levels inverted relative to its file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    inverted: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct LateralReadingRecord {
    observer: String,
    /// Number of the repeat, from 1.
    repeat: u32,
    vertebrae: ByLevel<LateralVertebraRecord>,
}

/// Four corners in pixels, `[column, row]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct LateralVertebraRecord {
    superior_anterior: [f64; 2],
    superior_posterior: [f64; 2],
    inferior_anterior: [f64; 2],
    inferior_posterior: [f64; 2],
}

impl LateralRecord {
    pub fn film(self) -> Result<LateralFilm, FileError> {
        let image = self.image.geometry()?;
        let readings = self.readings.into_iter().map(|reading| Reading {
            id: ReadingId::new(reading.observer, reading.repeat),
            vertebrae: reading
                .vertebrae
                .0
                .into_iter()
                .map(|(level, corners)| (level, corners.corners()))
                .collect(),
        });
        Ok(LateralFilm {
            columns: image.columns,
            rows: image.rows,
            spacing: image.spacing,
            patient_anterior: image.patient_left,
            simultaneous: self.simultaneous,
            readings: readings.collect(),
        })
    }

    pub fn of(film: &LateralFilm) -> Self {
        Self {
            image: LateralImageRecord::of(&film.geometry()),
            simultaneous: film.simultaneous,
            readings: film.readings.iter().map(LateralReadingRecord::of).collect(),
        }
    }

    pub fn set_source(&mut self, source: FilmSource) {
        self.image.set_source(source);
    }

    pub fn source(&self) -> FilmSource {
        self.image.source()
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

    pub fn of(image: &ImageGeometry) -> Self {
        Self {
            columns: image.columns,
            rows: image.rows,
            column_spacing_mm: image.scale().map(|s| s.column_mm),
            row_spacing_mm: image.scale().map(|s| s.row_mm),
            pixel_aspect: image.spacing.filter(|s| !s.has_millimetres()).map(|s| s.aspect()),
            patient_anterior: image.patient_left,
            file: None,
            sha256: None,
            inverted: false,
        }
    }

    pub fn set_source(&mut self, source: FilmSource) {
        self.file = source.file;
        self.sha256 = source.sha256;
        self.inverted = source.inverted;
    }

    pub fn source(&self) -> FilmSource {
        FilmSource { file: self.file.clone(), sha256: self.sha256.clone(), inverted: self.inverted }
    }
}

impl LateralReadingRecord {
    fn of(reading: &Reading<LateralCorners>) -> Self {
        let vertebrae = reading.vertebrae.iter();
        Self {
            observer: reading.id.observer.clone(),
            repeat: reading.id.repeat,
            vertebrae: ByLevel(
                vertebrae
                    .map(|(&level, corners)| (level, LateralVertebraRecord::of(corners)))
                    .collect(),
            ),
        }
    }
}

impl LateralVertebraRecord {
    fn corners(self) -> LateralCorners {
        LateralCorners {
            superior_anterior: pixel(self.superior_anterior),
            superior_posterior: pixel(self.superior_posterior),
            inferior_anterior: pixel(self.inferior_anterior),
            inferior_posterior: pixel(self.inferior_posterior),
        }
    }

    fn of(corners: &LateralCorners) -> Self {
        Self {
            superior_anterior: pair(corners.superior_anterior),
            superior_posterior: pair(corners.superior_posterior),
            inferior_anterior: pair(corners.inferior_anterior),
            inferior_posterior: pair(corners.inferior_posterior),
        }
    }
}
