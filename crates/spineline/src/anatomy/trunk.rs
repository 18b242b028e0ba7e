use super::{Level, Levels};

/// Mass of the trunk's slice at T1 and at L5, and of all slices T1 to L5, as parts of the body's: girls with scoliosis
/// of 58.2 kg on average, 0.6 kg at T1, 1.5 kg at L5, 27.8 % together [keenan-2014].
const SLICE_AT_T1: f64 = 0.6 / 58.2;
const SLICE_AT_L5: f64 = 1.5 / 58.2;
const ALL_SLICES: f64 = 0.278;
/// Head and neck, and both arms [winter-2009].
const HEAD_AND_ARMS: f64 = 0.081 + 2.0 * 0.050;

/// The part of the body's weight that a vertebra carries of itself: its slice of the trunk, and at T2 also the slice of
/// T1, the head and the arms.
///
/// # Assumption
/// Between T1 and L5 the slices grow evenly, and are scaled to their published sum.
///
/// # References
/// [keenan-2014], [winter-2009].
///
/// ```
/// use spineline::anatomy::{Level, trunk_weight_share};
/// let above_l4: f64 = Level::MODEL[1..].iter().map(|level| trunk_weight_share(*level)).sum();
/// assert!((0.35..0.45).contains(&above_l4));
/// ```
#[must_use]
pub fn trunk_weight_share(level: Level) -> f64 {
    let slice = |place: usize| {
        let last = (Level::ALL.len() - 1) as f64;
        let even = SLICE_AT_L5 + (SLICE_AT_T1 - SLICE_AT_L5) * place as f64 / last;
        let sum = 0.5 * (SLICE_AT_T1 + SLICE_AT_L5) * Level::ALL.len() as f64;
        even * ALL_SLICES / sum
    };
    let place = level as usize;
    match level {
        Level::T2 => slice(place) + slice(place + 1) + HEAD_AND_ARMS,
        _ => slice(place),
    }
}

/// The parts of the body's weight that the vertebrae above the base carry, caudal first; the top carries all that is above it.
#[must_use]
pub fn trunk_weight_shares(levels: Levels) -> Vec<f64> {
    let above = |level: &Level| *level >= levels.top();
    let at_top = Level::MODEL.into_iter().filter(above).map(trunk_weight_share).sum();
    let below = levels.as_slice()[1..levels.joints()].iter().copied().map(trunk_weight_share);
    below.chain([at_top]).collect()
}
