//! The truths: what moves a spine from the erect posture to the others.

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Uniform};
use spineline::action::{Application, LineOfAction};
use spineline::anatomy::Posture;
use spineline::spatial::{Angle, Frontal};

use crate::erect::ErectSpine;
use crate::rod::{ChainShape, Rod};
use crate::{PhantomError, TableRow, TruePosture, Truth, counter, loads};

/// Five true postures, and the stiffness multipliers behind them (ones where nothing elastic moved the spine).
pub(crate) fn postures(
    row: &TableRow,
    truth: Truth,
    spine: &ErectSpine,
    rng: &mut ChaCha12Rng,
) -> Result<(Vec<TruePosture>, [f64; 3]), PhantomError> {
    let erect = ChainShape::with_turns(spine, |k| spine.turns_rad[k]);
    let missing =
        |posture| PhantomError::NoForce { number: row.number, truth: truth.key(), posture };
    let moved = match truth {
        Truth::Rod => rod(spine, &erect, rng).map_err(missing)?,
        Truth::Bend => bend(spine, rng),
        Truth::Pull => pull(spine, &erect, rng).map_err(missing)?,
        Truth::Flatten => counter::flatten(spine, &erect, rng),
        Truth::Offset => counter::offset(spine, &erect, rng).map_err(missing)?,
        Truth::Spread => counter::spread(spine, &erect, rng).map_err(missing)?,
        Truth::Random => counter::random(spine, &erect, rng),
        Truth::TurnedBase => rod(spine, &erect, rng).map_err(missing)?,
        Truth::Weight | Truth::Lateral | Truth::Couple | Truth::TwoForces => {
            loads::move_by(truth, spine, &erect, rng).map_err(missing)?
        }
    };
    let elastic = !matches!(truth, Truth::Bend | Truth::Flatten | Truth::Random);
    let multipliers = if elastic { spine.multipliers } else { [1.0; 3] };
    let first = Moved::at(Posture::Erect, erect, 0.0);
    let mut all: Vec<TruePosture> =
        std::iter::once(first).chain(moved).map(|moved| moved.observed(spine)).collect();
    if truth == Truth::TurnedBase {
        for posture in &mut all {
            loads::turn_base(posture, rng);
        }
    }
    Ok((all, multipliers))
}

/// One posture of the fine chain.
pub(crate) struct Moved {
    pub posture: Posture,
    pub shape: ChainShape,
    pub line: Option<LineOfAction>,
    pub force_n: f64,
    pub l4_on_film: Option<Angle>,
}

impl Moved {
    /// A shape without a line.
    pub fn at(posture: Posture, shape: ChainShape, force_n: f64) -> Self {
        Self { posture, shape, line: None, force_n, l4_on_film: None }
    }

    /// What a perfect film would show of it.
    fn observed(self, spine: &ErectSpine) -> TruePosture {
        let s = &spine.vertebra_s_mm;
        TruePosture {
            posture: self.posture,
            locations: s.iter().map(|&s| self.shape.point(s)).collect(),
            tilts: s.iter().map(|&s| self.shape.tilt(s)).collect(),
            inflections: spine.inflection_s_mm.map(|s| self.shape.point(s)),
            line: self.line,
            force_n: self.force_n,
            l4_on_film: self.l4_on_film,
            base_turn: Angle::ZERO,
        }
    }
}

/// Turn of the main thoracic curve.
pub(crate) fn main_turn(spine: &ErectSpine, shape: &ChainShape) -> f64 {
    let [low, high] = spine.inflection_s_mm.map(|s| shape.tilt(s).rad());
    high - low
}

/// Steps a force from zero until a measure of the shape reaches a goal, then halves the last step.
///
/// `solve` continues from the force before; `None` where the goal is not reached.
pub(crate) fn force_for<S: Clone, L>(
    step_n: f64,
    most_n: f64,
    start: S,
    solve: impl Fn(f64, &mut S) -> Option<(ChainShape, L)>,
    reached: impl Fn(&ChainShape) -> bool,
) -> Option<(f64, ChainShape, L)> {
    let (mut low_n, mut low_state) = (0.0, start);
    let mut step_n = step_n;
    let mut found = None;
    while step_n.abs() > 1e-9 * most_n {
        let mut state = low_state.clone();
        let force_n = low_n + step_n;
        if force_n.abs() > most_n {
            return None;
        }
        match solve(force_n, &mut state) {
            Some((shape, line)) if reached(&shape) => {
                found = Some((force_n, shape, line));
                step_n *= 0.5;
            }
            Some(_) => {
                (low_n, low_state) = (force_n, state);
                if found.is_some() {
                    step_n *= 0.5;
                }
            }
            // No equilibrium so far ahead: a smaller step.
            None => step_n *= 0.5,
        }
    }
    found
}

/// A force through the inflections: a pull that straightens, and a push that bends further.
///
/// Forces are sized by how far all segments turn in sum; the paper's mean rotation makes 42° per movement, of which
/// neutral and the push take less (assumption).
fn rod(
    spine: &ErectSpine,
    erect: &ChainShape,
    rng: &mut ChaCha12Rng,
) -> Result<Vec<Moved>, Posture> {
    through(spine, erect, spine.inflection_s_mm, rng)
}

/// As [`rod`], by a force along the line through the chain at two arc lengths.
pub(crate) fn through(
    spine: &ErectSpine,
    erect: &ChainShape,
    s_mm: [f64; 2],
    rng: &mut ChaCha12Rng,
) -> Result<Vec<Moved>, Posture> {
    let vary = usual_variation();
    let rod = Rod::new(spine);
    let start = s_mm.map(|s| erect.point(s).y_mm);
    let mut at = |total_deg: f64, step_n: f64, posture: Posture| {
        let goal = Angle::from_deg(total_deg * vary.sample(rng));
        let reached = |shape: &ChainShape| shape.rotation_from(erect) >= goal;
        let solve =
            |force_n: f64, places: &mut [f64; 2]| rod.bend_through(s_mm, force_n, erect, places);
        let (force_n, shape, line) =
            force_for(step_n, 20_000.0, start, solve, reached).ok_or(posture)?;
        Ok(Moved { line: Some(line), ..Moved::at(posture, shape, force_n) })
    };
    let [straighter, stronger, neutral, traction] = TOTAL_DEG;
    Ok(in_order([
        at(straighter, 20.0, Posture::LeftBending)?,
        at(stronger, -10.0, Posture::RightBending)?,
        at(neutral, 20.0, Posture::Neutral)?,
        at(traction, 20.0, Posture::Traction)?,
    ]))
}

/// Sums of the rotations of all segments: a bend that straightens, one that bends further, neutral and traction.
pub(crate) const TOTAL_DEG: [f64; 4] = [42.0, 25.0, 20.0, 36.0];

/// By how much one patient's movements differ from another's.
pub(crate) fn usual_variation() -> Uniform<f64> {
    Uniform::new(0.9, 1.1).expect("0.9 is below 1.1")
}

/// Two bends, neutral and traction in the order of postures: the bend that leans further left is the left one.
pub(crate) fn in_order([first, second, neutral, traction]: [Moved; 4]) -> Vec<Moved> {
    let left_first = first.shape.top().lean() < second.shape.top().lean();
    let (left, right) = if left_first { (first, second) } else { (second, first) };
    vec![
        Moved { posture: Posture::LeftBending, ..left },
        Moved { posture: Posture::RightBending, ..right },
        neutral,
        traction,
    ]
}

/// Prescribed rotations to one side; neutral and traction scale the erect curve.
///
/// Parts of a curve that a bend to its convex side and that lying take away: [bekki-2018] for surgical adolescents,
/// caudal region first. Traction, and that a curve grows by half as much on the other bend, are assumptions.
fn bend(spine: &ErectSpine, rng: &mut ChaCha12Rng) -> Vec<Moved> {
    const FLEXIBILITY: [f64; 3] = [0.682, 0.402, 0.325];
    const NEUTRAL: [f64; 3] = [0.19, 0.21, 0.09];
    const TRACTION: [f64; 3] = [0.45, 0.40, 0.30];
    const AWAY: f64 = 0.5;
    let vary = usual_variation();
    let [low, high] = spine.inflection_s_mm;
    let ends = [(0.0, low), (low, high), (high, spine.length_mm)];
    let segment_mm = spine.segment_mm();
    let place = |k: usize| (k as f64 + 0.5) * segment_mm;
    // Weights vanish at the inflections and are one in sum over a region.
    let weight = |k: usize| {
        let region = spine.region(place(k));
        let (from, to) = ends[region];
        let part = (place(k) - from) / (to - from) * std::f64::consts::PI;
        let value = match region {
            0 => (0.5 * part).cos(),
            1 => part.sin(),
            _ => (0.5 * part).sin(),
        };
        (region, value)
    };
    let mut sums = [0.0; 3];
    let mut lobes = [0.0; 3];
    for k in 0..spine.turns_rad.len() {
        let (region, value) = weight(k);
        sums[region] += value;
        lobes[region] += spine.turns_rad[k];
    }
    let prescribed = |posture: Posture, rotations: [f64; 3]| {
        let shape = ChainShape::with_turns(spine, |k| {
            let (region, value) = weight(k);
            spine.turns_rad[k] + rotations[region] * value / sums[region]
        });
        Moved::at(posture, shape, 0.0)
    };
    let mut moved = Vec::new();
    for (posture, sense) in [(Posture::LeftBending, -1.0), (Posture::RightBending, 1.0)] {
        let rotations = [0, 1, 2].map(|region| {
            let towards = lobes[region] * sense < 0.0;
            let part = FLEXIBILITY[region] * vary.sample(rng) * if towards { 1.0 } else { AWAY };
            sense * part * lobes[region].abs()
        });
        moved.push(prescribed(posture, rotations));
    }
    for (posture, parts) in [(Posture::Neutral, NEUTRAL), (Posture::Traction, TRACTION)] {
        let parts = parts.map(|part| part * vary.sample(rng));
        let shape = ChainShape::with_turns(spine, |k| {
            spine.turns_rad[k] * (1.0 - parts[spine.region(place(k))])
        });
        moved.push(Moved::at(posture, shape, 0.0));
    }
    moved
}

/// How far L4-T2 leans on the bends and at rest beside the erect film.
pub(crate) fn leans(rng: &mut ChaCha12Rng) -> [(Posture, Angle); 3] {
    let mut degrees = |from: f64, to: f64| {
        Angle::from_deg(Uniform::new(from, to).expect("a range upwards").sample(rng))
    };
    [
        (Posture::LeftBending, -degrees(15.0, 25.0)),
        (Posture::RightBending, degrees(15.0, 25.0)),
        (Posture::Neutral, degrees(-4.0, 4.0)),
    ]
}

/// A horizontal force at T2 for the bends and at rest, and a cranial one for traction.
fn pull(
    spine: &ErectSpine,
    erect: &ChainShape,
    rng: &mut ChaCha12Rng,
) -> Result<Vec<Moved>, Posture> {
    let rod = Rod::new(spine);
    let left = Frontal::new(1.0, 0.0);
    let erect_lean = erect.top().lean();
    let solve = |direction: Frontal| {
        let rod = &rod;
        move |force_n: f64, top: &mut Frontal| {
            let (shape, mut line) = rod.pull_at_top(direction, force_n, *top)?;
            *top = shape.top();
            (line.point, line.application) = (*top, Application::AtT2);
            Some((shape, line))
        }
    };
    let mut moved = Vec::new();
    for (posture, change) in leans(rng) {
        let sense = change.rad().signum();
        let goal = erect_lean + change;
        let reached = |shape: &ChainShape| (shape.top().lean() - goal).rad() * sense >= 0.0;
        let (force_n, shape, line) =
            force_for(-2.0 * sense, 2000.0, erect.top(), solve(left), reached).ok_or(posture)?;
        moved.push(Moved { line: Some(line), ..Moved::at(posture, shape, force_n) });
    }
    let whole = main_turn(spine, erect);
    let reached = |shape: &ChainShape| main_turn(spine, shape) / whole <= 0.85;
    let (force_n, shape, line) =
        force_for(10.0, 20_000.0, erect.top(), solve(Frontal::new(0.0, 1.0)), reached)
            .ok_or(Posture::Traction)?;
    moved.push(Moved { line: Some(line), ..Moved::at(Posture::Traction, shape, force_n) });
    Ok(moved)
}
