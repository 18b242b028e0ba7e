//! Bodies of a reading compared with their neighbours: steps of width and tilt that do not occur between vertebrae, and landmarks
//! far from the spine.

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

/// Distance of the middles of neighbouring bodies over the height of a body: with a disc of three tenths of it.
const STEP_HEIGHTS: f64 = 1.3;

/// A landmark is far from the spine at this number of times the distance to the farthest corner that its level has in a straight
/// spine. An assumption: a bend brings the corners nearer.
const MAX_FAR_RATIO: f64 = 1.5;

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

/// Levels with a landmark far from the next body, that body, and the distance over the largest expected one.
pub(super) fn far_from_bodies(
    bodies: &BTreeMap<Level, Corners<Frontal>>,
    landmarks: &BTreeMap<Level, Vec<Frontal>>,
) -> Vec<(Level, Level, f64)> {
    let far = landmarks.iter().filter_map(|(&level, places)| {
        let steps = |other: Level| (other as usize).abs_diff(level as usize);
        let (&near, body) = bodies.iter().min_by_key(|&(&other, _)| steps(other))?;
        let middle = body.measure_location().ok()?;
        let (height_mm, width_mm) = (body.height_mm(), body.mean_width_mm());
        let expected_mm =
            STEP_HEIGHTS * height_mm * steps(near) as f64 + height_mm.hypot(width_mm) / 2.0;
        let farthest_mm = places.iter().map(|place| place.distance_mm(middle)).reduce(f64::max)?;
        let ratio = farthest_mm / expected_mm;
        (ratio > MAX_FAR_RATIO).then_some((level, near, ratio))
    });
    far.collect()
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
