use super::SpineModel;
use super::geometry::size_scale;
use crate::anatomy::{Level, Morphometry};

/// The size of a vertebral body, for drawing it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodySize {
    /// Left to right.
    pub width_mm: f64,
    /// Front to back.
    pub depth_mm: f64,
    /// Caudal to cranial.
    pub height_mm: f64,
}

impl SpineModel {
    /// Sizes of the bodies L4 to T2: widths as measured where they were, and else typical; depths and heights typical,
    /// scaled as the joints are to the distances of this spine.
    ///
    /// # References
    /// [`Morphometry`].
    #[must_use]
    pub fn body_sizes(&self, widths_mm: Option<&[f64]>) -> Vec<BodySize> {
        let scales: Vec<f64> = self
            .midpoints_mm
            .windows(2)
            .enumerate()
            .map(|(i, pair)| size_scale(i, (pair[1] - pair[0]).norm()))
            .collect();
        let last = scales.len() - 1;
        let size = |(i, &level): (usize, &Level)| {
            let typical = Morphometry::of(level);
            // Between the joint below and the one above.
            let scale = 0.5 * (scales[i.saturating_sub(1)] + scales[i.min(last)]);
            let width_mm = 0.5 * scale * (typical.superior_width_mm + typical.inferior_width_mm);
            BodySize {
                width_mm: widths_mm.map_or(width_mm, |measured| measured[i]),
                depth_mm: scale * typical.superior_depth_mm,
                height_mm: scale * typical.body_height_mm,
            }
        };
        Level::MODEL.iter().enumerate().map(size).collect()
    }
}
