//! Sources of the model's vertebrae in space: measurements or assumptions.

use super::Analysis;
use crate::anatomy::{Level, named};
use crate::multibody::BodySize;

named! {
    /// Where pitch and depth of a vertebra of the model come from.
    pub enum PitchSource {
        /// Measured: the lateral film shows the vertebra.
        LateralFilm = "lateral_film",
        /// Assumed: turns of a population, from the vertebrae that the lateral film shows, if any.
        Population = "population",
    }
}

impl PitchSource {
    /// Whether it is this patient's.
    #[must_use]
    pub const fn is_measured(self) -> bool {
        matches!(self, Self::LateralFilm)
    }
}

named! {
    /// Where the axial rotation of a vertebra of the model comes from.
    pub enum AxialSource {
        /// Measured: both pedicles are marked on the erect film.
        Pedicles = "pedicles",
        /// Not known, and zero in the model.
        Unknown = "unknown",
    }
}

impl AxialSource {
    /// Whether it is this patient's.
    #[must_use]
    pub const fn is_measured(self) -> bool {
        matches!(self, Self::Pedicles)
    }
}

impl Analysis {
    /// Sizes of the bodies of the model, the base first, for drawing it: widths between the corners of the erect film where a person placed
    /// them ([`Movement::widths_mm`](super::Movement::widths_mm)), and else typical; depths and heights typical.
    #[must_use]
    pub fn body_sizes(&self) -> Vec<BodySize> {
        self.movement.spine.body_sizes(self.movement.levels(), &self.movement.widths_mm)
    }

    /// Where pitch and depth of a vertebra of the model come from.
    #[must_use]
    pub fn pitch_source(&self, level: Level) -> PitchSource {
        match self.movement.space.as_ref().and_then(|space| space.vertebra(level)) {
            Some(_) => PitchSource::LateralFilm,
            None => PitchSource::Population,
        }
    }

    /// Where the axial rotation of a vertebra of the model comes from.
    #[must_use]
    pub fn axial_source(&self, level: Level) -> AxialSource {
        if self.movement.axial.iter().any(|found| found.level == level) {
            AxialSource::Pedicles
        } else {
            AxialSource::Unknown
        }
    }
}
