//! Movements of a column from the erect posture.

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Normal};
use spineline::action::{Application, LineOfAction};
use spineline::anatomy::Posture;
use spineline::spatial::{Angle, Frontal};

use super::{Acting, Anatomy, Column, Shape};
use crate::loads::{OnVertebra, l4_on_film, on_vertebrae};
use crate::movement::{TOTAL_DEG, force_for, usual_variation};
use crate::{Scenario, TruePosture};

/// Standard deviation of the tilt of the iliac crests against L4 (assumption).
const CRESTS_DEG: f64 = 4.0;
const MOST_N: f64 = 20_000.0;

/// The erect posture, two bends, neutral and traction, sized by the sum of the joints' turns.
pub(crate) fn postures(
    scenario: Scenario,
    anatomy: &Anatomy,
    rng: &mut ChaCha12Rng,
) -> Result<Vec<TruePosture>, Posture> {
    let column = &anatomy.column;
    let erect = column.erect();
    let vary = usual_variation();
    let tilt = Normal::new(0.0, CRESTS_DEG).expect("a positive deviation");
    // The first and third movements straighten or go to the left, the second goes against them.
    let plan = [
        (Posture::LeftBending, 1.0),
        (Posture::RightBending, -1.0),
        (Posture::Neutral, 1.0),
        (Posture::Traction, 1.0),
    ];
    let mut moved = vec![observed(column, Posture::Erect, &erect)];
    for ((posture, sense), total_deg) in plan.into_iter().zip(TOTAL_DEG) {
        let target = Angle::from_deg(total_deg * vary.sample(rng));
        let crest_tilt = Angle::from_deg(tilt.sample(rng));
        let reached = |shape: &Shape| column.turns_from(shape, &erect) >= target;
        let found = if scenario == Scenario::Rod {
            through_inflections(column, &erect, sense, reached)
        } else {
            let size = Sized { scenario, posture, sense, crest_tilt };
            size.bend(column, reached)
        };
        let (force_n, shape, line) = found.ok_or(posture)?;
        moved.push(TruePosture {
            force_n,
            line,
            crest_tilt,
            l4_on_film: l4_on_film(scenario, -sense).filter(|_| posture != Posture::Traction),
            ..observed(column, posture, &shape)
        });
    }
    // The bend with the larger tilt to the left is the left one.
    if moved[1].locations[14].lateral_tilt() > moved[2].locations[14].lateral_tilt() {
        moved.swap(1, 2);
        moved[1].posture = Posture::LeftBending;
        moved[2].posture = Posture::RightBending;
    }
    Ok(moved)
}

type Found = Option<(f64, Shape, Option<LineOfAction>)>;

fn through_inflections(
    column: &Column,
    erect: &Shape,
    sense: f64,
    reached: impl Fn(&Shape) -> bool,
) -> Found {
    let ends = |shape: &Shape| column.inflections.map(|station| shape.places[station].point);
    let [low, high] = ends(erect);
    let start = [(high - low).lateral_tilt().rad(), 0.0];
    let solve = |force_n: f64, base: &mut [f64; 2]| {
        let shape = column.bend_through_inflections(force_n, base)?;
        let [low, high] = ends(&shape);
        let line = LineOfAction::through(low, high).ok()?;
        Some((shape, Some(line)))
    };
    force_for(10.0 * sense, MOST_N, start, solve, reached)
}

/// A load that grows until the spine has turned enough.
struct Sized {
    scenario: Scenario,
    posture: Posture,
    sense: f64,
    crest_tilt: Angle,
}

impl Sized {
    fn bend(&self, column: &Column, reached: impl Fn(&Shape) -> bool) -> Found {
        let solve = |size: f64, base_nmm: &mut f64| {
            let shape = column.bend(&self.acting(column, size), base_nmm)?;
            Some((shape.clone(), self.line(&shape)))
        };
        force_for(2.0, MOST_N, 0.0, solve, reached)
    }

    /// The direction of a single force at T2: along the iliac crests, and cranial for traction.
    fn at_top(&self) -> Option<Frontal> {
        match (self.posture, self.scenario) {
            (Posture::Traction, _) => Some(Frontal::new(0.0, 1.0)),
            (_, Scenario::Pull) => Some(Frontal::new(self.sense, 0.0).rotated(self.crest_tilt)),
            _ => None,
        }
    }

    fn line(&self, shape: &Shape) -> Option<LineOfAction> {
        let point = shape.places.last()?.point;
        let direction = self.at_top()?;
        Some(LineOfAction { point, direction, application: Application::AtT2 })
    }

    fn acting(&self, column: &Column, size: f64) -> Vec<Acting> {
        if let Some(direction) = self.at_top() {
            let station = column.links.len();
            return vec![Acting { station, force: direction * size, couple_nmm: 0.0 }];
        }
        let on = |one: OnVertebra| Acting {
            station: column.vertebrae[one.vertebra],
            force: one.force,
            couple_nmm: one.couple_nmm,
        };
        // A turn to the left is negative.
        on_vertebrae(self.scenario, size, -self.sense).into_iter().map(on).collect()
    }
}

fn observed(column: &Column, posture: Posture, shape: &Shape) -> TruePosture {
    let of = |station: usize| shape.places[station];
    TruePosture {
        posture,
        locations: column.vertebrae.iter().map(|&station| of(station).point).collect(),
        tilts: column.vertebrae.iter().map(|&s| Angle::from_rad(of(s).tilt_rad)).collect(),
        inflections: column.inflections.map(|station| of(station).point),
        line: None,
        force_n: 0.0,
        l4_on_film: None,
        base_turn: Angle::ZERO,
        crest_tilt: Angle::ZERO,
    }
}
