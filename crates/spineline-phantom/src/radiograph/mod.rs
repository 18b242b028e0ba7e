//! Simulated radiographs of true films.
//!
//! The picture is a sum of attenuation along the beam. Soft tissue, ribs and pelvis are smooth and are drawn on a grid
//! of 0.4 mm; vertebrae are drawn pixel by pixel from their true corners, so that an endplate's edge lies at its true
//! place. The beam is attenuated by that sum, its quanta have Poisson noise, the detector takes the logarithm, and the
//! wide range of soft tissue is compressed as in present systems. All places are in millimetres, so pixels need not be
//! square. The spine is planar: the phantom's vertebrae do not turn about their own axes, and their pedicles stay
//! symmetric.
//!
//! Every picture carries the word SYNTHETIC and a lead marker; neither covers a vertebra. Attenuation coefficients and
//! shapes are chosen to look like films, not measured: only the corners and the crests are true values.

mod anatomy;
mod layer;
mod marks;
mod skeleton;
mod texture;
mod trunk;
mod vertebra;

use rayon::prelude::*;
use spineline::anatomy::Posture;
use spineline::measure::ImageGeometry;
use spineline::spatial::Pixel;

use crate::film::{Polarity, TrueFilm};
use anatomy::Anatomy;
use layer::Layer;
use marks::{MAX_VALUE, Marks};
use texture::Quanta;
use vertebra::Vertebra;

/// A drawn film.
#[derive(Debug, Clone, PartialEq)]
pub struct Radiograph {
    /// The posture.
    pub posture: Posture,
    /// How the picture lies.
    pub image: ImageGeometry,
    /// Meaning of large values.
    pub polarity: Polarity,
    /// Bits that a value uses.
    pub bits_stored: u16,
    /// Stored values, row by row.
    pub pixels: Vec<u16>,
}

const BITS_STORED: u16 = 12;
/// Part of soft tissue's contrast after compression.
const SOFT_CONTRAST: f32 = 0.42;
/// Stored values per unit of attenuation.
const GAIN: f32 = 1350.0;
/// Compressed attenuation that is stored as zero.
const FLOOR: f32 = 0.12;

impl Radiograph {
    /// Draws a film. The same film has the same pixels on any number of threads.
    #[must_use]
    pub fn of(film: &TrueFilm) -> Self {
        let anatomy = Anatomy::of(film);
        let (soft, bone) =
            rayon::join(|| trunk::draw(&anatomy, film.seed), || skeleton::draw(&anatomy));
        let vertebrae = vertebra::all(&anatomy, film.seed);
        let marks = Marks::of(film);
        let image = film.image;
        let columns = image.columns as usize;
        let mut pixels = vec![0_u16; columns * image.rows as usize];
        pixels.par_chunks_mut(columns.max(1)).enumerate().for_each(|(row, line)| {
            let beam = Beam { soft: &soft, bone: &bone, vertebrae: &vertebrae };
            beam.expose(&image, row, &Quanta::of_row(film.seed, row), line);
            marks.burn(row, line);
            if film.polarity == Polarity::Monochrome1 {
                for value in line {
                    *value = MAX_VALUE as u16 - *value;
                }
            }
        });
        Self {
            posture: film.posture,
            image,
            polarity: film.polarity,
            bits_stored: BITS_STORED,
            pixels,
        }
    }
}

/// Everything in the beam.
struct Beam<'a> {
    soft: &'a Layer,
    bone: &'a Layer,
    vertebrae: &'a [Vertebra],
}

impl Beam<'_> {
    /// One row of stored values.
    fn expose(&self, image: &ImageGeometry, row: usize, quanta: &Quanta, line: &mut [u16]) {
        let row_px = row as f64;
        let mut bone = vec![0.0_f32; line.len()];
        let mut soft = vec![0.0_f32; line.len()];
        self.soft.sample_row(image, row, &mut soft);
        self.bone.sample_row(image, row, &mut bone);
        let start = image.frontal(Pixel::new(0.0, row_px));
        let step = image.frontal(Pixel::new(1.0, row_px)) - start;
        for vertebra in self.vertebrae {
            vertebra.add_row(start, step, &mut bone);
        }
        quanta.scatter(&soft, &mut bone);
        for ((value, &bone), &soft) in line.iter_mut().zip(&bone).zip(&soft) {
            let seen = bone + SOFT_CONTRAST * soft - FLOOR;
            *value = (GAIN * seen).round().clamp(0.0, MAX_VALUE - 1.0) as u16;
        }
    }
}
