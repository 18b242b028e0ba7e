use std::ops::ControlFlow;

use super::balance::{Balance, Factors};
use super::equilibrium::{BranchEvent, Equilibrium, EquilibriumPath, PathPoint};
use super::newton::{BALANCED_RAD, Closing, Direction, Newton, NewtonEnding, velocity_at};
use super::stability::Signs;
use super::wrench::Spatial;
use crate::multibody::follow::{Branch, BranchEventKind, Event, Stop};
use crate::multibody::roots::{Along, Lost, Sample, zeros_between};
use crate::multibody::{ForceSign, MAX_HINGE_RAD};
use crate::spatial::{Angle, Frontal, Vec3};

/// Target of the search along the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// The loads as they are given: a factor of one.
    FullLoad,
    /// A lateral tilt of the line L4→T2: the loads grow, or shrink below zero, until it is met.
    LateralTilt(Angle),
}

/// How far a path is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathOptions {
    /// Whether the proportional loads grow along or against themselves.
    pub sign: ForceSign,
    /// No factor beyond this one is looked at.
    pub largest_factor: f64,
    /// No hinge is followed beyond this angle.
    pub largest_hinge_rad: f64,
    /// No more shapes than these.
    pub most_points: usize,
    /// Whether the path continues after the first equilibrium that meets the target, to find further ones.
    pub look_beyond: bool,
}

impl Default for PathOptions {
    /// Up to twice the load, in its own direction, on beyond the first equilibrium.
    fn default() -> Self {
        Self {
            sign: ForceSign::Positive,
            largest_factor: 2.0,
            largest_hinge_rad: MAX_HINGE_RAD,
            most_points: 2000,
            look_beyond: true,
        }
    }
}

/// Length of the first step, of the longest and of the shortest, in rad over all hinges together.
const FIRST_STEP_RAD: f64 = 0.05;
const MAX_STEP_RAD: f64 = 0.25;
const MIN_STEP_RAD: f64 = 1e-7;
/// In the length of a path, a factor of one counts as what it turns the unloaded hinges, within these limits: a straight
/// column does not turn at all.
const MIN_FACTOR_RAD: f64 = 0.1;
const MAX_FACTOR_RAD: f64 = 0.5;
/// The path to the largest factor is divided into at least this number of steps.
const MIN_STEPS: f64 = 20.0;
/// From one point to the next, the branch turns by less than this cosine says: else it may be another branch.
const MIN_COSINE: f64 = 0.9;
/// Newton moves a point sideways by at most this part of the step, for the same reason.
const MAX_DEPARTURE: f64 = 0.5;
/// A place of the goal that is nearer to a point that meets it is that point.
const SAME_POINT_RAD: f64 = 1e-7;
/// Tolerance of the lateral tilt; a load factor is met exactly.
const TILT_MET_RAD: f64 = 1e-10;

/// Called for every point of a path; breaking off leaves the path as far as it is.
pub type OnPoint<'o> = &'o mut dyn FnMut(&PathPoint) -> ControlFlow<()>;

/// A place on the branch from which to step.
#[derive(Clone)]
pub(super) struct Base {
    pub hinges: Vec<Vec3>,
    pub reactions: Vec<Spatial>,
    pub factor: f64,
    pub tangent: Direction,
    pub signs: Signs,
    pub goal: Sample,
}

/// A point of the path.
pub(super) struct Step {
    base: Base,
    /// Its length and Newton's iterations; zero for the first point.
    length_rad: f64,
    iterations: u32,
    /// What lies between it and the point before, in order.
    events: Vec<Event>,
}

pub(super) struct Stage {
    /// Factors of the constant and the proportional loads.
    pub factors: Factors,
    pub goal: Goal,
    pub options: PathOptions,
}

/// A stage of a path, and what was met so far.
pub(super) struct Walk<'w, 'b> {
    pub balance: Balance<'b>,
    pub newton: &'w mut Newton,
    stage: Stage,
    path: &'w mut EquilibriumPath,
    on_point: OnPoint<'w>,
    arc_rad: f64,
    /// Whether a rod was out of reach in the steps that failed since the last point.
    rod_failed: bool,
}

impl<'w, 'b> Walk<'w, 'b> {
    /// A branch that starts at the state as it is, whose factor is zero.
    pub(super) fn new(
        balance: Balance<'b>,
        newton: &'w mut Newton,
        stage: Stage,
        path: &'w mut EquilibriumPath,
        on_point: OnPoint<'w>,
    ) -> Self {
        let arc_rad = path.points.last().map_or(0.0, |point| point.arc_rad);
        Self { balance, newton, stage, path, on_point, arc_rad, rod_failed: false }
    }

    fn is_beyond_limits(&self) -> bool {
        self.newton.state.largest_hinge_rad() > self.stage.options.largest_hinge_rad
            || self.stage.factors.varied().abs() > self.stage.options.largest_factor
    }

    /// The first place, with a factor that counts as much as what it turns at first.
    fn first_base(&mut self) -> Option<Base> {
        let PathOptions { sign, largest_factor, .. } = self.stage.options;
        // Loads in small units have a large factor to go, and must not take more steps for that.
        let least = MIN_FACTOR_RAD.min(MIN_STEPS * MAX_STEP_RAD / largest_factor);
        let least = least.max(f64::MIN_POSITIVE.sqrt());
        let mut outwards = Direction::of_factor(&self.balance, sign.factor(), least);
        let Direction { turns, factor, .. } = self.base(&outwards, 0.0)?.tangent;
        let turns: f64 = turns.iter().map(|turn| turn.norm_squared()).sum();
        outwards.factor_rad = (turns.sqrt() / factor.abs()).clamp(least, MAX_FACTOR_RAD);
        self.base(&outwards, 0.0)
    }

    /// A point at a step along the branch, and Newton's iterations; `None` where it may not be on the same branch.
    pub(super) fn beside(&mut self, base: &Base, step_rad: f64) -> Option<(Base, u32)> {
        let iterations = self.advance(base, step_rad)?;
        let mut next = self.base(&base.tangent, step_rad)?;
        let cosine = next.tangent.dot(&base.tangent.turns, base.tangent.factor);
        if cosine < MIN_COSINE {
            return None;
        }
        next.goal.rate /= cosine;
        Some((next, iterations))
    }

    /// Moves the state by a step along a base's direction, and back onto the branch.
    fn advance(&mut self, base: &Base, step_rad: f64) -> Option<u32> {
        let state = &mut self.newton.state;
        for ((hinge, from), turn) in
            state.hinges.iter_mut().zip(&base.hinges).zip(&base.tangent.turns)
        {
            *hinge = from + turn * step_rad;
        }
        let reactions = base.reactions.iter().zip(&base.tangent.reactions);
        for (reaction, (from, change)) in state.reactions.iter_mut().zip(reactions) {
            *reaction = from + change * step_rad;
        }
        self.stage.factors.set_varied(base.factor + base.tangent.factor * step_rad);
        let from = (&base.hinges[..], base.factor);
        let closing = Closing::Arc { from, along: &base.tangent, length: step_rad };
        let report = self.newton.correct(&self.balance, &mut self.stage.factors, &closing);
        self.path.iterations += u64::from(report.iterations);
        self.rod_failed |= report.ending == NewtonEnding::RodOutOfReach;
        let near = self.departure_rad(base, step_rad) <= MAX_DEPARTURE * step_rad.max(MIN_STEP_RAD);
        (report.ending == NewtonEnding::Balanced && near).then_some(report.iterations)
    }

    /// How far the state lies from where a base's direction pointed.
    fn departure_rad(&self, base: &Base, step_rad: f64) -> f64 {
        let hinges =
            self.newton.state.hinges.iter().zip(base.hinges.iter().zip(&base.tangent.turns));
        let squares: f64 =
            hinges.map(|(now, (from, turn))| (now - from - turn * step_rad).norm_squared()).sum();
        squares.sqrt()
    }

    /// The state as a place to step from.
    fn base(&mut self, so_far: &Direction, at: f64) -> Option<Base> {
        let mut tangent = so_far.clone();
        self.newton.tangent(&self.balance, so_far, &mut tangent)?;
        let signs = self.newton.signs(&self.balance);
        let goal = self.sample(&tangent, at);
        let state = &self.newton.state;
        let (hinges, reactions) = (state.hinges.clone(), state.reactions.clone());
        Some(Base { hinges, reactions, factor: self.stage.factors.varied(), tangent, signs, goal })
    }

    /// The goal's value and its change along the branch.
    fn sample(&self, tangent: &Direction, at: f64) -> Sample {
        match self.stage.goal {
            Goal::FullLoad => {
                let value = self.stage.factors.varied() - 1.0;
                let rate = tangent.factor;
                Sample { at, value, rate, exact: true, met: value.abs() < 1e-15 }
            }
            Goal::LateralTilt(target) => {
                let top = self.newton.state.midpoints.len() - 1;
                let midpoint = self.newton.state.midpoints[top];
                let velocity = velocity_at(&self.newton.twist_of(top, &tangent.turns), &midpoint);
                let place = Frontal::new(midpoint.y, midpoint.z);
                let moves = Frontal::new(velocity.y, velocity.z);
                let value = (place.lateral_tilt() - target).wrapped().rad();
                let rate = place.cross(moves) / place.dot(place);
                Sample { at, value, rate, exact: true, met: value.abs() < TILT_MET_RAD }
            }
        }
    }

    /// Where the target is met between two points, in order; `None` where one of them was not found.
    fn met_between(&mut self, base: &Base, next: &Base) -> Option<Vec<Sample>> {
        let mut within = Within { walk: self, base, met: Vec::new(), lost: false };
        zeros_between(&base.goal, &next.goal, &mut within);
        let Within { mut met, lost, .. } = within;
        if base.goal.met {
            // The same place, reported already.
            met.retain(|sample| sample.at > SAME_POINT_RAD);
        }
        // The end of the step itself may meet the goal.
        if next.goal.met && !base.goal.met && met.is_empty() {
            met.push(next.goal);
        }
        (!lost).then_some(met)
    }

    /// Puts the state where the goal is met; a full load is then met exactly.
    fn land(&mut self, base: &Base, at: f64) -> bool {
        if self.advance(base, at).is_none() {
            return false;
        }
        if self.stage.goal != Goal::FullLoad {
            return true;
        }
        self.stage.factors.set_varied(1.0);
        let report = self.newton.correct(&self.balance, &mut self.stage.factors, &Closing::Factor);
        report.ending == NewtonEnding::Balanced
    }

    /// Puts the state back on a point.
    pub(super) fn restore(&mut self, point: &Base) {
        self.newton.state.hinges.clone_from(&point.hinges);
        self.newton.state.reactions.clone_from(&point.reactions);
        self.stage.factors.set_varied(point.factor);
        self.balance.evaluate(&self.stage.factors, &mut self.newton.state);
    }

    /// Reports the state at a part of a step, which meets the goal.
    fn report(&mut self, at: f64) -> ControlFlow<Stop> {
        self.arc_rad += at;
        let pushed = self.push_point(1);
        self.arc_rad -= at;
        let found = self.found();
        pushed?;
        found
    }

    fn push_point(&mut self, iterations: u32) -> ControlFlow<Stop> {
        let state = &self.newton.state;
        self.path.points.push(PathPoint {
            timing: self.stage.factors.varies,
            factor: self.stage.factors.varied(),
            arc_rad: self.arc_rad,
            limit_points: self.path.count(BranchEventKind::LimitPoint),
            branch_points: self.path.count(BranchEventKind::BranchPoint),
            iterations,
            residual_rad: self.balance.residual_rad(state),
            deformed: state.deformed(),
        });
        match (self.on_point)(&self.path.points[self.path.points.len() - 1]) {
            ControlFlow::Break(()) => ControlFlow::Break(Stop::Interrupted),
            ControlFlow::Continue(()) => ControlFlow::Continue(()),
        }
    }

    /// The state meets the goal; whether more places are looked for.
    fn found(&mut self) -> ControlFlow<Stop> {
        let equilibrium =
            Equilibrium::new(&self.balance, &self.stage.factors, &self.newton.state, self.path);
        self.path.equilibria.push(equilibrium);
        if self.stage.options.look_beyond {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(Stop::Enough)
        }
    }
}

impl Branch for Walk<'_, '_> {
    type Place = Step;

    fn start(&mut self) -> Option<Step> {
        self.balance.evaluate(&self.stage.factors, &mut self.newton.state);
        let residual_rad = self.balance.residual_rad(&self.newton.state);
        if residual_rad.is_nan() || residual_rad > BALANCED_RAD {
            return None;
        }
        let base = self.first_base()?;
        Some(Step { base, length_rad: 0.0, iterations: 0, events: Vec::new() })
    }

    fn arrive(&mut self, point: &mut Step) -> ControlFlow<Stop> {
        self.arc_rad += point.length_rad;
        self.push_point(point.iterations)?;
        let is_first = point.length_rad == 0.0;
        if is_first && point.base.goal.met {
            self.found()?;
        }
        if !is_first && self.is_beyond_limits() {
            return ControlFlow::Break(Stop::Limit);
        }
        if self.path.points.len() >= self.stage.options.most_points {
            return ControlFlow::Break(Stop::Stuck);
        }
        point.base.goal.at = 0.0;
        self.rod_failed = false;
        ControlFlow::Continue(())
    }

    fn lengths(&self, point: &Step) -> [f64; 2] {
        let growth = if point.iterations <= 4 { 1.6 } else { 0.8 };
        let longest_rad = (point.length_rad * growth).min(MAX_STEP_RAD);
        [if point.length_rad > 0.0 { longest_rad } else { FIRST_STEP_RAD }, MIN_STEP_RAD]
    }

    fn step(&mut self, from: &Step, length_rad: f64) -> Option<Step> {
        let (base, iterations) = self.beside(&from.base, length_rad)?;
        let singular = self.events_between(&from.base, &base)?;
        let met = self.met_between(&from.base, &base)?;
        let mut events: Vec<Event> = met.into_iter().map(Event::GoalMet).chain(singular).collect();
        events.sort_by(|a, b| a.at().total_cmp(&b.at()));
        Some(Step { base, length_rad, iterations, events })
    }

    fn pass(&mut self, from: &Step, to: &Step) -> ControlFlow<Stop> {
        let mut is_beyond = false;
        for event in &to.events {
            match *event {
                Event::Singular { at, factor, kind } => {
                    let (timing, arc_rad) = (self.stage.factors.varies, self.arc_rad + at);
                    self.path.events.push(BranchEvent { kind, timing, factor, arc_rad });
                }
                Event::GoalMet(sample) if !is_beyond => {
                    if !self.land(&from.base, sample.at) {
                        return ControlFlow::Break(Stop::Stuck);
                    }
                    is_beyond = self.is_beyond_limits();
                    if !is_beyond {
                        self.report(sample.at)?;
                    }
                }
                Event::GoalMet(_) => {}
            }
        }
        self.restore(&to.base);
        ControlFlow::Continue(())
    }

    fn stuck(&self) -> Stop {
        if self.rod_failed { Stop::RodOutOfReach } else { Stop::Stuck }
    }
}

/// The goal between two points of the branch.
struct Within<'v, 'w, 'b> {
    walk: &'v mut Walk<'w, 'b>,
    base: &'v Base,
    met: Vec<Sample>,
    /// Whether a place was lost.
    lost: bool,
}

impl Along for Within<'_, '_, '_> {
    fn sample(&mut self, at: f64) -> Option<Sample> {
        self.walk.beside(self.base, at).map(|(between, _)| between.goal)
    }

    fn found(&mut self, zero: Result<Sample, Lost>) -> bool {
        match zero {
            Ok(sample) => self.met.push(sample),
            Err(Lost) => self.lost = true,
        }
        self.walk.stage.options.look_beyond
    }
}
