//! From the first network's map to centres of vertebrae, to the chain of them that looks most like a spine, to
//! its levels.
//!
//! Places are cells of the first network's input: column, row; the spine runs downwards.

use crate::doubt::Doubt;
use crate::kernel::Map;

/// Levels from T1 down to L5.
pub const LEVELS: usize = 17;
/// Cells of the input per cell of the map.
const CELL: f64 = 4.0;
/// Unit of the offsets of corners.
const UNIT: f64 = 16.0;
/// First channels of corners and of levels; the centre's is zero.
const CORNERS: usize = 1;
const FIRST_LEVEL: usize = 9;

/// Centres below this probability are ignored.
const MIN_PROBABILITY: f64 = 0.10;
/// Two centres closer than this part of their mean height are one vertebra.
const MIN_DISTANCE: f64 = 0.5;
/// Distance between neighbouring centres over the height of a vertebra: geometric mean of the training films.
const STEP_OVER_HEIGHT: f64 = 1.37;
/// Deviation of the logarithm of a step, and of its direction in rad, beyond which a neighbour is doubted; 0.11 and 0.05 in the
/// training films.
const STEP_SPREAD: f64 = 0.15;
const TURN_SPREAD_RAD: f64 = 0.30;
/// Cost of a vertebra without a centre.
const SKIP_COST: f64 = 0.5;
/// Cost of a step beyond which two centres are not neighbours.
const MAX_LINK_COST: f64 = 2.5;
/// Weight of the logarithm of a level's probability beside a centre's; a level with probability exp(-2) has no effect.
const LEVEL_WEIGHT: f64 = 0.08;
const LEVEL_GAIN: f64 = 2.0;
/// Smallest probability of a level, so that a single vertebra cannot decide the count.
const LEVEL_FLOOR: f64 = 0.01;
/// Errors of neighbouring vertebrae are correlated: their votes for a level count as a quarter of
/// their number.
const LEVEL_TEMPER: f64 = 4.0;
/// A count below this probability is doubted.
const MIN_COUNT_PROBABILITY: f64 = 0.90;
/// Another vertebra may follow above or below if a centre above this probability would make a step below this cost.
const MIN_FOLLOWING_PROBABILITY: f64 = 0.50;
const MAX_FOLLOWING_COST: f64 = 1.0;
/// The first and the last vertebra are doubted below this probability.
const MIN_END_PROBABILITY: f64 = 0.35;

/// A vertebra as the first network sees it.
#[derive(Debug, Clone, Copy)]
pub struct Peak {
    pub centre: [f64; 2],
    /// Upper left, upper right, lower left, lower right as seen.
    pub corners: [[f64; 2]; 4],
    pub probability: f64,
    pub levels: [f64; LEVELS],
    /// Whether the network saw it; else it was interpolated.
    pub is_seen: bool,
}

impl Peak {
    /// From the middle of the upper endplate to the middle of the lower one.
    fn axis(&self) -> [f64; 2] {
        let [ul, ur, ll, lr] = self.corners;
        [0, 1].map(|i| (ll[i] + lr[i] - ul[i] - ur[i]) / 2.0)
    }

    fn height(&self) -> f64 {
        length(self.axis()).max(1.0)
    }

    fn between(upper: &Self, lower: &Self) -> Self {
        let mean = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| (a[i] + b[i]) / 2.0);
        Self {
            centre: mean(upper.centre, lower.centre),
            corners: [0, 1, 2, 3].map(|k| mean(upper.corners[k], lower.corners[k])),
            probability: 0.0,
            levels: [1.0 / LEVELS as f64; LEVELS],
            is_seen: false,
        }
    }
}

/// Local maxima of the centres' probability, the most probable first; of two on one vertebra, only the more
/// probable one.
pub fn peaks_of(map: &Map) -> Vec<Peak> {
    let probability = |row: usize, column: usize| sigmoid(f64::from(map.cell(row, column)[0]));
    let mut found = Vec::new();
    for row in 0..map.rows {
        for column in 0..map.columns {
            let own = probability(row, column);
            let rows = row.saturating_sub(1)..(row + 2).min(map.rows);
            let columns = column.saturating_sub(1)..(column + 2).min(map.columns);
            let is_largest =
                || rows.clone().all(|r| columns.clone().all(|c| probability(r, c) <= own));
            if own >= MIN_PROBABILITY && is_largest() {
                found.push(peak_at(map, row, column, own));
            }
        }
    }
    found.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let mut kept: Vec<Peak> = Vec::new();
    for peak in found {
        let is_apart = |other: &Peak| {
            let least = MIN_DISTANCE * (peak.height() + other.height()) / 2.0;
            length(from(other.centre, peak.centre)) > least
        };
        if kept.iter().all(is_apart) {
            kept.push(peak);
        }
    }
    kept
}

fn peak_at(map: &Map, row: usize, column: usize, probability: f64) -> Peak {
    let cell = map.cell(row, column);
    let middle = [(column as f64 + 0.5) * CELL, (row as f64 + 0.5) * CELL];
    let corners = [0, 1, 2, 3]
        .map(|k| [0, 1].map(|axis| middle[axis] + UNIT * f64::from(cell[CORNERS + 2 * k + axis])));
    let centre = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0);
    let levels: [f64; LEVELS] = std::array::from_fn(|level| f64::from(cell[FIRST_LEVEL + level]));
    let shares = softmax(&levels);
    Peak {
        centre,
        corners,
        probability,
        levels: std::array::from_fn(|level| shares[level]),
        is_seen: true,
    }
}

/// Cost of the lower vertebra being this number of steps below the upper one.
fn link_cost(upper: &Peak, lower: &Peak, steps: usize) -> f64 {
    let way = from(upper.centre, lower.centre);
    let (above, below) = (upper.axis(), lower.axis());
    let along = [0, 1].map(|i| above[i] / upper.height() + below[i] / lower.height());
    let turn = spineline::spatial::Angle::from_sin_cos(
        along[0] * way[1] - along[1] * way[0],
        along[0] * way[0] + along[1] * way[1],
    );
    let usual = steps as f64 * STEP_OVER_HEIGHT * (upper.height() + lower.height()) / 2.0;
    let ratio = (length(way).max(1e-6) / usual).ln();
    let doubt = (ratio / STEP_SPREAD).powi(2) + (turn.rad() / TURN_SPREAD_RAD).powi(2);
    0.25 * doubt + SKIP_COST * (steps - 1) as f64
}

/// A chain of vertebrae from above.
pub struct Chain {
    pub peaks: Vec<Peak>,
    /// The level of its first vertebra; T1 is zero. The last one is L5 (16) at most.
    pub first_level: usize,
}

/// The chain with the largest sum of probabilities and agreement of levels, less the costs of its steps.
///
/// A state is a centre with a level. The next centre has the next level, or the one after it; then the vertebra between
/// them is interpolated.
pub fn chain_of(peaks: &[Peak]) -> Option<Chain> {
    let mut peaks = peaks.to_vec();
    peaks.sort_by(|a, b| a.centre[1].total_cmp(&b.centre[1]));
    let mut totals: Vec<[f64; LEVELS]> = Vec::with_capacity(peaks.len());
    let mut links: Vec<[Option<(usize, usize)>; LEVELS]> = Vec::with_capacity(peaks.len());
    for lower in &peaks {
        let own = lower.levels.map(|share| {
            lower.probability + LEVEL_WEIGHT * (share.max(LEVEL_FLOOR).ln() + LEVEL_GAIN)
        });
        let (mut best, mut link) = (own, [None; LEVELS]);
        for (i, (upper, before)) in peaks.iter().zip(&totals).enumerate() {
            for steps in [1, 2] {
                let cost = link_cost(upper, lower, steps);
                if cost > MAX_LINK_COST {
                    continue;
                }
                for level in steps..LEVELS {
                    let total = before[level - steps] - cost + own[level];
                    if total > best[level] {
                        (best[level], link[level]) = (total, Some((i, level - steps)));
                    }
                }
            }
        }
        totals.push(best);
        links.push(link);
    }
    let states = (0..peaks.len()).flat_map(|peak| (0..LEVELS).map(move |level| (peak, level)));
    // The first one of equal maxima.
    let better = |a: (usize, usize), b: (usize, usize)| {
        if totals[b.0][b.1] > totals[a.0][a.1] { b } else { a }
    };
    let mut state = states.reduce(better)?;
    let mut chain = vec![peaks[state.0]];
    while let Some(before) = links[state.0][state.1] {
        if state.1 - before.1 == 2 {
            chain.push(Peak::between(&peaks[before.0], &peaks[state.0]));
        }
        chain.push(peaks[before.0]);
        state = before;
    }
    chain.reverse();
    Some(Chain { peaks: chain, first_level: state.1 })
}

/// Why the levels of a chain may be shifted, or vertebrae be missing; with all centres of the film.
pub fn doubts(peaks: &[Peak], chain: &Chain) -> Vec<Doubt> {
    let (own, first) = (&chain.peaks, chain.first_level as isize);
    let third = (own.len() / 3).max(1);
    let rest = own.len() - third;
    let mut doubts = Vec::new();
    if most_probable(&own[..third]) != first {
        doubts.push(Doubt::CountFromAbove);
    }
    if most_probable(&own[rest..]) - rest as isize != first {
        doubts.push(Doubt::CountFromBelow);
    }
    let probability = shares_of_levels(own, LEVEL_TEMPER)[chain.first_level + own.len() - 1];
    if probability < MIN_COUNT_PROBABILITY {
        doubts.push(Doubt::OtherCount { probability });
    }
    let [top, bottom] = [&own[0], &own[own.len() - 1]];
    let follows = |upper: &Peak, lower: &Peak| {
        upper.centre[1] < lower.centre[1] && link_cost(upper, lower, 1) < MAX_FOLLOWING_COST
    };
    let is_strong = |peak: &&Peak| peak.probability > MIN_FOLLOWING_PROBABILITY;
    if peaks.iter().filter(is_strong).any(|peak| follows(peak, top)) {
        doubts.push(Doubt::MoreAbove);
    }
    if peaks.iter().filter(is_strong).any(|peak| follows(bottom, peak)) {
        doubts.push(Doubt::MoreBelow);
    }
    if top.probability.min(bottom.probability) < MIN_END_PROBABILITY {
        doubts.push(Doubt::WeakEnd);
    }
    if own.len() < LEVELS {
        doubts.push(Doubt::Incomplete { found: own.len() });
    }
    if own.iter().any(|peak| !peak.is_seen) {
        doubts.push(Doubt::FilledIn);
    }
    doubts
}

/// The most probable level of the first vertebra of a part of a chain, by this part alone.
fn most_probable(part: &[Peak]) -> isize {
    let shares = shares_of_levels(part, 1.0);
    let best = (0..shares.len()).reduce(|a, b| if shares[b] > shares[a] { b } else { a });
    best.expect("there are levels") as isize + 1 - part.len() as isize
}

/// Probabilities of the levels of the first vertebra of a part of a chain, from `1 - length` to L5.
fn shares_of_levels(part: &[Peak], temper: f64) -> Vec<f64> {
    let score = |first: isize| {
        let own = |(place, peak): (usize, &Peak)| {
            let level = usize::try_from(first + place as isize).ok();
            let known = level.and_then(|level| peak.levels.get(level));
            known.map_or(0.5 * LEVEL_FLOOR, |share| share.max(LEVEL_FLOOR)).ln()
        };
        part.iter().enumerate().filter(|(_, peak)| peak.is_seen).map(own).sum::<f64>() / temper
    };
    let lowest = 1 - part.len() as isize;
    softmax(&(lowest..LEVELS as isize).map(score).collect::<Vec<f64>>())
}

fn sigmoid(x: f64) -> f64 {
    1.0 / (1.0 + (-x.clamp(-30.0, 30.0)).exp())
}

/// Shares with a sum of one.
pub fn softmax(values: &[f64]) -> Vec<f64> {
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let powers: Vec<f64> = values.iter().map(|value| (value - largest).exp()).collect();
    let sum: f64 = powers.iter().sum();
    powers.iter().map(|power| power / sum).collect()
}

pub fn from(start: [f64; 2], end: [f64; 2]) -> [f64; 2] {
    [end[0] - start[0], end[1] - start[1]]
}

pub fn length(vector: [f64; 2]) -> f64 {
    vector[0].hypot(vector[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vertebra of height 20 at a row, which its own levels take for this one.
    fn peak(row: f64, level: usize) -> Peak {
        let at = |x: f64, y: f64| [96.0 + x, row + y];
        let mut levels = [0.001; LEVELS];
        levels[level] = 1.0 - 0.001 * (LEVELS - 1) as f64;
        Peak {
            centre: [96.0, row],
            corners: [at(-15.0, -10.0), at(15.0, -10.0), at(-15.0, 10.0), at(15.0, 10.0)],
            probability: 0.9,
            levels,
            is_seen: true,
        }
    }

    const STEP: f64 = 20.0 * STEP_OVER_HEIGHT;

    fn row(place: usize) -> f64 {
        20.0 + STEP * place as f64
    }

    #[test]
    fn neighbours_make_a_chain_without_distant_centres() {
        let mut peaks: Vec<Peak> = (0..6).map(|k| peak(row(k), k)).collect();
        let mut aside = peak(20.0 + 2.5 * STEP, 3);
        aside.centre[0] += 80.0;
        peaks.push(aside);
        let chain = chain_of(&peaks).expect("a chain");
        assert_eq!((chain.peaks.len(), chain.first_level), (6, 0));
        assert!(chain.peaks.iter().all(|peak| peak.is_seen && peak.centre[0] < 100.0));
        assert!(chain_of(&[]).is_none());
    }

    #[test]
    fn a_missing_vertebra_is_put_between_its_neighbours() {
        let peaks: Vec<Peak> = [0, 1, 3, 4].map(|k| peak(row(k), k)).to_vec();
        let chain = chain_of(&peaks).expect("a chain");
        assert_eq!(chain.peaks.len(), 5);
        assert!(!chain.peaks[2].is_seen && (chain.peaks[2].centre[1] - row(2)).abs() < 1e-9);
        assert!(doubts(&peaks, &chain).contains(&Doubt::FilledIn));
    }

    #[test]
    fn levels_follow_the_votes_and_disagreement_is_doubted() {
        let of = |shift: [usize; 9]| -> Vec<Peak> {
            (0..9).map(|k| peak(row(k), k + shift[k])).collect()
        };
        let alike = of([2; 9]);
        let chain = chain_of(&alike).expect("a chain");
        assert_eq!(chain.first_level, 2);
        assert_eq!(doubts(&alike, &chain), [Doubt::Incomplete { found: 9 }]);
        // The upper third votes for one level further down than the others.
        let torn = of([3, 3, 3, 2, 2, 2, 2, 2, 2]);
        let chain = chain_of(&torn).expect("a chain");
        let doubts = doubts(&torn, &chain);
        assert_eq!(chain.first_level, 2);
        assert!(
            doubts.contains(&Doubt::CountFromAbove) && !doubts.contains(&Doubt::CountFromBelow)
        );
    }

    #[test]
    fn a_whole_chain_ends_at_l5_and_a_further_vertebra_is_doubted() {
        let mut peaks: Vec<Peak> = (0..17).map(|k| peak(row(k), k)).collect();
        let chain = chain_of(&peaks).expect("a chain");
        assert_eq!((chain.peaks.len(), doubts(&peaks, &chain)), (17, Vec::new()));
        peaks.push(peak(row(17), 16));
        let chain = chain_of(&peaks).expect("a chain");
        assert_eq!(chain.peaks.len(), 17);
        assert!(!doubts(&peaks, &chain).is_empty());
        peaks.truncate(17);
        peaks[0].probability = 0.2;
        let chain = chain_of(&peaks).expect("a chain");
        assert!(!doubts(&peaks, &chain).is_empty());
    }
}
