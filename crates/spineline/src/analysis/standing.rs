//! Sources of the model's vertebrae in space: measurements or assumptions.

use super::{Analysis, Case};
use crate::anatomy::{Level, Posture, named};
use crate::measure::{Outline, body_widths};
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

/// Widths of the bodies of the model between their corners on the erect film, means over the readings; `None` where a person did not
/// place these: proposals of a program follow a typical vertebra too.
///
/// A vertebra with axial rotation looks narrower or wider by its depth: by 1 % at 20° where it is a tenth wider than deep.
pub(super) fn widths_mm(case: &Case, erect: &Outline) -> Vec<Option<f64>> {
    let film = case.films.iter().find(|film| film.posture == Posture::Erect);
    let widths = film.map(|film| body_widths(film, erect.levels())).unwrap_or_default();
    let per_mm = erect.scale.pixels_per_mm.unwrap_or(1.0);
    let own = |(vertebra, width): (&crate::measure::MeasuredVertebra, Option<f64>)| {
        width.filter(|_| vertebra.program.is_none()).map(|width| width / per_mm)
    };
    erect.vertebrae.iter().zip(widths).map(own).collect()
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
