use std::ops::ControlFlow;

use super::follow::{Branch, PathEnding, Stop, follow};
use super::roots::{Along, Lost, Sample, zeros_between};
use super::target::{AmplitudeTarget, NearestT2Target, PathState, Residual, SearchTarget};
use super::{Load, Parameter, Solution, Statics};
use crate::anatomy::named;
use crate::spatial::{Angle, Frontal, Vec3};

named! {
    /// Whether a force points along its line or against it; of several loads, whether they act as given or reversed.
    pub enum ForceSign {
        /// Along the direction.
        Positive = "along",
        /// Against it.
        Negative = "against",
    }
}

impl ForceSign {
    /// The sign of a force.
    #[must_use]
    pub fn of(force_n: f64) -> Self {
        if force_n < 0.0 { Self::Negative } else { Self::Positive }
    }

    pub(super) const fn factor(self) -> f64 {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }
}

/// A force found by continuation from zero.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceMatch {
    /// How the search ended.
    pub status: PathEnding,
    /// Signed force along the line.
    pub force_n: f64,
    /// Residual of the target.
    pub residual: Residual,
    /// Equilibria computed.
    pub evaluations: u32,
    /// The shape.
    pub solution: Solution,
    /// The least residual that another result along the path may have, in mm of T2's distance; infinite without one, or
    /// if none was sought.
    pub(crate) other_mm: f64,
}

impl ForceMatch {
    /// The shape under a force that is known already; the residual is the remaining lateral tilt of L4→T2.
    #[must_use]
    pub fn at(statics: &Statics<'_>, load: &Load, force_n: f64, tilt: Angle) -> Self {
        let mut solution = Solution::default();
        statics.solve(load, &[force_n], &[], &mut solution);
        let status =
            if solution.converged { PathEnding::Converged } else { PathEnding::NotConverged };
        let residual = Residual::Amplitude((solution.deformed.lateral_tilt() - tilt).wrapped());
        Self { status, force_n, residual, evaluations: 1, solution, other_mm: f64::INFINITY }
    }

    /// Whether the shape may be shown as a result.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        self.status.is_usable()
    }
}

/// No hinge is followed beyond this angle: ligaments and facets would have stopped it long before.
pub(crate) const MAX_HINGE_RAD: f64 = 0.8;
/// 1500 N for springs of the library's mean lateral stiffness; scales with the springs.
pub(crate) const MAX_FORCE_PER_STIFFNESS: f64 = 1500.0 / 144_000.0;
/// T2's next place is extrapolated along the path no further than this.
const MAX_GUESS_MM: f64 = 20.0;
/// A path that cannot be followed by this part of a step breaks off.
const MIN_STEP_FRACTION: f64 = 1.0 / 20.0;
/// Maximum number of equilibria of a path.
const MAX_EVALUATIONS: u32 = 2000;

/// Finds the first force of a sign at which the line L4→T2 has a given lateral tilt.
///
/// The lateral tilt is not monotone in the force, so the path is followed from zero in small steps, and a turn within a step is
/// looked at too. The first crossing counts; [`amplitude_matches`] gives all.
#[must_use]
pub fn match_amplitude(
    statics: &Statics<'_>,
    load: &Load,
    sign: ForceSign,
    target: Angle,
) -> ForceMatch {
    let mut path = Path::new(line_force(statics, load), AmplitudeTarget(target));
    path.follow(sign, 1);
    path.first_or_nearest()
}

/// Finds every force of either sign, up to the largest force and hinge angle, at which the line L4→T2 has a given lateral tilt.
///
/// Without one, the nearest shape is returned as [`PathEnding::Unreachable`]; the list is never empty. Where a
/// path did not converge, the last entry is [`PathEnding::NotConverged`].
#[must_use]
pub fn amplitude_matches(statics: &Statics<'_>, load: &Load, target: Angle) -> Vec<ForceMatch> {
    let mut path = Path::new(line_force(statics, load), AmplitudeTarget(target));
    for sign in ForceSign::ALL {
        path.follow(sign, usize::MAX);
    }
    if path.found.is_empty() {
        return vec![path.first_or_nearest()];
    }
    if !path.converged {
        // A path that did not converge may contain another force.
        path.record(PathEnding::NotConverged, path.nearest_n(), path.least_residual());
    }
    path.found
}

/// As [`match_t2`](super::match_t2), near the result for a nearby place or shape; its path has no second result near. `None` if no
/// result is found there.
pub(crate) fn match_t2_near(
    statics: &Statics<'_>,
    load: &Load,
    force_n: f64,
    place: Frontal,
) -> Option<ForceMatch> {
    Path::new(line_force(statics, load), NearestT2Target(place)).settle(force_n)
}

/// Equilibria under a load of one component.
pub(crate) struct OneComponent<L> {
    /// Equilibrium under an amount of the load, with its derivative by that amount as the only parameter. The shape in the
    /// solution is the start; without one, that is the unloaded spine.
    pub solve: L,
    /// The largest amount that is looked at.
    pub largest: f64,
}

/// Equilibria under a force along a line.
pub(super) fn line_force(
    statics: &Statics<'_>,
    load: &Load,
) -> OneComponent<impl FnMut(f64, &mut Solution)> {
    let solve = move |force_n: f64, solution: &mut Solution| {
        statics.solve(load, &[force_n], &[Parameter::Load(0)], solution);
    };
    OneComponent { solve, largest: MAX_FORCE_PER_STIFFNESS * statics.mean_lateral_nmm_per_rad() }
}

/// The path of equilibria as a force grows from zero, and the zeros of a goal along it.
pub(super) struct Path<L, S> {
    load: OneComponent<L>,
    target: S,
    /// The last shape and its state, converged or not.
    solution: Solution,
    last: Option<PathState>,
    /// The last two states that converged, the later one first.
    seen: [Option<PathState>; 2],
    evaluations: u32,
    pub found: Vec<ForceMatch>,
    /// Sign of the forces that are followed, and the largest one.
    sign: f64,
    largest_n: f64,
    /// Number of zeros after which the search stops.
    enough: usize,
    /// Number of equilibria after which it stops.
    last_evaluation: u32,
    /// The state with the least residual of all.
    nearest: Option<PathState>,
    /// Where else the path may have a result: between which forces, and its least residual.
    others: Vec<([f64; 2], f64)>,
    /// No step is longer, since one was too long.
    longest_n: f64,
    converged: bool,
}

impl<L: FnMut(f64, &mut Solution), S: SearchTarget> Path<L, S> {
    pub fn new(load: OneComponent<L>, target: S) -> Self {
        Self {
            largest_n: load.largest,
            load,
            target,
            solution: Solution::default(),
            last: None,
            seen: [None; 2],
            evaluations: 0,
            found: Vec::new(),
            sign: 1.0,
            enough: 0,
            last_evaluation: 0,
            nearest: None,
            others: Vec::new(),
            longest_n: f64::INFINITY,
            converged: true,
        }
    }

    fn at(&mut self, force_n: f64) -> PathState {
        self.evaluations += 1;
        if let Some(t2) = self.t2_at(force_n) {
            // The start for a load that moves with T2.
            *self.solution.deformed.midpoints_mm.last_mut().expect("a vertebra") = t2;
        }
        (self.load.solve)(force_n, &mut self.solution);
        let state = self.target.state(force_n, &self.solution, self.least_residual());
        self.last = Some(state);
        if self.solution.converged {
            self.seen = [self.last, self.seen[0]];
        }
        state
    }

    /// Keeps the last shape as the nearest one if it is, unless a hinge turns too far.
    fn keep(&mut self, state: PathState) -> PathState {
        let nearer = state.residual.abs() < self.least_residual();
        if self.solution.converged && nearer && self.is_plausible() {
            self.nearest = Some(state);
        }
        state
    }

    /// T2's next place, extrapolated from the last states.
    fn t2_at(&self, force_n: f64) -> Option<Vec3> {
        let [last, before] = self.seen;
        let last = last?;
        let step_n = force_n - last.force_n;
        #[expect(clippy::float_cmp, reason = "only equal forces make the difference quotient 0/0")]
        let bend = before
            .filter(|before| before.force_n != last.force_n)
            .map(|before| (last.t2_rate - before.t2_rate) / (last.force_n - before.force_n));
        let step_mm = (last.t2_rate + bend.unwrap_or_default() * (0.5 * step_n)) * step_n;
        Some(if step_mm.norm() < MAX_GUESS_MM { last.t2 + step_mm } else { last.t2 })
    }

    /// The least residual of all shapes that were seen.
    pub fn least_residual(&self) -> f64 {
        self.nearest.map_or(f64::INFINITY, |state| state.residual.abs())
    }

    fn nearest_n(&self) -> f64 {
        self.nearest.map_or(0.0, |state| state.force_n)
    }

    /// Whether no hinge of the last shape turns too far.
    fn is_plausible(&self) -> bool {
        self.solution.deformed.largest_hinge_rad() <= MAX_HINGE_RAD
    }

    fn record(&mut self, status: PathEnding, force_n: f64, residual: f64) {
        let (evaluations, solution) = (self.evaluations, self.solution.clone());
        let residual = S::residual(residual);
        let other_mm = f64::INFINITY;
        self.found.push(ForceMatch { status, force_n, residual, evaluations, solution, other_mm });
    }

    /// Follows the path of one sign until `most` zeros were found, or to its end.
    pub fn follow(&mut self, sign: ForceSign, most: usize) {
        self.sign = sign.factor();
        self.enough = self.found.len().saturating_add(most);
        self.last_evaluation = self.evaluations + MAX_EVALUATIONS;
        (self.solution, self.seen) = (Solution::default(), [None; 2]);
        self.longest_n = f64::INFINITY;
        self.converged &= follow(self) != Stop::Stuck;
    }

    /// The least residual that a result elsewhere than at a force may have.
    pub fn least_elsewhere(&self, force_n: f64) -> f64 {
        let elsewhere = self
            .others
            .iter()
            .filter(|([from, to], _)| force_n < from.min(*to) || force_n > from.max(*to));
        elsewhere.map(|(_, least)| *least).fold(f64::INFINITY, f64::min)
    }

    /// The zero that is reached from a force by steps in which T2 moves little; `None` where they lead elsewhere.
    pub fn settle(mut self, force_n: f64) -> Option<ForceMatch> {
        const MAX_ROUNDS: u32 = 15;
        /// Further away the path may have another zero.
        const MAX_MOVE_MM: f64 = 15.0;
        let mut now = self.at(force_n);
        for _ in 0..MAX_ROUNDS {
            let is_sound = self.solution.converged && self.is_plausible();
            if !is_sound || now.force_n.abs() >= self.largest_n {
                return None;
            }
            if now.met {
                self.record(PathEnding::Converged, now.force_n, now.residual);
                return self.found.pop();
            }
            let step_n = now.newton_step_n(self.seen[1].as_ref());
            if now.travel_mm(now.force_n + step_n - force_n) > MAX_MOVE_MM || step_n.is_nan() {
                return None;
            }
            now = self.at(now.force_n + step_n);
        }
        None
    }

    /// The first zero that was found, or else the nearest shape with the reason.
    pub fn first_or_nearest(mut self) -> ForceMatch {
        if self.found.is_empty() {
            let status =
                if self.converged { PathEnding::Unreachable } else { PathEnding::NotConverged };
            self.seen = [self.nearest, None];
            let nearest = self.at(self.nearest_n());
            self.record(status, nearest.force_n, nearest.residual);
        }
        self.found.swap_remove(0)
    }
}

impl<L: FnMut(f64, &mut Solution), S: SearchTarget> Branch for Path<L, S> {
    type Place = PathState;

    fn start(&mut self) -> Option<PathState> {
        let now = self.at(0.0);
        Some(self.keep(now))
    }

    fn arrive(&mut self, now: &mut PathState) -> ControlFlow<Stop> {
        if self.evaluations >= self.last_evaluation {
            return ControlFlow::Break(Stop::Stuck);
        }
        if now.met {
            self.record(PathEnding::Converged, now.force_n, now.residual);
            if self.found.len() >= self.enough {
                return ControlFlow::Break(Stop::Enough);
            }
            // Past the zero, on the other side or back on the same one.
            let past_n = self.sign * 1e-3 * now.step_n.min(self.largest_n);
            *now = self.at(now.force_n + past_n);
            if now.met {
                return ControlFlow::Break(Stop::Stuck);
            }
        }
        ControlFlow::Continue(())
    }

    fn lengths(&self, now: &PathState) -> [f64; 2] {
        let newton_n = self.sign * now.newton_step_n(self.seen[1].as_ref());
        let mut step_n = now.step_n.min(self.longest_n);
        if newton_n > 0.0 {
            step_n = step_n.min(newton_n);
        }
        [step_n, MIN_STEP_FRACTION * step_n]
    }

    fn step(&mut self, now: &PathState, step_n: f64) -> Option<PathState> {
        let largest_n = self.largest_n;
        let next = self.at((now.force_n + self.sign * step_n).clamp(-largest_n, largest_n));
        if !self.solution.converged || self.target.is_fine(now, &next) {
            self.longest_n *= 2.0;
            return Some(self.keep(next));
        }
        // Again from the last point, with half the step.
        self.seen = [Some(*now), None];
        self.longest_n = 0.5 * step_n;
        None
    }

    fn pass(&mut self, now: &PathState, next: &PathState) -> ControlFlow<Stop> {
        if !self.solution.converged {
            return ControlFlow::Break(Stop::Stuck);
        }
        let plausible = self.is_plausible();
        let stops = next.force_n.abs() >= self.largest_n || !plausible;
        let between = self.target.least_between(now, next);
        let at_end = (stops && next.falls(self.sign)).then_some(next.residual);
        let places = [(now.force_n, between), (next.force_n, at_end)];
        let places = places.map(|(from_n, least)| Some(([from_n, next.force_n], least?)));
        self.others.extend(places.into_iter().flatten());
        if next.met {
            if stops && plausible {
                self.record(PathEnding::Converged, next.force_n, next.residual);
            }
        } else if self.target.counts_between(now, next, self.least_residual()) {
            let evaluations = self.evaluations;
            zeros_between(&now.sample(), &next.sample(), self);
            if self.found.len() >= self.enough {
                return ControlFlow::Break(Stop::Enough);
            }
            if self.evaluations > evaluations {
                // The path continues from here.
                self.at(next.force_n);
            }
        }
        if stops { ControlFlow::Break(Stop::Limit) } else { ControlFlow::Continue(()) }
    }
}

impl<L: FnMut(f64, &mut Solution), S: SearchTarget> Along for Path<L, S> {
    fn sample(&mut self, force_n: f64) -> Option<Sample> {
        let state = self.at(force_n);
        self.solution.converged.then(|| self.keep(state).sample())
    }

    fn found(&mut self, zero: Result<Sample, Lost>) -> bool {
        if zero.is_ok() && !self.is_plausible() {
            return true;
        }
        let status = if zero.is_ok() { PathEnding::Converged } else { PathEnding::NotConverged };
        let PathState { force_n, residual, .. } =
            self.last.expect("a zero is found by computing states");
        self.record(status, force_n, residual);
        self.found.len() < self.enough
    }
}
