use super::SpineModel;
use super::geometry::size_scale;
use crate::anatomy::{Level, Levels, Morphometry};

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
    /// Sizes of the bodies, the base first: widths as measured where they were, and else typical; depths and heights typical,
    /// scaled as the joints are to the distances of this spine.
    ///
    /// # References
    /// [`Morphometry`].
    #[must_use]
    pub fn body_sizes(&self, levels: Levels, widths_mm: &[Option<f64>]) -> Vec<BodySize> {
        let scales: Vec<f64> = self
            .midpoints_mm
            .windows(2)
            .zip(levels.iter())
            .map(|(pair, inferior)| size_scale(inferior, (pair[1] - pair[0]).norm()))
            .collect();
        let last = scales.len() - 1;
        let size = |(i, level): (usize, Level)| {
            let typical = Morphometry::of(level);
            // Between the joint below and the one above.
            let scale = 0.5 * (scales[i.saturating_sub(1)] + scales[i.min(last)]);
            let width_mm = 0.5 * scale * (typical.superior_width_mm + typical.inferior_width_mm);
            BodySize {
                width_mm: widths_mm.get(i).copied().flatten().unwrap_or(width_mm),
                depth_mm: scale * typical.superior_depth_mm,
                height_mm: scale * typical.body_height_mm,
            }
        };
        levels.iter().enumerate().map(size).collect()
    }
}
