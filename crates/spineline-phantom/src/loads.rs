//! Loads that no single line describes, on the same rod; and a rotated base.

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Uniform};
use spineline::action::LineOfAction;
use spineline::anatomy::{Level, Posture, trunk_weight_share};
use spineline::spatial::{Angle, Frontal};

use crate::erect::ErectSpine;
use crate::movement::{Moved, force_for, usual_variation};
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
    let vary = usual_variation();
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
            let reached = |shape: &ChainShape| shape.rotation_from(erect) >= target;
            let solve = |size: f64, shape: &mut ChainShape| {
                let acting = on_vertebrae(scenario, size, sense);
                let couple_nmm = acting.iter().map(|one| one.couple_nmm).sum();
                *shape = rod.bend_by(shape, couple_nmm, |now| {
                    forces(scenario, spine, now, size * sense, &acting)
                })?;
                Some((shape.clone(), ()))
            };
            let (size, shape, ()) =
                force_for(2.0, 20_000.0, erect.clone(), solve, reached).ok_or(posture)?;
            let l4_on_film = l4_on_film(scenario, sense);
            Ok(Moved { l4_on_film, ..Moved::at(posture, shape, size) })
        })
        .collect()
}

/// The tilt of L4 on the film: weight follows a tilted vertical, which the film of every posture shows.
pub(crate) fn l4_on_film(scenario: Scenario, sense: f64) -> Option<Angle> {
    match scenario {
        Scenario::Weight => Some(Angle::from_deg(25.0 * sense)),
        Scenario::WeightAndCouple => Some(Angle::from_deg(10.0 * sense)),
        _ => None,
    }
}

/// A force and a couple on the body of a vertebra.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OnVertebra {
    /// Place in the model, caudal first.
    pub vertebra: usize,
    pub force: Frontal,
    pub couple_nmm: f64,
}

impl OnVertebra {
    fn force(vertebra: usize, force: Frontal) -> Self {
        Self { vertebra, force, couple_nmm: 0.0 }
    }
}

/// Forces and couples on the bodies of vertebrae, by their places in the model. The sense is 1 for a load that turns to the
/// right. A couple on T2 is the same moment at all levels.
pub(crate) fn on_vertebrae(scenario: Scenario, size: f64, sense: f64) -> Vec<OnVertebra> {
    const TOP: usize = Level::MODEL.len() - 1;
    const T5: usize = 11;
    const T11: usize = 5;
    let sideways = Frontal::new(-sense * size, 0.0);
    let mut all = match scenario {
        Scenario::Couple | Scenario::WeightAndCouple => {
            let couple_nmm = 100.0 * size * sense;
            vec![OnVertebra { vertebra: TOP, force: Frontal::default(), couple_nmm }]
        }
        Scenario::Pads => {
            vec![OnVertebra::force(T5, sideways), OnVertebra::force(T11, sideways * -0.5)]
        }
        _ => Vec::new(),
    };
    if let Some(tilt) = l4_on_film(scenario, sense) {
        let down = Frontal::leaning(-tilt) * -size;
        let levels = Level::MODEL.into_iter().enumerate().skip(1);
        all.extend(levels.map(|(v, level)| OnVertebra::force(v, down * trunk_weight_share(level))));
    }
    all
}

fn forces(
    scenario: Scenario,
    spine: &ErectSpine,
    shape: &ChainShape,
    signed_size: f64,
    on_vertebrae: &[OnVertebra],
) -> Vec<PointForce> {
    let at = |s_mm: f64, force: Frontal| PointForce { s_mm, point: shape.point(s_mm), force };
    let s = &spine.vertebra_s_mm;
    let sideways = Frontal::new(-signed_size, 0.0);
    match scenario {
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
                force: line.direction * signed_size.abs(),
            };
            vec![pull, at(s[apex(spine)], sideways * AT_APEX)]
        }
        _ => on_vertebrae.iter().map(|one| at(s[one.vertebra], one.force)).collect(),
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
