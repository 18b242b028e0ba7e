//! Loads that no single line describes, on the same rod; and a rotated base.

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Uniform};
use spineline::action::LineOfAction;
use spineline::anatomy::{Level, Posture, trunk_weight_share};
use spineline::spatial::{Angle, Frontal};

use crate::erect::ErectSpine;
use crate::movement::{Moved, force_for};
use crate::rod::{ChainShape, PointForce, Rod};
use crate::{Scenario, TruePosture};

/// The force at the apex, as a part of the force through the inflections (assumption).
const AT_APEX: f64 = 0.25;

/// Postures by one kind of load, sized by the sum of all segments' rotations: as large as the rod's, and less at rest
/// and in traction (assumptions).
pub(crate) fn move_by(
    scenario: Scenario,
    spine: &ErectSpine,
    erect: &ChainShape,
    rng: &mut ChaCha12Rng,
) -> Result<Vec<Moved>, Posture> {
    let rod = Rod::new(spine);
    let vary = Uniform::new(0.9, 1.1).expect("0.9 is below 1.1");
    let sizes = [
        (Posture::LeftBending, 42.0, -1.0),
        (Posture::RightBending, 36.0, 1.0),
        (Posture::Neutral, 12.0, -1.0),
        (Posture::Traction, 18.0, 1.0),
    ];
    sizes
        .into_iter()
        .map(|(posture, total_deg, sense)| {
            let target = Angle::from_deg(total_deg * vary.sample(rng));
            let tilt = Angle::from_deg(25.0 * sense);
            // A tilted vertical; the film of every posture shows it.
            let l4_on_film = (scenario == Scenario::Weight).then_some(tilt);
            let reached = |shape: &ChainShape| shape.rotation_from(erect) >= target;
            let solve = |size: f64, shape: &mut ChainShape| {
                *shape = rod.bend_by(shape, couple(scenario, size, sense), |now| {
                    forces(scenario, spine, now, size, (sense, tilt))
                })?;
                let line = LineOfAction::leaning(Frontal::default(), Angle::ZERO);
                Some((shape.clone(), line))
            };
            let (size, shape, _) =
                force_for(2.0, 20_000.0, erect.clone(), solve, reached).ok_or(posture)?;
            Ok(Moved { l4_on_film, ..Moved::at(posture, shape, size) })
        })
        .collect()
}

/// A moment of 100 N·mm per unit.
fn couple(scenario: Scenario, size: f64, sense: f64) -> f64 {
    if scenario == Scenario::Couple { 100.0 * size * sense } else { 0.0 }
}

fn forces(
    scenario: Scenario,
    spine: &ErectSpine,
    shape: &ChainShape,
    size: f64,
    (sense, tilt): (f64, Angle),
) -> Vec<PointForce> {
    let at = |s_mm: f64, force: Frontal| PointForce { s_mm, point: shape.point(s_mm), force };
    let s = &spine.vertebra_s_mm;
    let sideways = Frontal::new(-sense * size, 0.0);
    match scenario {
        Scenario::Weight => {
            let down = Frontal::leaning(-tilt) * -size;
            let levels = Level::MODEL.iter().zip(s).skip(1);
            levels.map(|(&level, &s)| at(s, down * trunk_weight_share(level))).collect()
        }
        Scenario::Lateral => {
            // Spread over 200 parts of the length.
            const PIECES: usize = 200;
            let piece_mm = spine.length_mm / PIECES as f64;
            let middles = (0..PIECES).map(|i| (i as f64 + 0.5) * piece_mm);
            middles.map(|s| at(s, sideways * (1.0 / PIECES as f64))).collect()
        }
        Scenario::TwoForces => {
            let [low, high] = spine.inflection_s_mm.map(|s| shape.point(s));
            let line = LineOfAction::through(low, high).expect("inflections are far apart");
            let pull = PointForce {
                s_mm: spine.length_mm,
                point: line.point,
                force: line.direction * size,
            };
            vec![pull, at(s[apex(spine)], sideways * AT_APEX)]
        }
        _ => Vec::new(),
    }
}

/// The vertebra of the main thoracic curve that is farthest from the line between its ends.
fn apex(spine: &ErectSpine) -> usize {
    let erect = ChainShape::with_turns(spine, |k| spine.turns_rad[k]);
    let [low, high] = spine.inflection_s_mm;
    let (from, to) = (erect.point(low), erect.point(high));
    let off = |v: &usize| (to - from).cross(erect.point(spine.vertebra_s_mm[*v]) - from).abs();
    let inside =
        (1..Level::MODEL.len() - 1).filter(|&v| (low..high).contains(&spine.vertebra_s_mm[v]));
    inside.max_by(|a, b| off(a).total_cmp(&off(b))).expect("a curve has vertebrae")
}

/// Rotates everything above L4 by one angle on a bend, like a rotated axis of L4.
pub(crate) fn turn_base(posture: &mut TruePosture, rng: &mut ChaCha12Rng) {
    let size = Uniform::new(4.0, 8.0).expect("4 is below 8").sample(rng);
    let turn = match posture.posture {
        Posture::LeftBending => Angle::from_deg(-size),
        Posture::RightBending => Angle::from_deg(size),
        _ => return,
    };
    posture.base_turn = turn;
    for location in posture.locations.iter_mut().chain(&mut posture.inflections) {
        *location = location.rotated(turn);
    }
    for tilt in posture.tilts.iter_mut().skip(1) {
        *tilt = *tilt + turn;
    }
    if let Some(line) = &mut posture.line {
        line.point = line.point.rotated(turn);
        line.direction = line.direction.rotated(turn);
    }
}
