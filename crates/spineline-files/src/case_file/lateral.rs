//! The lateral film of a case: with the erect film it gives the sagittal profile.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::measure::{Corners, LateralFilm, Reading, ReadingId};
use spineline::spatial::Pixel;

use super::image::{FilmSource, LateralImageRecord};
use crate::FileError;
use crate::keys::ByLevel;

/// A lateral film of the standing patient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LateralReadingRecord {
    observer: String,
    /// Number of the repeat, from 1.
    #[schemars(range(min = 1))]
    repeat: u32,
    vertebrae: ByLevel<LateralVertebraRecord>,
}

/// Four corners of a vertebra.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LateralVertebraRecord {
    superior_anterior: Pixel,
    superior_posterior: Pixel,
    inferior_anterior: Pixel,
    inferior_posterior: Pixel,
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
        Ok(LateralFilm { image, simultaneous: self.simultaneous, readings: readings.collect() })
    }

    pub fn of(film: &LateralFilm) -> Self {
        Self {
            image: LateralImageRecord::of(&film.image, FilmSource::default()),
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

impl LateralReadingRecord {
    fn of(reading: &Reading<Corners<Pixel>>) -> Self {
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
    fn corners(self) -> Corners<Pixel> {
        Corners {
            superior_left: self.superior_anterior,
            superior_right: self.superior_posterior,
            inferior_left: self.inferior_anterior,
            inferior_right: self.inferior_posterior,
        }
    }

    fn of(corners: &Corners<Pixel>) -> Self {
        Self {
            superior_anterior: corners.superior_left,
            superior_posterior: corners.superior_right,
            inferior_anterior: corners.inferior_left,
            inferior_posterior: corners.inferior_right,
        }
    }
}
