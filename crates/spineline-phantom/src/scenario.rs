//! Loading scenarios: movements of a spine from the erect posture to the others.

use rand_chacha::ChaCha12Rng;
use rand_distr::Distribution;
use spineline::action::Application;
use spineline::anatomy::{Level, Posture};
use spineline::spatial::Frontal;

use crate::column::Anatomy;
use crate::erect::ErectSpine;
use crate::movement::{Moved, sideways_and_upwards, through, usual_variation};
use crate::rod::{ChainShape, Rod};
use crate::{PhantomError, Scenario, TableRow, TruePosture, column, counter, loads};

/// Five true postures of a spine, and its stiffness.
#[derive(Debug, Clone)]
pub(crate) struct Moves {
    pub postures: Vec<TruePosture>,
    /// Length of the erect curve.
    pub length_mm: f64,
    /// Means over regions (ones for movements without elasticity).
    pub multipliers: [f64; 3],
    /// `ln` by joint (zeros for movements without elasticity).
    pub joint_logs: Vec<f64>,
}

fn missing(row: &TableRow, scenario: Scenario) -> impl Fn(Posture) -> PhantomError {
    let (number, scenario) = (row.number, scenario.key());
    move |posture| PhantomError::NoForce { number, scenario, posture }
}

/// Moves an elastica or rigid bodies.
pub(crate) fn of_column(
    row: &TableRow,
    scenario: Scenario,
    anatomy: Anatomy,
    rng: &mut ChaCha12Rng,
) -> Result<Moves, PhantomError> {
    let postures = column::postures(scenario, &anatomy, rng).map_err(missing(row, scenario))?;
    let Anatomy { length_mm, joint_logs, multipliers, .. } = anatomy;
    Ok(Moves { postures, length_mm, multipliers, joint_logs })
}

/// Moves a fine chain.
pub(crate) fn of_chain(
    row: &TableRow,
    scenario: Scenario,
    spine: &ErectSpine,
    rng: &mut ChaCha12Rng,
) -> Result<Moves, PhantomError> {
    let erect = ChainShape::with_turns(spine, |k| spine.turns_rad[k]);
    let missing = missing(row, scenario);
    let moved = match scenario {
        // A pull along the inflections that straightens, and a push that bends further.
        Scenario::Rod | Scenario::TurnedBase => {
            through(spine, &erect, spine.inflection_s_mm, rng).map_err(&missing)?
        }
        Scenario::Bend => bend(spine, rng),
        Scenario::Pull => pull(spine, &erect, rng).map_err(&missing)?,
        Scenario::Flatten => counter::flatten(spine, &erect, rng),
        Scenario::Offset => counter::offset(spine, &erect, rng).map_err(&missing)?,
        Scenario::Spread => counter::spread(spine, &erect, rng).map_err(&missing)?,
        Scenario::Random => counter::random(spine, &erect, rng),
        _ => loads::move_by(scenario, spine, &erect, rng).map_err(&missing)?,
    };
    let first = Moved::at(Posture::Erect, erect, 0.0);
    let mut all: Vec<TruePosture> =
        std::iter::once(first).chain(moved).map(|moved| moved.observed(spine)).collect();
    if scenario == Scenario::TurnedBase {
        for posture in &mut all {
            loads::turn_base(posture, rng);
        }
    }
    let (multipliers, joint_logs) = if scenario.is_elastic() {
        (spine.springs.multipliers, spine.joint_logs())
    } else {
        ([1.0; 3], vec![0.0; Level::MODEL.len() - 1])
    };
    Ok(Moves { postures: all, length_mm: spine.length_mm, multipliers, joint_logs })
}

/// Prescribed rotations to one side; neutral and traction scale the erect curve.
///
/// Relative reductions of a curve by a bend to its convex side, and by lying: [bekki-2018] for surgical
/// adolescents, caudal region first. Traction, and growth of a curve by half as much on the other bend, are
/// assumptions.
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
    // Weights vanish at the inflections and have a sum of one over a region.
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
    let mut curve_turns_rad = [0.0; 3];
    for k in 0..spine.turns_rad.len() {
        let (region, value) = weight(k);
        sums[region] += value;
        curve_turns_rad[region] += spine.turns_rad[k];
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
            let towards = curve_turns_rad[region] * sense < 0.0;
            let part = FLEXIBILITY[region] * vary.sample(rng) * if towards { 1.0 } else { AWAY };
            sense * part * curve_turns_rad[region].abs()
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

/// A horizontal force at T2 for the bends and at rest, and a cranial one for traction.
fn pull(
    spine: &ErectSpine,
    erect: &ChainShape,
    rng: &mut ChaCha12Rng,
) -> Result<Vec<Moved>, Posture> {
    let rod = Rod::new(spine);
    let solve = |direction: Frontal, force_n: f64, top: &mut Frontal| {
        let (shape, mut line) = rod.pull_at_top(direction, force_n, *top)?;
        *top = shape.top();
        (line.point, line.application) = (*top, Application::AtT2);
        Some((shape, Some(line)))
    };
    sideways_and_upwards(spine, erect, 1.0, erect.top(), solve, rng)
}
