//! Movements of the fine chain from the erect posture, used by every loading scenario.

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Uniform};
use spineline::action::LineOfAction;
use spineline::anatomy::Posture;
use spineline::spatial::{Angle, Frontal};

use crate::TruePosture;
use crate::erect::ErectSpine;
use crate::rod::{ChainShape, Rod};

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

    /// True values on a film.
    pub fn observed(self, spine: &ErectSpine) -> TruePosture {
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
            crest_tilt: Angle::ZERO,
        }
    }
}

/// Rotation of the main thoracic curve.
fn main_turn(spine: &ErectSpine, shape: &ChainShape) -> f64 {
    let [low, high] = spine.inflection_s_mm.map(|s| shape.tilt(s).rad());
    high - low
}

/// Number of equal steps after which reduced steps grow again: one difficult place must not make the rest of the path
/// endless.
const MAX_EQUAL_STEPS: usize = 200;

/// Steps a force from zero until a measure of the shape reaches a target, then bisects the last step.
///
/// `solve` continues from the force before; `None` if the target is not reached.
pub(crate) fn force_for<S: Clone, T, L>(
    step_n: f64,
    most_n: f64,
    start: S,
    solve: impl Fn(f64, &mut S) -> Option<(T, L)>,
    reached: impl Fn(&T) -> bool,
) -> Option<(f64, T, L)> {
    let (mut low_n, mut low_state) = (0.0, start);
    let first_step_n = step_n;
    let mut step_n = step_n;
    let mut found = None;
    let mut equal_steps = 0;
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
                equal_steps += 1;
                if found.is_some() {
                    step_n *= 0.5;
                } else if equal_steps > MAX_EQUAL_STEPS && step_n.abs() < first_step_n.abs() {
                    (step_n, equal_steps) = (2.0 * step_n, 0);
                }
            }
            // The step has no equilibrium: try a smaller one.
            None => (step_n, equal_steps) = (0.5 * step_n, 0),
        }
    }
    found
}

/// Two bends, neutral and traction by a force along the line through the chain at two arc lengths.
///
/// Forces are sized by the sum of all segments' rotations; the paper's mean rotation makes 42° per movement; neutral
/// and the push turn less (assumption).
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
        let target = Angle::from_deg(total_deg * vary.sample(rng));
        let reached = |shape: &ChainShape| shape.rotation_from(erect) >= target;
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

/// Range of the sizes of movements over patients.
pub(crate) fn usual_variation() -> Uniform<f64> {
    Uniform::new(0.9, 1.1).expect("0.9 is below 1.1")
}

/// Two bends, neutral and traction in the order of postures: the bend with the larger tilt to the left is the left one.
pub(crate) fn in_order([first, second, neutral, traction]: [Moved; 4]) -> Vec<Moved> {
    let left_first = first.shape.top().lateral_tilt() < second.shape.top().lateral_tilt();
    let (left, right) = if left_first { (first, second) } else { (second, first) };
    vec![
        Moved { posture: Posture::LeftBending, ..left },
        Moved { posture: Posture::RightBending, ..right },
        neutral,
        traction,
    ]
}

/// Two bends and neutral by horizontal loads that reach a lateral tilt, and traction by a cranial one that straightens
/// the main curve.
///
/// `solve` gives the equilibrium under a load of a direction and a size. It continues from the state of the load before;
/// `start` is the state without a load. `load_factor` multiplies the steps and limits of all loads.
pub(crate) fn sideways_and_upwards<S: Clone>(
    spine: &ErectSpine,
    erect: &ChainShape,
    load_factor: f64,
    start: S,
    solve: impl Fn(Frontal, f64, &mut S) -> Option<(ChainShape, Option<LineOfAction>)>,
    rng: &mut ChaCha12Rng,
) -> Result<Vec<Moved>, Posture> {
    let left = |force_n: f64, state: &mut S| solve(Frontal::new(1.0, 0.0), force_n, state);
    let up = |force_n: f64, state: &mut S| solve(Frontal::new(0.0, 1.0), force_n, state);
    let erect_tilt = erect.top().lateral_tilt();
    let mut moved = Vec::new();
    for (posture, change) in lateral_tilts(rng) {
        let sense = change.rad().signum();
        let target = erect_tilt + change;
        let reached =
            |shape: &ChainShape| (shape.top().lateral_tilt() - target).rad() * sense >= 0.0;
        let step_n = -2.0 * load_factor * sense;
        let found = force_for(step_n, 2000.0 * load_factor, start.clone(), left, reached);
        let (force_n, shape, line) = found.ok_or(posture)?;
        moved.push(Moved { line, ..Moved::at(posture, shape, force_n) });
    }
    let whole = main_turn(spine, erect);
    let reached = |shape: &ChainShape| main_turn(spine, shape) / whole <= 0.85;
    let found = force_for(10.0 * load_factor, 20_000.0 * load_factor, start, up, reached);
    let (force_n, shape, line) = found.ok_or(Posture::Traction)?;
    moved.push(Moved { line, ..Moved::at(Posture::Traction, shape, force_n) });
    Ok(moved)
}

/// Lateral tilt of L4-T2 on the bends and the neutral film relative to the erect film.
fn lateral_tilts(rng: &mut ChaCha12Rng) -> [(Posture, Angle); 3] {
    let mut degrees = |from: f64, to: f64| {
        Angle::from_deg(Uniform::new(from, to).expect("a range upwards").sample(rng))
    };
    [
        (Posture::LeftBending, -degrees(15.0, 25.0)),
        (Posture::RightBending, degrees(15.0, 25.0)),
        (Posture::Neutral, degrees(-4.0, 4.0)),
    ]
}
