//! Whether vertebrae follow one another as a spine does.

use super::Placement;
use crate::anatomy::{Level, Morphometry};
use crate::number::fixed;
use crate::spatial::Frontal;

/// An exchanged or doubled vertebra shows at most a fifth of the usual distance.
pub(super) const MIN_SPACING_SHARE: f64 = 0.2;

/// The message about two vertebrae out of order; `share` is how far the superior one lies above the other, as a part of the usual
/// distance in this spine.
#[must_use]
pub fn out_of_order_words(inferior: Level, superior: Level, share: f64) -> String {
    if share < 0.0 {
        return format!("{inferior} is marked above {superior}: check the labels");
    }
    format!(
        "{superior} lies {} % of the expected distance above {inferior}, and the minimum is {} %: one is marked twice, skipped or exchanged",
        fixed(100.0 * share, 0),
        fixed(100.0 * MIN_SPACING_SHARE, 0)
    )
}

/// From one marked vertebra to the next one marked above it.
#[derive(Debug, Clone, Copy)]
pub struct LevelStep {
    /// The lower one.
    pub inferior: Level,
    /// The upper one.
    pub superior: Level,
    /// Their distance.
    pub distance_mm: f64,
    /// How far above along the axes of both, as a part of the usual distance in this spine.
    pub share: f64,
    /// The distance as a part of the usual one in this spine.
    pub ratio: f64,
}

impl LevelStep {
    /// The steps between vertebrae, caudal first, that need not be neighbours.
    #[must_use]
    pub fn between(vertebrae: &[(Level, Placement)]) -> Vec<Self> {
        let distance =
            |pair: &[(Level, Placement)]| pair[0].1.location.distance_mm(pair[1].1.location);
        let typical: f64 =
            vertebrae.windows(2).map(|p| Morphometry::spacing_mm(p[0].0, p[1].0)).sum();
        let longer = vertebrae.windows(2).map(distance).sum::<f64>() / typical;
        vertebrae
            .windows(2)
            .map(|pair| {
                let [(inferior, low), (superior, high)] = [pair[0], pair[1]];
                let axis = Frontal::leaning((low.tilt + high.tilt) * 0.5);
                let usual_mm = longer * Morphometry::spacing_mm(inferior, superior);
                let distance_mm = distance(pair);
                let share = (high.location - low.location).dot(axis) / usual_mm;
                Self { inferior, superior, distance_mm, share, ratio: distance_mm / usual_mm }
            })
            .collect()
    }

    /// Whether the upper one does not lie above the lower one.
    #[must_use]
    pub fn is_out_of_order(&self) -> bool {
        self.share <= MIN_SPACING_SHARE
    }

    /// Twice or half the usual distance means a skipped or doubled vertebra.
    #[must_use]
    pub fn is_unusual(&self) -> bool {
        !(0.6..1.6).contains(&self.ratio)
    }
}
