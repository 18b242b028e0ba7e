//! Marks on the film: the collimator's edge, a lead marker, and the word SYNTHETIC.

use spineline::anatomy::{ImageSide, Side};
use spineline::measure::{ImageGeometry, Spacing};

use super::layer::spacing;
use crate::TrueFilm;

/// Largest stored value.
pub(super) const MAX_VALUE: f32 = 4095.0;

/// Width of the unexposed border.
const BORDER_MM: f64 = 3.0;
/// Distance of the marks from the picture's edge.
const INSET_MM: f64 = 11.0;

/// A glyph of five columns and seven rows; the highest of five bits is the left column.
type Glyph = [u8; 7];

const WORD: [Glyph; 9] = [
    [0x0F, 0x10, 0x10, 0x0E, 0x01, 0x01, 0x1E], // S
    [0x11, 0x11, 0x0A, 0x04, 0x04, 0x04, 0x04], // Y
    [0x11, 0x19, 0x15, 0x13, 0x11, 0x11, 0x11], // N
    [0x1F, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04], // T
    [0x11, 0x11, 0x11, 0x1F, 0x11, 0x11, 0x11], // H
    [0x1F, 0x10, 0x10, 0x1E, 0x10, 0x10, 0x1F], // E
    [0x1F, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04], // T
    [0x0E, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0E], // I
    [0x0E, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0E], // C
];
const LEFT: Glyph = [0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1F];
const RIGHT: Glyph = [0x1E, 0x11, 0x11, 0x1E, 0x14, 0x12, 0x11];

/// Glyphs in a row on the picture, in mm from its upper left corner.
struct Line {
    left_mm: f64,
    top_mm: f64,
    dot_mm: f64,
    glyphs: Vec<Glyph>,
}

impl Line {
    fn width_mm(&self) -> f64 {
        self.dot_mm * (6 * self.glyphs.len() - 1) as f64
    }

    fn height_mm(&self) -> f64 {
        self.dot_mm * 7.0
    }

    /// Whether a place lies on a dot; `None` off the line and its margin.
    fn at(&self, x_mm: f64, y_mm: f64) -> Option<bool> {
        let margin = 1.5 * self.dot_mm;
        let (x, y) = (x_mm - self.left_mm, y_mm - self.top_mm);
        let near = (-margin..self.width_mm() + margin).contains(&x)
            && (-margin..self.height_mm() + margin).contains(&y);
        near.then(|| {
            if x < 0.0 || y < 0.0 || x >= self.width_mm() || y >= self.height_mm() {
                return false;
            }
            let (column, row) = ((x / self.dot_mm) as usize, (y / self.dot_mm) as usize);
            let inside = column % 6;
            inside < 5 && self.glyphs[column / 6][row] >> (4 - inside) & 1 == 1
        })
    }
}

pub(super) struct Marks {
    image: ImageGeometry,
    word: Line,
    marker: Line,
}

impl Marks {
    pub fn of(film: &TrueFilm) -> Self {
        let image = film.image;
        let width_mm = f64::from(image.columns) * spacing(&image).column_mm;
        let height_mm = f64::from(image.rows) * spacing(&image).row_mm;
        // The lower corners are free of vertebrae: the crests are farther out.
        let word = Line { left_mm: INSET_MM, top_mm: 0.0, dot_mm: 0.6, glyphs: WORD.to_vec() };
        let word = Line { top_mm: height_mm - INSET_MM - word.height_mm(), ..word };
        let glyph = match film.marker {
            Side::Left => LEFT,
            Side::Right => RIGHT,
        };
        let marker = Line { left_mm: INSET_MM, top_mm: 70.0, dot_mm: 1.7, glyphs: vec![glyph] };
        let on_left = (film.marker == Side::Left) == (image.patient_left == ImageSide::Left);
        let left_mm = if on_left { INSET_MM } else { width_mm - INSET_MM - marker.width_mm() };
        Self { image, word, marker: Line { left_mm, ..marker } }
    }

    /// Draws the marks over one row of values, of which large ones are bright.
    pub fn burn(&self, row: usize, line: &mut [u16]) {
        let image = &self.image;
        let (width, height) = (f64::from(image.columns), f64::from(image.rows));
        let Spacing { column_mm, row_mm, .. } = spacing(image);
        let y_mm = (row as f64 + 0.5) * row_mm;
        let below_mm = height * row_mm - y_mm;
        for (column, value) in line.iter_mut().enumerate() {
            let x_mm = (column as f64 + 0.5) * column_mm;
            let beside_mm = width * column_mm - x_mm;
            let inside = x_mm.min(y_mm).min(below_mm).min(beside_mm);
            if inside < BORDER_MM {
                // The beam does not reach the detector there, and the shutter blackens it.
                let part = (1.0 - (BORDER_MM - inside) / 0.4).max(0.0);
                *value = (f64::from(*value) * part) as u16;
            } else if let Some(dot) = self.word.at(x_mm, y_mm) {
                *value = if dot { MAX_VALUE as u16 } else { 0 };
            } else if self.marker.at(x_mm, y_mm) == Some(true) {
                *value = MAX_VALUE as u16;
            }
        }
    }
}
