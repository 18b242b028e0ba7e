use super::{RegionBounds, Regions, ferguson_angle};
use crate::anatomy::{Levels, Side};
use crate::spatial::{Angle, Frontal};

/// Between which vertebrae a curve is measured: chosen on the erect spine, and then held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CurvePlaces {
    /// Ends and apex of the Ferguson angle.
    pub bounds: RegionBounds,
    /// Lower and upper end vertebra of the Cobb angle, as places like those of the bounds.
    pub cobb_ends: [usize; 2],
}

impl CurvePlaces {
    /// The Cobb angle of a region ends at its most tilted vertebrae, at most one level outside of it.
    ///
    /// `erect_tilts` are those of all vertebrae, from the lowest one upwards.
    #[must_use]
    pub fn choose(bounds: RegionBounds, erect_tilts: &[Angle]) -> Self {
        let tilt = |i: usize| erect_tilts[i].rad();
        let sense = (tilt(bounds.superior) - tilt(bounds.inferior)).signum();
        let low = bounds.inferior.saturating_sub(1);
        let high = (bounds.superior + 1).min(erect_tilts.len() - 1);
        let order = |a: &usize, b: &usize| (sense * tilt(*a)).total_cmp(&(sense * tilt(*b)));
        let lower = (low..=bounds.apex).min_by(order).unwrap_or(low);
        let upper = (bounds.apex..=high).max_by(order).unwrap_or(high);
        Self { bounds, cobb_ends: [lower, upper] }
    }

    /// The usual regions ([`Regions::usual`]) of an erect spine; `None` for any other number of vertebrae, or levels that no
    /// analysis has.
    #[must_use]
    pub fn usual(
        levels: Levels,
        erect_locations: &[Frontal],
        erect_tilts: &[Angle],
    ) -> Option<[Self; 3]> {
        if levels.base() > Levels::HIGHEST_BASE || levels.top() < Levels::LOWEST_TOP {
            return None;
        }
        let complete = erect_locations.len() == levels.len() && erect_tilts.len() == levels.len();
        let choose = |bounds| Self::choose(bounds, erect_tilts);
        complete.then(|| Regions::usual(levels, erect_locations).bounds.map(choose))
    }

    /// Cobb angle: how much the tilt grows from the lower to the upper end vertebra; positive where convex to the left.
    #[must_use]
    pub fn cobb(&self, tilts: &[Angle]) -> Angle {
        let [lower, upper] = self.cobb_ends;
        tilts[upper] - tilts[lower]
    }

    /// Ferguson angle, as [`ferguson_angle`].
    #[must_use]
    pub fn ferguson(&self, locations: &[Frontal]) -> Angle {
        ferguson_angle(locations, &self.bounds)
    }
}

/// A line along an endplate of an end vertebra: through the endplate's centre and square to the vertebra's axis, as long to
/// either side. Between the lines of both end vertebrae lies the Cobb angle as it is measured here.
#[must_use]
pub fn endplate_line(centre: Frontal, tilt: Angle, reach_mm: f64) -> [Frontal; 2] {
    let cranial = Frontal::leaning(tilt);
    // A quarter turn about -X carries cranial to the patient's left.
    let left = Frontal::new(cranial.z_mm, -cranial.y_mm) * reach_mm;
    [centre - left, centre + left]
}

/// The side to which a curve of a Cobb or Ferguson angle is convex; `None` for zero.
#[must_use]
pub fn convex_side(angle: Angle) -> Option<Side> {
    // A spine that turns to the right as it rises bulges to the left.
    angle.side().map(Side::opposite)
}
