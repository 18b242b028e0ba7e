//! Levels of bodies without names, by the lengths of the same patient's erect film.

use std::fmt;

use spineline::anatomy::{Level, Posture};
use spineline::measure::completion::complete;
use spineline::measure::{Corners, ImageGeometry, median};
use spineline::spatial::{Frontal, Pixel};

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
/// Cost of a vertebra without a body, and of a body beside the series, in squared standard deviations.
const SKIP_COST: f64 = 9.0;
/// Neighbouring bodies vote alike: the votes of a quarter of them count, as in the detector.
const VOTE_WEIGHT: f64 = 0.25;
/// Smallest share of a vote, so that a single body cannot decide.
const VOTE_FLOOR: f64 = 0.01;
/// Common scale of a film in millimetres over the erect one's, and the scales that are tried: logarithms.
const SCALE_SD: f64 = 0.05;
const SCALES: i32 = 30;
const SCALE_STEP: f64 = 0.01;
/// Bodies in a row that may lie beside the series, such as the sacrum and C7.
const MOST_BESIDE: usize = 2;
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
    /// By how many levels the second best match is shifted; positive where it is more cranial.
    pub second: i32,
    /// By how many squared standard deviations it is worse.
    pub lead: f64,
}

impl LevelMatch {
    /// Whether the second best match has a tenth of the probability of this one at most.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.lead >= CLEAR_LEAD
    }
}

impl fmt::Display for LevelMatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (count, way) = (self.second.abs(), if self.second > 0 { "up" } else { "down" });
        let levels = if count == 1 { "one level".to_owned() } else { format!("{count} levels") };
        let how = if self.is_clear() { "" } else { " and fits nearly as well" };
        write!(f, "matched to the erect film; second best is {levels} {way}{how}")
    }
}

/// Logarithms of the lengths of a body.
struct Size {
    width: f64,
    height: f64,
    centre: Frontal,
}

impl Size {
    fn of(body: &Corners<Frontal>) -> Self {
        let (width, height) = (body.mean_width_mm().ln(), body.height_mm().ln());
        Self { width, height, centre: body.centre() }
    }

    /// Logarithm of the distance to another body.
    fn step(&self, other: &Self) -> f64 {
        self.centre.distance_mm(other.centre).ln()
    }
}

impl ErectFilm {
    /// The levels of neighbouring bodies on another film, caudal first, by dynamic programming: the next body has the level above, or the
    /// second one above, and a body may lie beside the series. Every level of the middle body is tried. `None` for fewer than three
    /// bodies.
    #[must_use]
    pub fn match_levels(
        &self,
        image: &ImageGeometry,
        bodies: &[NamelessBody],
    ) -> Option<LevelMatch> {
        let erect = complete(&self.image, Some(Posture::Erect), &self.reading.clicks(&self.image));
        let erect = erect.ok().filter(|_| bodies.len() > 2)?;
        let frontal =
            |body: &NamelessBody| Size::of(&body.corners.map(|corner| image.frontal(corner)));
        let (own, known) = (
            bodies.iter().map(frontal).collect::<Vec<_>>(),
            Level::ALL.map(|level| Size::of(&erect.corners(level))),
        );
        let in_mm = image.scale().is_some() && self.image.scale().is_some();
        let about = if in_mm { 0.0 } else { median_step(&own) - median_step(&known) };
        let mut best: Vec<Chain> = Vec::new();
        for level in 0..LEVELS {
            let chains = (-SCALES..=SCALES).filter_map(|step| {
                let scale = SCALE_STEP * f64::from(step);
                let prior = if in_mm { (scale / SCALE_SD).powi(2) } else { 0.0 };
                let series = Series { bodies, own: &own, known: &known, scale: about + scale };
                let chain = series.cheapest(level)?;
                Some(Chain { cost: chain.cost + prior, ..chain })
            });
            best.extend(chains.min_by(|a, b| a.cost.total_cmp(&b.cost)));
        }
        best.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let [first, second, ..] = &best[..] else { return None };
        Some(LevelMatch {
            levels: first.levels.iter().map(|level| Some(Level::ALL[(*level)?])).collect(),
            second: second.middle as i32 - first.middle as i32,
            lead: second.cost - first.cost,
        })
    }
}

/// Levels of the bodies, and their cost.
struct Chain {
    cost: f64,
    levels: Vec<Option<usize>>,
    /// The level of the middle body.
    middle: usize,
}

/// The cheapest levels of a body and those above it: the cost, and the next body with its level.
#[derive(Clone, Copy)]
struct Link {
    cost: f64,
    next: Option<[usize; 2]>,
}

/// Bodies and the vertebrae of the erect film, at a common scale.
struct Series<'a> {
    bodies: &'a [NamelessBody],
    own: &'a [Size],
    known: &'a [Size],
    scale: f64,
}

impl Series<'_> {
    /// The cheapest chain in which the middle body has a level.
    fn cheapest(&self, level: usize) -> Option<Chain> {
        let middle = self.own.len() / 2;
        let mut links = vec![[None; LEVELS]; self.own.len()];
        for body in (0..self.own.len()).rev() {
            let levels = if body == middle { level..level + 1 } else { 0..LEVELS };
            for own in levels {
                links[body][own] = self.link(&links, body, own, middle);
            }
        }
        let starts = (0..=MOST_BESIDE.min(middle))
            .flat_map(|body| (0..LEVELS).map(move |level| [body, level]));
        let costs = starts.filter_map(|[body, level]| {
            let link = links[body][level]?;
            Some((link.cost + SKIP_COST * body as f64, [body, level]))
        });
        let (cost, start) = costs.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let mut levels = vec![None; self.own.len()];
        let mut place = Some(start);
        while let Some([body, own]) = place {
            levels[body] = Some(own);
            place = links[body][own].and_then(|link| link.next);
        }
        Some(Chain { cost, levels, middle: level })
    }

    fn link(
        &self,
        links: &[[Option<Link>; LEVELS]],
        body: usize,
        level: usize,
        middle: usize,
    ) -> Option<Link> {
        let rest = self.own.len() - 1 - body;
        let is_end = body >= middle && rest <= MOST_BESIDE;
        let end = is_end.then_some(Link { cost: SKIP_COST * rest as f64, next: None });
        let passes = |next: usize| body < middle && middle < next;
        let ways = [1, 2].into_iter().flat_map(|by| [1, 2].map(|up| [by, up]));
        let nexts = ways.filter_map(|[by, up]| {
            let next = [body + by, level + up];
            let after = links.get(next[0]).filter(|_| !passes(next[0]))?.get(next[1])?.as_ref()?;
            let step = self.own[body].step(&self.own[next[0]]);
            let off = step - self.known[level].step(&self.known[next[1]]) - self.scale;
            let skipped = SKIP_COST * (by + up - 2) as f64;
            Some(Link { cost: after.cost + squared(off, STEP_SD) + skipped, next: Some(next) })
        });
        let best = nexts.chain(end).min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        Some(Link { cost: best.cost + self.cost(body, level), ..best })
    }

    /// Cost of a body having a level.
    fn cost(&self, body: usize, level: usize) -> f64 {
        let (own, known) = (&self.own[body], &self.known[level]);
        let vote = self.bodies[body].votes[level].max(VOTE_FLOOR);
        squared(own.width - known.width - self.scale, WIDTH_SD)
            + squared(own.height - known.height - self.scale, HEIGHT_SD)
            - 2.0 * VOTE_WEIGHT * vote.ln()
    }
}

fn squared(off: f64, sd: f64) -> f64 {
    (off / sd).abs().min(MOST_SDS).powi(2)
}

fn median_step(sizes: &[Size]) -> f64 {
    let steps = sizes.windows(2).map(|pair| pair[0].step(&pair[1]));
    median(steps.collect())
}
