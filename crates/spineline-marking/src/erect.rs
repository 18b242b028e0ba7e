//! The finished erect film of a patient as the prior of the patient's other films.

use std::collections::BTreeMap;

use spineline::anatomy::Level;
use spineline::measure::{ImageGeometry, median};

use super::PartialReading;

/// An erect film with its landmarks.
#[derive(Debug, Clone, PartialEq)]
pub struct ErectFilm {
    /// The picture.
    pub image: ImageGeometry,
    /// The landmarks.
    pub reading: PartialReading,
}

impl ErectFilm {
    /// The vertebrae that a person marks first on another film: with two clicks each, they determine the others.
    pub const ASKED: [Level; 5] = [Level::L4, Level::L1, Level::T9, Level::T5, Level::T2];

    /// Widths of the vertebrae with four corners on another film over their widths on this one; over the median of these
    /// ratios where a film has no scale.
    #[must_use]
    pub fn width_ratios(
        &self,
        image: &ImageGeometry,
        reading: &PartialReading,
    ) -> BTreeMap<Level, f64> {
        let width = |image: &ImageGeometry, reading: &PartialReading, level: &Level| {
            let corners = reading.vertebrae.get(level)?.complete()?;
            Some(corners.map(|corner| image.frontal(corner)).mean_width_mm())
        };
        let ratio = |&level: &Level| {
            let own = width(image, reading, &level)?;
            Some((level, own / width(&self.image, &self.reading, &level)?))
        };
        let mut ratios: BTreeMap<Level, f64> = reading.vertebrae.keys().filter_map(ratio).collect();
        if image.scale().is_none() || self.image.scale().is_none() {
            let median = median(ratios.values().copied().collect());
            ratios.values_mut().for_each(|ratio| *ratio /= median);
        }
        ratios
    }
}
