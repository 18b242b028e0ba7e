//! Counter-examples: movements without a force through the inflections.
//!
//! They show which findings of the paper depend on its hypothesis. Sizes equal the sizes
//! of the rod, so that noise has the same effect in all scenarios.

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, StandardNormal};
use spineline::anatomy::Posture;
use spineline::spatial::{Angle, Frontal};

use crate::build::SEGMENTS;
use crate::erect::ErectSpine;
use crate::movement::{Moved, TOTAL_DEG, in_order, sideways_and_upwards, through, usual_variation};
use crate::rod::{ChainShape, Rod};

/// Distance by which the line crosses the spine caudal of the inflections, as a part of its length: 60 of 998 segments.
const OFFSET: f64 = 0.06;

/// The four movements, in the order of [`TOTAL_DEG`].
const FIRST_NAMES: [Posture; 4] =
    [Posture::LeftBending, Posture::RightBending, Posture::Neutral, Posture::Traction];

/// The rotation of every segment is scaled by one factor per posture.
pub(crate) fn flatten(spine: &ErectSpine, erect: &ChainShape, rng: &mut ChaCha12Rng) -> Vec<Moved> {
    let vary = usual_variation();
    let straight = ChainShape::with_turns(spine, |_| 0.0);
    let all = erect.rotation_from(&straight).deg();
    in_order(std::array::from_fn(|i| {
        // The second bend increases the curve.
        let sense = if i == 1 { 1.0 } else { -1.0 };
        let factor = 1.0 + sense * TOTAL_DEG[i] * vary.sample(rng) / all;
        let shape = ChainShape::with_turns(spine, |k| factor * spine.turns_rad[k]);
        Moved::at(FIRST_NAMES[i], shape, 0.0)
    }))
}

/// The force of the rod, along a line beside the inflections.
pub(crate) fn offset(
    spine: &ErectSpine,
    erect: &ChainShape,
    rng: &mut ChaCha12Rng,
) -> Result<Vec<Moved>, Posture> {
    let crossings = spine.inflection_s_mm.map(|s| s - OFFSET * spine.length_mm);
    through(spine, erect, crossings, rng)
}

/// Horizontal loads tilt the spine as far as in `pull`; a cranial one straightens it.
pub(crate) fn spread(
    spine: &ErectSpine,
    erect: &ChainShape,
    rng: &mut ChaCha12Rng,
) -> Result<Vec<Moved>, Posture> {
    let rod = Rod::new(spine);
    let solve = |direction: Frontal, force_n: f64, base_nmm: &mut f64| {
        rod.spread(direction, force_n, base_nmm).map(|shape| (shape, None))
    };
    sideways_and_upwards(spine, erect, 2.0, 0.0, solve, rng)
}

/// Normal rotations of the joints between vertebrae, spread over the segments of each, scaled to the rod's sums.
pub(crate) fn random(spine: &ErectSpine, erect: &ChainShape, rng: &mut ChaCha12Rng) -> Vec<Moved> {
    let vary = usual_variation();
    let ends = &spine.vertebra_s_mm;
    let joint_of = |k: usize| {
        let s_mm = (k as f64 + 0.5) * spine.segment_mm();
        ends.partition_point(|&end| end <= s_mm).clamp(1, ends.len() - 1) - 1
    };
    let joints: Vec<usize> = (0..SEGMENTS).map(joint_of).collect();
    in_order(std::array::from_fn(|i| {
        let target = Angle::from_deg(TOTAL_DEG[i] * vary.sample(rng));
        let turns: Vec<f64> = ends
            .windows(2)
            .map(|pair| {
                let turn: f64 = StandardNormal.sample(rng);
                turn / (pair[1] - pair[0])
            })
            .collect();
        let unit = ChainShape::with_turns(spine, |k| spine.turns_rad[k] + 1e-3 * turns[joints[k]]);
        let scale = 1e-3 * target.rad() / unit.rotation_from(erect).rad();
        let shape =
            ChainShape::with_turns(spine, |k| spine.turns_rad[k] + scale * turns[joints[k]]);
        Moved::at(FIRST_NAMES[i], shape, 0.0)
    }))
}
