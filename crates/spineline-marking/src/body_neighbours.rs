//! Bodies of a reading compared with their neighbours: steps of width and tilt that do not occur between vertebrae.

use std::collections::BTreeMap;

use spineline::anatomy::Level;
use spineline::measure::Corners;
use spineline::spatial::{Angle, Frontal};

/// The width of a body over the mean width of its neighbours, or the inverse, above which it is doubted.
///
/// The 7599 bodies of the 447 films without faults among the training landmarks of [wu-boostnet-2017] do not exceed it;
/// the largest is 1.58. Heights differ more (one of a hundred by 1.6), so they are not compared.
const MAX_WIDTH_RATIO: f64 = 1.6;

/// The tilt of a body from the mean tilt of its neighbours, above which it is doubted.
///
/// The same bodies do not exceed it; the largest is 25.0°. These films are erect: a bend, whose rotations are spread
/// over its joints, changes the difference between neighbours only slightly.
const MAX_TILT_STEP: Angle = Angle::from_deg(30.0);

/// Difference of a body from its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unlike {
    /// Its width over its neighbours' width.
    Width(f64),
    /// It is tilted by this angle against its neighbours, to the patient's right where positive.
    Tilt(Angle),
}

impl Unlike {
    /// Excess over its limit, to compare both kinds.
    fn excess(self) -> f64 {
        match self {
            Self::Width(ratio) => ratio.max(ratio.recip()) / MAX_WIDTH_RATIO,
            Self::Tilt(step) => step.abs().rad() / MAX_TILT_STEP.rad(),
        }
    }
}

/// The bodies that differ from their neighbours. A body is not reported if a neighbour is worse.
pub(super) fn unlike_neighbours(
    bodies: &BTreeMap<Level, (Corners<Frontal>, Angle)>,
) -> Vec<(Level, Unlike)> {
    let of = |(&level, body): (&Level, &(Corners<Frontal>, Angle))| {
        Some((level, unlike(&body.0, body.1, &beside(bodies, level))?))
    };
    let found: BTreeMap<Level, Unlike> = bodies.iter().filter_map(of).collect();
    let is_worst = |&(&level, unlike): &(&Level, &Unlike)| {
        let worse = |(other, one): (&Level, &Unlike)| {
            is_beside(*other, level) && one.excess() > unlike.excess()
        };
        !found.iter().any(worse)
    };
    found.iter().filter(is_worst).map(|(&level, &unlike)| (level, unlike)).collect()
}

fn is_beside(a: Level, b: Level) -> bool {
    a.next_above() == Some(b) || a.next_below() == Some(b)
}

fn beside(
    bodies: &BTreeMap<Level, (Corners<Frontal>, Angle)>,
    level: Level,
) -> Vec<(Corners<Frontal>, Angle)> {
    let near = bodies.iter().filter(|&(&other, _)| is_beside(other, level));
    near.map(|(_, body)| *body).collect()
}

fn unlike(
    corners: &Corners<Frontal>,
    tilt: Angle,
    near: &[(Corners<Frontal>, Angle)],
) -> Option<Unlike> {
    if near.is_empty() {
        return None;
    }
    let count = near.len() as f64;
    let mean_width = near.iter().map(|(one, _)| one.mean_width_mm()).sum::<f64>() / count;
    let mean_tilt = near.iter().map(|(_, tilt)| tilt.rad()).sum::<f64>() / count;
    let both = [
        Unlike::Width(corners.mean_width_mm() / mean_width),
        Unlike::Tilt(Angle::from_rad(tilt.rad() - mean_tilt)),
    ];
    let beyond = both.into_iter().filter(|one| one.excess() > 1.0);
    beyond.max_by(|a, b| a.excess().total_cmp(&b.excess()))
}
