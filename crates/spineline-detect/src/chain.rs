//! From centres of vertebrae to the chain of them that is most probably a spine, and to the probability of its levels.
//!
//! A chain gives levels to some centres, from above: the next centre has the next level, or the one after it. Its odds are the product
//! of a factor per vertebra, by its probability and its votes for the level, and of a factor per step, by its length and direction
//! ([`Lattice`]). Iliac crests that a person marked vote on the levels of the nearest centres. The most probable chain names the
//! vertebrae; the sum over all chains gives the probability of their levels (forward-backward recursion). Gain, costs and weights below,
//! five numbers, were fitted to labelled films by maximum likelihood (`training/landmarks/levels.py`).

use crate::count::LevelCount;
use crate::peaks::{LEVELS, Peak, from, length};

/// Logarithm of the odds of a vertebra: this times its probability, less a cost.
const PEAK_GAIN: f64 = 6.1;
const PEAK_COST: f64 = 1.1;
/// Weight of the logarithm of its vote for the level. Neighbouring vertebrae err together, so that it is far below one.
const VOTE_WEIGHT: f64 = 0.07;
/// Smallest vote, so that a single vertebra cannot decide the count.
const VOTE_FLOOR: f64 = 0.01;
/// Weight of the squared deviation of a step.
const STEP_WEIGHT: f64 = 0.06;
/// Cost of a vertebra without a centre.
const SKIP_COST: f64 = 2.35;

/// Vertebrae beside which the iliac crests lie, of 802 adults, by level from T1 down (L3, L4, L5); the others are spread evenly
/// [ctspinopelvic1k].
const CRESTS_BESIDE: [(usize, f64); 3] = [(14, 73.0), (15, 645.0), (16, 43.0)];
const ADULTS: f64 = 802.0;
/// The crests vote on this many nearest centres, in equal parts, because one of them may not be a vertebra.
const NEAR_CRESTS: usize = 3;

/// Distance between neighbouring centres over the height of a vertebra: geometric mean of the training films.
const STEP_OVER_HEIGHT: f64 = 1.37;
/// Units of the logarithm of a step, and of its direction in rad; their deviations are 0.11 and 0.05 in the training films.
const STEP_SPREAD: f64 = 0.15;
const TURN_SPREAD_RAD: f64 = 0.30;
/// Squared deviation beyond which two centres are not neighbours: the first for neighbours, the second for a vertebra between them.
const MAX_DEVIATION: [f64; 2] = [10.0, 8.0];
/// Other counts of the vertebrae that are compared with the count of the chain.
const SHIFTS: [isize; 6] = [-1, 1, -2, 2, -3, 3];

/// Squared deviation of the lower vertebra being this number of levels below the upper one.
fn deviation(upper: &Peak, lower: &Peak, levels: usize) -> f64 {
    let way = from(upper.centre, lower.centre);
    let (above, below) = (upper.axis(), lower.axis());
    let along = [0, 1].map(|i| above[i] / upper.height() + below[i] / lower.height());
    let turn = spineline::spatial::Angle::from_sin_cos(
        along[0] * way[1] - along[1] * way[0],
        along[0] * way[0] + along[1] * way[1],
    );
    let usual = levels as f64 * STEP_OVER_HEIGHT * (upper.height() + lower.height()) / 2.0;
    let ratio = (length(way).max(1e-6) / usual).ln();
    (ratio / STEP_SPREAD).powi(2) + (turn.rad() / TURN_SPREAD_RAD).powi(2)
}

/// A step between two centres.
struct Link {
    upper: usize,
    lower: usize,
    /// One, or two with an unseen vertebra between.
    levels: usize,
    /// Logarithm of its odds.
    log_odds: f64,
}

/// All chains of the centres of a film.
struct Lattice {
    /// From above.
    peaks: Vec<Peak>,
    /// Logarithms of the odds of every centre as every level.
    own: Vec<[f64; LEVELS]>,
    /// By the lower centre.
    links: Vec<Link>,
}

/// A centre as a level.
type State = (usize, usize);

/// Adds the votes of the crests' middle to the odds of the nearest centres.
fn add_crests(own: &mut [[f64; LEVELS]], peaks: &[Peak], crests: [f64; 2]) {
    // By how many levels the crests lie below each centre.
    let below = |peak: &Peak| {
        let (way, axis) = (from(peak.centre, crests), peak.axis());
        (way[0] * axis[0] + way[1] * axis[1]) / (STEP_OVER_HEIGHT * peak.height().powi(2))
    };
    let mut nearest: Vec<(usize, f64)> = peaks.iter().map(below).enumerate().collect();
    nearest.sort_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    for &(peak, below) in nearest.iter().take(NEAR_CRESTS) {
        for (level, odds) in own[peak].iter_mut().enumerate() {
            *odds += crest_vote(level as f64 + below).ln() / NEAR_CRESTS as f64;
        }
    }
}

/// Share of people whose crests lie at a level, times the number of levels; linear between levels.
fn crest_vote(level: f64) -> f64 {
    let known: f64 = CRESTS_BESIDE.iter().map(|(_, people)| *people).sum();
    let rest = (ADULTS - known) / (LEVELS - CRESTS_BESIDE.len()) as f64;
    let people = |level: isize| {
        let found = CRESTS_BESIDE.iter().find(|(place, _)| *place as isize == level);
        found.map_or(rest, |(_, people)| *people)
    };
    let (lower, part) = (level.floor() as isize, level - level.floor());
    let people = people(lower) * (1.0 - part) + people(lower + 1) * part;
    people / ADULTS * LEVELS as f64
}

impl Lattice {
    fn of(peaks: &[Peak], crests: Option<[f64; 2]>) -> Self {
        let mut peaks = peaks.to_vec();
        peaks.sort_by(|a, b| a.centre[1].total_cmp(&b.centre[1]));
        let own = |peak: &Peak| {
            let seen = PEAK_GAIN * peak.probability - PEAK_COST;
            peak.levels.map(|vote| seen + VOTE_WEIGHT * vote.max(VOTE_FLOOR).ln())
        };
        let mut links = Vec::new();
        for lower in 0..peaks.len() {
            for (upper, levels) in (0..lower).flat_map(|upper| [(upper, 1), (upper, 2)]) {
                let deviation = deviation(&peaks[upper], &peaks[lower], levels);
                if deviation < MAX_DEVIATION[levels - 1] {
                    let log_odds = -STEP_WEIGHT * deviation - SKIP_COST * (levels - 1) as f64;
                    links.push(Link { upper, lower, levels, log_odds });
                }
            }
        }
        let mut own: Vec<[f64; LEVELS]> = peaks.iter().map(own).collect();
        if let Some(crests) = crests {
            add_crests(&mut own, &peaks, crests);
        }
        Self { own, peaks, links }
    }

    /// The most probable chain, from above.
    fn best(&self) -> Option<Vec<State>> {
        let mut totals = self.own.clone();
        let mut before = vec![[None; LEVELS]; totals.len()];
        for link in &self.links {
            for level in link.levels..LEVELS {
                let above = (link.upper, level - link.levels);
                let total = totals[above.0][above.1] + link.log_odds + self.own[link.lower][level];
                if total > totals[link.lower][level] {
                    totals[link.lower][level] = total;
                    before[link.lower][level] = Some(above);
                }
            }
        }
        let states = (0..totals.len()).flat_map(|peak| (0..LEVELS).map(move |level| (peak, level)));
        // The first one of equal maxima.
        let better = |a: State, b: State| if totals[b.0][b.1] > totals[a.0][a.1] { b } else { a };
        let last = states.reduce(better)?;
        let mut states: Vec<State> =
            std::iter::successors(Some(last), |&(peak, level)| before[peak][level]).collect();
        states.reverse();
        Some(states)
    }

    /// Logarithms of the probabilities over all chains.
    fn marginals(&self) -> Marginals<'_> {
        let (mut above, mut below) = (self.own.clone(), vec![[0.0; LEVELS]; self.own.len()]);
        for link in &self.links {
            for level in link.levels..LEVELS {
                let ending = above[link.upper][level - link.levels] + link.log_odds;
                let total = &mut above[link.lower][level];
                *total = log_sum(*total, ending + self.own[link.lower][level]);
            }
        }
        for link in self.links.iter().rev() {
            for level in link.levels..LEVELS {
                let following = self.own[link.lower][level] + below[link.lower][level];
                let total = &mut below[link.upper][level - link.levels];
                *total = log_sum(*total, link.log_odds + following);
            }
        }
        let all = above.iter().flatten().copied().fold(f64::NEG_INFINITY, log_sum);
        Marginals { lattice: self, above, below, all }
    }
}

/// Sums over all chains: those that end at a centre as a level, what follows it below, and all.
struct Marginals<'a> {
    lattice: &'a Lattice,
    above: Vec<[f64; LEVELS]>,
    below: Vec<[f64; LEVELS]>,
    all: f64,
}

impl Marginals<'_> {
    /// Logarithm of the probability of a centre as a level.
    fn of(&self, (peak, level): State) -> f64 {
        self.above[peak][level] + self.below[peak][level] - self.all
    }

    /// Logarithm of the probability of two centres with an unseen vertebra between.
    fn of_gap(&self, upper: State, lower: State) -> f64 {
        let is_gap = |link: &&Link| (link.upper, link.lower, link.levels) == (upper.0, lower.0, 2);
        let link = self.lattice.links.iter().find(is_gap);
        let log_odds = link.map_or(f64::NEG_INFINITY, |link| link.log_odds);
        let following = self.lattice.own[lower.0][lower.1] + self.below[lower.0][lower.1];
        self.above[upper.0][upper.1] + log_odds + following - self.all
    }

    /// How sure the levels of a chain are.
    fn count(&self, chain: &[State]) -> LevelCount {
        let seen = chain.iter().map(|&state| self.of(state));
        let pairs = chain.windows(2).filter(|pair| pair[1].1 - pair[0].1 == 2);
        let unseen = pairs.map(|pair| self.of_gap(pair[0], pair[1]));
        let logs: Vec<f64> = seen.chain(unseen).collect();
        let shifted = |shift: isize| {
            let of = |&(peak, level): &State| {
                let level = level.checked_add_signed(shift).filter(|&level| level < LEVELS);
                level.map_or(0.0, |level| self.of((peak, level)).exp())
            };
            (shift, chain.iter().map(of).sum::<f64>() / chain.len() as f64)
        };
        let more = |a: (isize, f64), b: (isize, f64)| if b.1 > a.1 { b } else { a };
        let (other_shift, other_probability) =
            SHIFTS.map(shifted).into_iter().reduce(more).expect("there are shifts");
        LevelCount {
            probability: (logs.iter().sum::<f64>() / logs.len() as f64).exp(),
            other_shift,
            other_probability,
        }
    }
}

/// A chain of vertebrae from above.
pub struct Chain {
    pub peaks: Vec<Peak>,
    /// The level of its first vertebra; T1 is zero. The last one is L5 (16) at most.
    pub first_level: usize,
    /// How sure its levels are.
    pub count: LevelCount,
}

/// The most probable chain of the centres of a film, also by the middle of the iliac crests where a person marked them. An unseen vertebra
/// is put between its neighbours.
pub fn chain_of(peaks: &[Peak], crests: Option<[f64; 2]>) -> Option<Chain> {
    let lattice = Lattice::of(peaks, crests);
    let states = lattice.best()?;
    let mut chain: Vec<Peak> = Vec::new();
    for (place, &(peak, level)) in states.iter().enumerate() {
        let lower = lattice.peaks[peak];
        let above = place.checked_sub(1).map(|place| states[place]);
        if let Some((upper, _)) = above.filter(|&(_, before)| level - before == 2) {
            chain.push(Peak::between(&lattice.peaks[upper], &lower));
        }
        chain.push(lower);
    }
    let count = lattice.marginals().count(&states);
    Some(Chain { peaks: chain, first_level: states[0].1, count })
}

/// Logarithm of the sum of two exponentials.
fn log_sum(a: f64, b: f64) -> f64 {
    let (larger, smaller) = if a > b { (a, b) } else { (b, a) };
    if smaller == f64::NEG_INFINITY { larger } else { larger + (smaller - larger).exp().ln_1p() }
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
        let chain = chain_of(&peaks, None).expect("a chain");
        assert_eq!((chain.peaks.len(), chain.first_level), (6, 0));
        assert!(chain.peaks.iter().all(|peak| peak.is_seen && peak.centre[0] < 100.0));
        assert!(chain_of(&[], None).is_none());
    }

    #[test]
    fn a_missing_vertebra_is_put_between_its_neighbours() {
        let peaks: Vec<Peak> = [0, 1, 3, 4].map(|k| peak(row(k), k)).to_vec();
        let chain = chain_of(&peaks, None).expect("a chain");
        assert_eq!(chain.peaks.len(), 5);
        assert!(!chain.peaks[2].is_seen && (chain.peaks[2].centre[1] - row(2)).abs() < 1e-9);
    }

    /// Every chain with the logarithm of its odds.
    fn every_chain(lattice: &Lattice) -> Vec<(Vec<State>, f64)> {
        let states = (0..lattice.peaks.len()).flat_map(|k| (0..LEVELS).map(move |l| (k, l)));
        let mut open: Vec<(Vec<State>, f64)> =
            states.map(|(k, l)| (vec![(k, l)], lattice.own[k][l])).collect();
        let mut all = Vec::new();
        while let Some((chain, log_odds)) = open.pop() {
            let (k, l) = chain[chain.len() - 1];
            for link in lattice.links.iter().filter(|link| link.upper == k) {
                let next = (link.lower, l + link.levels);
                if next.1 < LEVELS {
                    let own = lattice.own[next.0][next.1];
                    let longer = [&chain[..], &[next]].concat();
                    open.push((longer, log_odds + link.log_odds + own));
                }
            }
            all.push((chain, log_odds));
        }
        all
    }

    #[test]
    fn probabilities_and_the_best_chain_are_those_of_all_chains_counted_one_by_one() {
        let mut peaks: Vec<Peak> = [0, 1, 2, 4, 5].map(|k| peak(row(k), k + 3)).to_vec();
        peaks[1].probability = 0.3;
        peaks.push(Peak { probability: 0.2, ..peak(row(2) + 9.0, 6) });
        let lattice = Lattice::of(&peaks, None);
        let all = every_chain(&lattice);
        let total: f64 = all.iter().map(|(_, log_odds)| log_odds.exp()).sum();
        let share = |holds: &dyn Fn(&[State]) -> bool| {
            let these = all.iter().filter(|(chain, _)| holds(chain));
            these.map(|(_, log_odds)| log_odds.exp()).sum::<f64>() / total
        };
        let marginals = lattice.marginals();
        for state in (0..peaks.len()).flat_map(|k| (0..LEVELS).map(move |l| (k, l))) {
            let expected = share(&|chain| chain.contains(&state));
            assert!((marginals.of(state).exp() - expected).abs() < 1e-12, "{state:?}");
        }
        let (upper, lower) = ((2, 5), (4, 7));
        let expected = share(&|chain| chain.windows(2).any(|pair| pair == [upper, lower]));
        assert!(expected > 0.1 && (marginals.of_gap(upper, lower).exp() - expected).abs() < 1e-12);
        let best = all.iter().max_by(|a, b| a.1.total_cmp(&b.1)).expect("chains");
        assert_eq!(lattice.best().as_ref(), Some(&best.0));
    }

    #[test]
    fn votes_decide_the_count_and_torn_votes_make_it_improbable() {
        let of = |shift: [usize; 9]| -> LevelCount {
            let peaks: Vec<Peak> = (0..9).map(|k| peak(row(k), k + shift[k])).collect();
            let chain = chain_of(&peaks, None).expect("a chain");
            assert_eq!((chain.peaks.len(), chain.first_level), (9, 2));
            chain.count
        };
        let (alike, torn) = (of([2; 9]), of([3, 3, 3, 3, 2, 2, 2, 2, 2]));
        assert!(alike.probability > torn.probability + 0.1, "{alike}; {torn}");
        assert_eq!(torn.other_shift, 1);
        assert!(torn.other_probability > 0.2, "{torn}");
    }

    #[test]
    fn a_whole_chain_is_sure_and_an_eighteenth_centre_makes_it_doubtful() {
        let mut peaks: Vec<Peak> = (0..17).map(|k| peak(row(k), k)).collect();
        let chain = chain_of(&peaks, None).expect("a chain");
        assert!(chain.peaks.len() == 17 && chain.count.is_sure(), "{}", chain.count);
        // Every vertebra votes for two levels alike.
        peaks.push(peak(row(17), 16));
        for (k, peak) in peaks.iter_mut().enumerate() {
            let is_voted = |level: usize| level == k || level + 1 == k;
            peak.levels = std::array::from_fn(|level| if is_voted(level) { 0.5 } else { 0.0 });
        }
        let count = chain_of(&peaks, None).expect("a chain").count;
        assert!(!count.is_sure() && count.other_shift.abs() == 1, "{count}");
        assert!((count.probability - count.other_probability).abs() < 0.1, "{count}");
    }

    #[test]
    fn crests_beside_a_vertebra_make_it_l4() {
        // Centres with equal votes for all levels.
        let silent = |k: usize| Peak { levels: [1.0 / LEVELS as f64; LEVELS], ..peak(row(k), k) };
        let peaks: Vec<Peak> = (0..12).map(silent).collect();
        let last = 11;
        for (beside, first_level) in [(last, 15 - last), (last - 1, 16 - last)] {
            let chain = chain_of(&peaks, Some([100.0, row(beside)])).expect("a chain");
            assert_eq!((chain.peaks.len(), chain.first_level), (12, first_level), "{beside}");
        }
        let sure = |crests| chain_of(&peaks, crests).expect("a chain").count.probability;
        assert!(sure(Some([100.0, row(last)])) > 2.0 * sure(None));
    }

    #[test]
    fn crests_vote_by_the_shares_of_the_adults() {
        let share = |level: f64| crest_vote(level) / LEVELS as f64;
        let rest = 41.0 / 14.0;
        let people = [(14.0, 73.0), (15.0, 645.0), (16.0, 43.0), (14.5, 359.0), (3.0, rest)];
        for (level, people) in people {
            assert!((share(level) - people / 802.0).abs() < 1e-12, "{level}");
        }
        assert!(((0..LEVELS).map(|level| share(level as f64)).sum::<f64>() - 1.0).abs() < 1e-12);
        let peaks: Vec<Peak> = (0..5).map(|k| peak(row(k), k)).collect();
        let [with, without] =
            [Some([96.0, row(4)]), None].map(|crests| Lattice::of(&peaks, crests).own);
        let added = |k: usize, level: usize| with[k][level] - without[k][level];
        let beside_l4 = (645.0 / 802.0 * LEVELS as f64).ln() / 3.0;
        for (k, level) in [(4, 15), (3, 14), (2, 13)] {
            assert!((added(k, level) - beside_l4).abs() < 1e-9, "{k}");
        }
        assert!(added(1, 12).abs() < 1e-12, "three centres are the nearest");
    }
}
