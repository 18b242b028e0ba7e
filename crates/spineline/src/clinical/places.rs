use super::{RegionBounds, Regions};
use crate::anatomy::{Level, Levels, Side};
use crate::measure::EndplateTilts;
use crate::spatial::{Angle, Frontal};

/// The end vertebrae of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CobbEnds {
    /// Lower end vertebra.
    pub inferior: Level,
    /// Upper end vertebra.
    pub superior: Level,
}

/// Angles between the end vertebrae of a curve; positive where it is convex to the patient's left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndAngles {
    /// Tilt of the upper minus tilt of the lower end vertebra.
    pub tilt_range: Angle,
    /// Cobb angle: tilt of the superior endplate of the upper minus tilt of the inferior endplate of the lower end vertebra;
    /// `None` where their corners are not known.
    pub cobb: Option<Angle>,
}

impl EndAngles {
    /// The size of the curve: the Cobb angle, or the tilt range where endplates are not known.
    #[must_use]
    pub fn size(self) -> Angle {
        self.cobb.unwrap_or(self.tilt_range)
    }
}

/// Between which vertebrae a curve is measured: chosen on the erect spine, and then held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePlaces {
    /// Ends and apex of the Ferguson angle.
    pub bounds: RegionBounds,
    /// Lower and upper end vertebra of the Cobb angle, as places like the bounds.
    pub cobb_ends: [usize; 2],
    /// Cobb angle minus tilt range on the erect film. Vertebrae are rigid, so that every posture of a model has the same
    /// difference; `None` where endplates are not known.
    pub endplate_difference: Option<Angle>,
}

impl CurvePlaces {
    /// The Cobb angle of a region ends at its most tilted vertebrae, at most one level outside of it: below by the inferior,
    /// above by the superior endplates; by the vertebrae's own tilts where endplates are not known.
    ///
    /// `erect` has the tilts of all vertebrae and of their endplates, from the lowest one upwards.
    #[must_use]
    pub fn choose(bounds: RegionBounds, erect: &[(Angle, Option<EndplateTilts>)]) -> Self {
        let tilt = |i: usize| erect[i].0.rad();
        // An interpolated vertebra lacks endplates, and does not end a curve where others have them.
        let any_known = erect.iter().any(|(_, endplates)| endplates.is_some());
        let may_end = |i: &usize| erect[*i].1.is_some() || !any_known;
        let of_plate = |i: usize, pick: fn(&EndplateTilts) -> Angle| {
            erect[i].1.as_ref().map_or(tilt(i), |endplates| pick(endplates).rad())
        };
        let inferior = |i: &usize| of_plate(*i, |plates| plates.inferior);
        let superior = |i: &usize| of_plate(*i, |plates| plates.superior);
        let sense = (tilt(bounds.superior) - tilt(bounds.inferior)).signum();
        let low = bounds.inferior.saturating_sub(1);
        let high = (bounds.superior + 1).min(erect.len() - 1);
        let lower = (low..=bounds.apex)
            .filter(may_end)
            .min_by(|a, b| (sense * inferior(a)).total_cmp(&(sense * inferior(b))));
        let upper = (bounds.apex..=high)
            .filter(may_end)
            .max_by(|a, b| (sense * superior(a)).total_cmp(&(sense * superior(b))));
        Self::between(bounds, [lower.unwrap_or(low), upper.unwrap_or(high)], erect)
    }

    /// A curve whose end vertebrae are given.
    #[must_use]
    pub fn between(
        bounds: RegionBounds,
        cobb_ends: [usize; 2],
        erect: &[(Angle, Option<EndplateTilts>)],
    ) -> Self {
        let angles = end_angles(cobb_ends, erect);
        let endplate_difference = angles.cobb.map(|cobb| (cobb - angles.tilt_range).wrapped());
        Self { bounds, cobb_ends, endplate_difference }
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
        let erect: Vec<_> = erect_tilts.iter().map(|tilt| (*tilt, None)).collect();
        let choose = |bounds| Self::choose(bounds, &erect);
        complete.then(|| Regions::usual(levels, erect_locations).bounds.map(choose))
    }

    /// Angles between the end vertebrae of a shape of the model, whose vertebrae are rigid.
    #[must_use]
    pub fn angles(&self, tilts: &[Angle]) -> EndAngles {
        let [lower, upper] = self.cobb_ends;
        let tilt_range = tilts[upper] - tilts[lower];
        EndAngles { tilt_range, cobb: self.endplate_difference.map(|more| tilt_range + more) }
    }
}

/// Angles between two vertebrae of a film, given as places from the lowest vertebra upwards.
pub(super) fn end_angles(
    [lower, upper]: [usize; 2],
    film: &[(Angle, Option<EndplateTilts>)],
) -> EndAngles {
    EndAngles {
        tilt_range: film[upper].0 - film[lower].0,
        cobb: film[upper].1.zip(film[lower].1).map(|(up, low)| up.superior - low.inferior),
    }
}

/// A line along an endplate of an end vertebra: through the endplate's centre, as long to either side. Its tilt is the tilt of
/// its normal. Between the lines of both end vertebrae lies the Cobb angle.
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
