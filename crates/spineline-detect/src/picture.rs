//! The grey values of a film.

use spineline::anatomy::ImageSide;
use spineline::spatial::Pixel;

/// A film's grey values in any unit, with bright or dark bones.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// Pixels in a row.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
    /// Height of a pixel over its width.
    pub pixel_aspect: f64,
    /// The side of the picture on which the patient's left is.
    pub patient_left: ImageSide,
    /// Row by row from the top.
    pub values: &'a [f32],
}

impl Picture<'_> {
    /// Whether a place lies on it; the centre of the first pixel is at zero.
    pub(crate) fn holds(&self, place: Pixel) -> bool {
        let within = |value: f64, count: usize| (-0.5..count as f64 - 0.5).contains(&value);
        within(place.column_px, self.columns) && within(place.row_px, self.rows)
    }
}
