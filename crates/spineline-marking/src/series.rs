//! Levels of bodies without names, by the lengths of the same patient's erect film.

use std::fmt;

use spineline::anatomy::{Level, Posture};
use spineline::measure::completion::complete;
use spineline::measure::{Corners, IliacCrests, ImageGeometry, median};
use spineline::spatial::{Frontal, Pixel};
use spineline::warning::levels_apart;

use super::ErectFilm;

/// Levels from L5 to T1.
const LEVELS: usize = Level::ALL.len();

/// Standard deviations of the logarithms of a detected width, height and step between centres against the erect film's (assumption
/// from the error of detected corners, 14 % of a height).
const WIDTH_SD: f64 = 0.06;
const HEIGHT_SD: f64 = 0.15;
const STEP_SD: f64 = 0.08;
/// A difference beyond this number of standard deviations costs no more: a corner of the body is wrong.
const MOST_SDS: f64 = 3.0;
/// The same for a step. A step over a missed vertebra has twice the length, and this must cost more than `SKIP_COST`.
const MOST_STEP_SDS: f64 = 5.0;
/// Cost of a vertebra without a body, and of a body beside the series, in squared standard deviations.
const SKIP_COST: f64 = 9.0;
/// Weight of the logarithm of a vote. Neighbouring bodies vote alike, so that it is below one (assumption; the detector has 0.07).
const VOTE_WEIGHT: f64 = 0.25;
/// Smallest share of a vote, so that a single body cannot decide.
const VOTE_FLOOR: f64 = 0.01;
/// Standard deviation of the distance of the crests' middle from a body against the erect film: in steps between centres, and as a part
/// of the distance (assumption: the pelvis rotates against L4, bodies against each other, and marks err).
const CREST_SD: f64 = 0.3;
const CREST_SD_SHARE: f64 = 0.1;
/// The crests count for this many nearest bodies, in equal parts, because one of them may lie beside the series.
const NEAR_CRESTS: usize = 3;
/// Common scale of a film in millimetres over the erect one's, and the scales that are tried: logarithms.
const SCALE_SD: f64 = 0.05;
const SCALES: i32 = 30;
const SCALE_STEP: f64 = 0.01;
/// Bodies in a row that may lie beside the series, such as the sacrum and C7.
const MOST_BESIDE: usize = 2;
/// Costs of one match through several bodies differ by rounding only. Matches whose costs differ by less count as one.
const SAME: f64 = 1e-9;
/// Lead of a match that is ten times as probable as the second best one.
const CLEAR_LEAD: f64 = 4.6;

/// A body in a picture without a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamelessBody {
    /// Its corners.
    pub corners: Corners<Pixel>,
    /// Probabilities of the levels by its look, from L5 to T1.
    pub votes: [f64; LEVELS],
}

/// The levels of a series of bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelMatch {
    /// The levels of the bodies, caudal first; `None` for a body beside the series.
    pub levels: Vec<Option<Level>>,
    /// Whether the iliac crests of both films took part.
    pub by_crests: bool,
    /// The best match in which a body has another level.
    pub second: SecondMatch,
}

/// A match that fits less well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondMatch {
    /// The most caudal and the most cranial level that differ; `None` where all do.
    pub range: Option<[Level; 2]>,
    /// By how many levels the most caudal one is shifted; positive where it is more cranial.
    pub shift: isize,
    /// By how many squared standard deviations it is worse.
    pub lead: f64,
}

impl LevelMatch {
    /// Whether the second best match has a tenth of the probability of this one at most, and all bodies between the others have a level: a
    /// body without one mostly means that the detector missed vertebrae beside it.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.is_best() && !self.skips_a_body()
    }

    fn is_best(&self) -> bool {
        self.second.lead >= CLEAR_LEAD
    }

    fn skips_a_body(&self) -> bool {
        self.levels.split(Option::is_none).filter(|run| !run.is_empty()).count() > 1
    }
}

impl fmt::Display for LevelMatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SecondMatch { range, shift, .. } = self.second;
        let crests = if self.by_crests { " and the crests" } else { "" };
        let range = match range {
            None => "all vertebrae".to_owned(),
            Some([lowest, highest]) if lowest == highest => lowest.to_string(),
            Some([lowest, highest]) => format!("{lowest} to {highest}"),
        };
        let shifted = levels_apart(shift);
        write!(f, "matched to the erect film{crests}; second best puts {range} {shifted}")?;
        if !self.is_best() {
            f.write_str(", and fits nearly as well")?;
        }
        if self.skips_a_body() {
            f.write_str("; a body between the others has no level: check the levels beside it")?;
        }
        if !self.is_clear() && !self.by_crests {
            f.write_str("; mark the crests on both films, and try again")?;
        }
        Ok(())
    }
}

/// Logarithms of the lengths of a body, and its place.
struct Size {
    width: f64,
    height: f64,
    centre: Frontal,
    /// Unit vector towards its superior endplate.
    up: Frontal,
}

impl Size {
    fn of(body: &Corners<Frontal>) -> Self {
        let (width, height) = (body.mean_width_mm().ln(), body.height_mm().ln());
        Self { width, height, centre: body.centre(), up: Frontal::leaning(body.measure_tilt()) }
    }

    /// How far a place lies above the centre.
    fn above_mm(&self, place: Frontal) -> f64 {
        (place - self.centre).dot(self.up)
    }

    /// Logarithm of the distance to another body.
    fn step(&self, other: &Self) -> f64 {
        self.centre.distance_mm(other.centre).ln()
    }
}

impl ErectFilm {
    /// The levels of neighbouring bodies on another film, caudal first, by dynamic programming: the next body has the level above, or the
    /// second or third one above, and a body may lie beside the series. Where both films show the crests, they tell the levels of the
    /// nearest bodies. `None` for fewer than three bodies, and where no other match is possible.
    #[must_use]
    pub fn match_levels(
        &self,
        image: &ImageGeometry,
        bodies: &[NamelessBody],
        crests: Option<IliacCrests>,
    ) -> Option<LevelMatch> {
        let erect = complete(&self.image, Some(Posture::Erect), &self.reading.clicks(&self.image));
        let erect = erect.ok().filter(|_| bodies.len() >= NEAR_CRESTS)?;
        let frontal =
            |body: &NamelessBody| Size::of(&body.corners.map(|corner| image.frontal(corner)));
        let own: Vec<Size> = bodies.iter().map(frontal).collect();
        let known = Level::ALL.map(|level| Size::of(&erect.corners(level)));
        let crests = crests.zip(self.reading.iliac_crests());
        let crests = crests.map(|(here, there)| {
            Crests::new(&own, here.middle(image), &known, there.middle(&self.image))
        });
        let in_mm = image.scale().is_some() && self.image.scale().is_some();
        let about = if in_mm { 0.0 } else { median_step(&own) - median_step(&known) };
        let mut costs = vec![[f64::INFINITY; LEVELS]; bodies.len()];
        for scale in (-SCALES..=SCALES).map(|step| SCALE_STEP * f64::from(step)) {
            let prior = if in_mm { (scale / SCALE_SD).powi(2) } else { 0.0 };
            let (scale, crests) = (about + scale, crests.as_ref());
            let series = Series { bodies, own: &own, known: &known, crests, scale };
            for (least, cost) in costs.iter_mut().flatten().zip(series.costs().into_flattened()) {
                *least = least.min(cost + prior);
            }
        }
        let least = costs.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        let place = |of_levels: &[f64; LEVELS]| of_levels.iter().position(|&c| c < least + SAME);
        let places: Vec<Option<usize>> = costs.iter().map(place).collect();
        Some(LevelMatch {
            levels: places.iter().map(|place| Some(Level::ALL[(*place)?])).collect(),
            by_crests: crests.is_some(),
            second: second(&costs, &places, least)?,
        })
    }
}

/// The cheapest match in which a body has another level.
fn second(costs: &[[f64; LEVELS]], places: &[Option<usize>], least: f64) -> Option<SecondMatch> {
    let others = costs.iter().zip(places).filter_map(|(of_levels, place)| {
        let others = (0..LEVELS).filter(|level| Some(*level) != *place);
        let other = others.min_by(|a, b| of_levels[*a].total_cmp(&of_levels[*b]))?;
        Some(((*place)?, other, of_levels[other] - least))
    });
    let others: Vec<(usize, usize, f64)> = others.collect();
    let lead = others.iter().map(|other| other.2).fold(f64::INFINITY, f64::min);
    let differing: Vec<_> = others.iter().filter(|other| other.2 < lead + SAME).collect();
    let (lowest, highest) = (differing.first()?, differing.last()?);
    let range = [Level::ALL[lowest.0], Level::ALL[highest.0]];
    let range = (differing.len() < others.len()).then_some(range);
    Some(SecondMatch { range, shift: lowest.1 as isize - lowest.0 as isize, lead })
}

/// How far the middle of the crests lies above each body of a film, and above the vertebrae of the erect film.
struct Crests {
    above_mm: Vec<f64>,
    above_known_mm: [f64; LEVELS],
    /// The farthest body that counts.
    reach_mm: f64,
    sd_mm: f64,
}

impl Crests {
    fn new(own: &[Size], here: Frontal, known: &[Size; LEVELS], there: Frontal) -> Self {
        let above_mm: Vec<f64> = own.iter().map(|body| body.above_mm(here)).collect();
        let mut distances: Vec<f64> = above_mm.iter().map(|mm| mm.abs()).collect();
        distances.sort_by(f64::total_cmp);
        Self {
            above_mm,
            above_known_mm: known.each_ref().map(|vertebra| vertebra.above_mm(there)),
            reach_mm: distances[NEAR_CRESTS - 1],
            sd_mm: CREST_SD * median_step(known).exp(),
        }
    }

    /// Cost of a body having a level.
    fn cost(&self, body: usize, level: usize, scale: f64) -> f64 {
        if self.above_mm[body].abs() > self.reach_mm {
            return 0.0;
        }
        let above_mm = self.above_mm[body] / scale.exp();
        let sd_mm = self.sd_mm.hypot(CREST_SD_SHARE * above_mm);
        // Without a limit, unlike a length: a person marked the crests.
        ((above_mm - self.above_known_mm[level]) / sd_mm).powi(2) / NEAR_CRESTS as f64
    }
}

/// Bodies and the vertebrae of the erect film, at a common scale.
struct Series<'a> {
    bodies: &'a [NamelessBody],
    own: &'a [Size],
    known: &'a [Size],
    crests: Option<&'a Crests>,
    scale: f64,
}

impl Series<'_> {
    /// Cost of the cheapest match in which a body has a level, by body and level; infinite where it cannot have it.
    fn costs(&self) -> Vec<[f64; LEVELS]> {
        let count = self.own.len();
        let own: Vec<[f64; LEVELS]> =
            (0..count).map(|body| std::array::from_fn(|level| self.cost(body, level))).collect();
        let beside = |bodies: usize| match bodies {
            0..=MOST_BESIDE => SKIP_COST * bodies as f64,
            _ => f64::INFINITY,
        };
        let ways = || [1, 2].into_iter().flat_map(|by| [1, 2, 3].map(|up| (by, up)));
        // Of the body with those below it, and with those above it.
        let (mut below, mut above) = (own.clone(), own.clone());
        for body in 0..count {
            for level in 0..LEVELS {
                let last = ways().filter_map(|(by, up)| {
                    let (lower, under) = (body.checked_sub(by)?, level.checked_sub(up)?);
                    Some(below[lower][under] + self.link(lower, under, by, up))
                });
                below[body][level] += last.fold(beside(body), f64::min);
            }
        }
        for body in (0..count).rev() {
            for level in 0..LEVELS {
                let next = ways().filter_map(|(by, up)| {
                    let after = above.get(body + by)?.get(level + up)?;
                    Some(after + self.link(body, level, by, up))
                });
                above[body][level] += next.fold(beside(count - 1 - body), f64::min);
            }
        }
        let whole =
            |body: usize, level: usize| below[body][level] + above[body][level] - own[body][level];
        (0..count).map(|body| std::array::from_fn(|level| whole(body, level))).collect()
    }

    /// Cost of the step from a body to the one that is `by` places and `up` levels above it.
    fn link(&self, body: usize, level: usize, by: usize, up: usize) -> f64 {
        let step = self.own[body].step(&self.own[body + by]);
        let off = step - self.known[level].step(&self.known[level + up]) - self.scale;
        squared(off, STEP_SD, MOST_STEP_SDS) + SKIP_COST * (by + up - 2) as f64
    }

    /// Cost of a body having a level.
    fn cost(&self, body: usize, level: usize) -> f64 {
        let (own, known) = (&self.own[body], &self.known[level]);
        let vote = self.bodies[body].votes[level].max(VOTE_FLOOR);
        squared(own.width - known.width - self.scale, WIDTH_SD, MOST_SDS)
            + squared(own.height - known.height - self.scale, HEIGHT_SD, MOST_SDS)
            - 2.0 * VOTE_WEIGHT * vote.ln()
            + self.crests.map_or(0.0, |crests| crests.cost(body, level, self.scale))
    }
}

fn squared(off: f64, sd: f64, most_sds: f64) -> f64 {
    (off / sd).abs().min(most_sds).powi(2)
}

fn median_step(sizes: &[Size]) -> f64 {
    let steps = sizes.windows(2).map(|pair| pair[0].step(&pair[1]));
    median(steps.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertebrae of slowly changing size, one above the other.
    fn vertebra(place: usize) -> Size {
        let place = place as f64;
        Size {
            width: (48.0 - 1.1 * place).ln(),
            height: (27.0 - 0.5 * place).ln(),
            centre: Frontal::new(0.0, 34.0 * place - 0.4 * place * place),
            up: Frontal::new(0.0, 1.0),
        }
    }

    /// The cost of a match, summed over bodies and steps; `None` where it is not allowed.
    fn cost_of(series: &Series<'_>, levels: &[Option<usize>]) -> Option<f64> {
        let named: Vec<(usize, usize)> =
            levels.iter().enumerate().filter_map(|(body, level)| Some((body, (*level)?))).collect();
        let (first, last) = (named.first()?.0, levels.len() - 1 - named.last()?.0);
        let mut cost = SKIP_COST * (first + last) as f64;
        for pair in named.windows(2) {
            let [(body, level), (next, upper)] = [pair[0], pair[1]];
            let (by, up) = (next - body, upper.checked_sub(level)?);
            if by > 2 || !(1..=3).contains(&up) {
                return None;
            }
            cost += series.link(body, level, by, up);
        }
        cost += named.iter().map(|&(body, level)| series.cost(body, level)).sum::<f64>();
        (first <= MOST_BESIDE && last <= MOST_BESIDE).then_some(cost)
    }

    #[test]
    fn the_cheapest_matches_are_those_of_all_matches_counted_one_by_one() {
        // Vertebrae 3, 4, 6 and 7: one was missed.
        let own: Vec<Size> = [3, 4, 6, 7].map(vertebra).into();
        let known: [Size; LEVELS] = std::array::from_fn(vertebra);
        let corners = Corners::from([Pixel::new(0.0, 0.0); 4]);
        let bodies = vec![NamelessBody { corners, votes: [1.0 / LEVELS as f64; LEVELS] }; 4];
        let crests = Crests::new(&own, Frontal::new(0.0, 40.0), &known, Frontal::new(0.0, 41.0));
        let series = Series {
            bodies: &bodies,
            own: &own,
            known: &known,
            crests: Some(&crests),
            scale: 0.01,
        };
        let mut all = vec![Vec::new()];
        for _ in 0..4 {
            let levels = || std::iter::once(None).chain((0..LEVELS).map(Some));
            let longer =
                |one: &Vec<_>| levels().map(|level| [&one[..], &[level]].concat()).collect();
            all = all.iter().flat_map::<Vec<Vec<Option<usize>>>, _>(longer).collect();
        }
        let all: Vec<(Vec<Option<usize>>, f64)> = all
            .into_iter()
            .filter_map(|levels| cost_of(&series, &levels).map(|cost| (levels, cost)))
            .collect();
        let least = |holds: &dyn Fn(&[Option<usize>]) -> bool| {
            let these = all.iter().filter(|(levels, _)| holds(levels));
            these.map(|(_, cost)| *cost).fold(f64::INFINITY, f64::min)
        };
        let costs = series.costs();
        for (body, level) in (0..4).flat_map(|body| (0..LEVELS).map(move |level| (body, level))) {
            let expected = least(&|levels| levels[body] == Some(level));
            let own = costs[body][level];
            let is_same = if own.is_infinite() {
                expected.is_infinite()
            } else {
                (own - expected).abs() < 1e-9
            };
            assert!(is_same, "{body} {level}: {own} {expected}");
        }
        let best = [Some(3), Some(4), Some(6), Some(7)];
        let least_of_all = least(&|_| true);
        assert!((least(&|levels| levels == best) - least_of_all).abs() < 1e-9);
        let differs = |levels: &[Option<usize>]| {
            levels.iter().zip(&best).any(|(level, best)| level.is_some() && level != best)
        };
        let second = second(&costs, &best, least_of_all).expect("a second match");
        assert!((second.lead - (least(&differs) - least_of_all)).abs() < 1e-9);
    }

    #[test]
    fn a_match_says_what_to_check() {
        let matched = |levels: [Option<Level>; 3], range, lead| LevelMatch {
            levels: levels.into(),
            by_crests: false,
            second: SecondMatch { range, shift: -1, lead },
        };
        let all = [Some(Level::L4), Some(Level::L3), Some(Level::L2)];
        let gap = [Some(Level::L4), None, Some(Level::L2)];
        let second = "matched to the erect film; second best puts";
        let mark = "; mark the crests on both films, and try again";
        for (one, text) in [
            (matched(all, None, 9.0), format!("{second} all vertebrae one level lower")),
            (
                matched(all, Some([Level::L3, Level::L2]), 1.0),
                format!("{second} L3 to L2 one level lower, and fits nearly as well{mark}"),
            ),
            (
                matched(gap, Some([Level::L2, Level::L2]), 9.0),
                format!(
                    "{second} L2 one level lower; a body between the others has no level: check the levels beside it{mark}"
                ),
            ),
        ] {
            assert_eq!(one.to_string(), text);
            assert_eq!(one.is_clear(), !text.ends_with(mark));
        }
    }
}
