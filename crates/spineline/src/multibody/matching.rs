use std::cell::Cell;

use super::roots::{Along, Lost, Sample, zeros_between};
use super::{Load, Parameter, Solution, Statics};
use crate::spatial::{Angle, Frontal};

/// The way a force points along its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceSign {
    /// Along the line's direction.
    Positive,
    /// Against it.
    Negative,
}

impl ForceSign {
    /// The sign of a force.
    #[must_use]
    pub fn of(force_n: f64) -> Self {
        if force_n < 0.0 { Self::Negative } else { Self::Positive }
    }

    /// Both signs.
    pub const BOTH: [Self; 2] = [Self::Positive, Self::Negative];

    const fn factor(self) -> f64 {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }
}

/// How a search for a force ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatchStatus {
    /// The target is met, or the force was known and its equilibrium found.
    Matched,
    /// The target is not met up to the largest force or hinge angle; the nearest shape is given.
    Unreachable,
    /// A load that moves with T2 could not be closed, or the search did not end.
    NotConverged,
}

impl MatchStatus {
    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Matched => "converged",
            Self::Unreachable => "unreachable",
            Self::NotConverged => "not_converged",
        }
    }
}

/// A force found by continuation from zero.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceMatch {
    /// How the search ended.
    pub status: MatchStatus,
    /// Signed force along the line.
    pub force_n: f64,
    /// What is left of the target: rad for an amplitude, mm for T2's distance.
    pub residual: f64,
    /// Equilibria computed.
    pub evaluations: u32,
    /// The shape.
    pub solution: Solution,
}

impl ForceMatch {
    /// The shape under a force that is known already; the residual is what it leaves of a lean of L4→T2.
    #[must_use]
    pub fn at(statics: &Statics<'_>, load: &Load, force_n: f64, lean: Angle) -> Self {
        let mut solution = Solution::default();
        statics.solve(load, &[force_n], &[], &mut solution);
        let status =
            if solution.converged { MatchStatus::Matched } else { MatchStatus::NotConverged };
        let residual = (solution.deformed.lean() - lean).wrapped().rad();
        Self { status, force_n, residual, evaluations: 1, solution }
    }

    /// Whether the shape may be shown as a result.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        self.status == MatchStatus::Matched
    }
}

/// No hinge is followed beyond this angle: ligaments and facets would have stopped it long before.
pub(crate) const LARGEST_HINGE_RAD: f64 = 0.8;
/// A hinge turns by at most so much from one step to the next.
const STEP_RAD: f64 = 0.25;
/// T2 moves by at most so much from one look at its distance to the next.
const T2_STEP_MM: f64 = 4.0;
/// 1500 N for springs of the library's mean lateral stiffness; scales with the springs.
pub(crate) const LARGEST_FORCE_PER_STIFFNESS: f64 = 1500.0 / 144_000.0;
/// Distances of T2 that differ by less are equally good: about what a location's reading and the model's joints leave.
const T2_TOLERANCE_MM: f64 = 1.0;
/// T2's next place is guessed along the path no further than this.
const LONGEST_GUESS_MM: f64 = 20.0;
/// A path that needs more equilibria than this goes nowhere.
const MOST_EVALUATIONS: u32 = 2000;

/// Finds the first force of a sign at which the line L4→T2 has a given lean.
///
/// The lean is not monotone in the force, so the path is followed from zero in small steps, and a turn within a step is
/// looked at too. The first crossing counts; [`amplitude_matches`] tells all.
#[must_use]
pub fn match_amplitude(
    statics: &Statics<'_>,
    load: &Load,
    sign: ForceSign,
    target: Angle,
) -> ForceMatch {
    let mut path = Path::new(statics, load, amplitude_goal(target));
    path.follow(sign, 1);
    path.first_or_nearest()
}

/// Finds every force of either sign, up to the largest force and hinge angle, at which the line L4→T2 has a given lean.
///
/// Where there is none, the nearest shape comes back as [`MatchStatus::Unreachable`]; the list is never empty. Where a
/// path was lost on its way, the last entry is [`MatchStatus::NotConverged`].
#[must_use]
pub fn amplitude_matches(statics: &Statics<'_>, load: &Load, target: Angle) -> Vec<ForceMatch> {
    let mut path = Path::new(statics, load, amplitude_goal(target));
    for sign in ForceSign::BOTH {
        path.follow(sign, usize::MAX);
    }
    if path.found.is_empty() {
        return vec![path.first_or_nearest()];
    }
    if !path.converged {
        // A path that was lost may have hidden another force.
        let (residual, force_n) = path.nearest;
        path.record(MatchStatus::NotConverged, force_n, residual);
    }
    path.found
}

/// Finds the force of the given signs that brings T2 nearest to a place.
///
/// The distance may have several minima along the path, and an implausible shape far along it may touch the place by
/// chance. The smallest force counts whose distance is within a millimetre of the least. Where the path ends before the
/// distance has a minimum, its nearest shape comes back as [`MatchStatus::Unreachable`].
#[must_use]
pub fn match_t2(
    statics: &Statics<'_>,
    load: &Load,
    signs: &[ForceSign],
    place: Frontal,
) -> ForceMatch {
    let top = statics.model().midpoints_mm.len() - 1;
    let least_mm = Cell::new(f64::INFINITY);
    let mut path = Path::new(statics, load, |solution: &Solution| {
        let gap = solution.deformed.location(top) - place;
        let rate = solution.location_rate(0, top);
        // Half the derivative of the squared distance; its own derivative without the curvature of the path.
        let (value, slope) = (gap.dot(rate), rate.dot(rate));
        let met = value.abs() < 1e-10 * slope.max(1e-12).sqrt();
        // T2 must first come back this far before its distance can count.
        least_mm.set(least_mm.get().min(gap.norm_mm()));
        let travel_mm = T2_STEP_MM.max(0.5 * (gap.norm_mm() - least_mm.get() - T2_TOLERANCE_MM));
        let step_n = turn_step(solution).min(travel_mm / rate.norm_mm().max(f64::MIN_POSITIVE));
        Goal { value, rate: slope, exact: false, residual: gap.norm_mm(), met, step_n }
    });
    for &sign in signs {
        path.follow(sign, usize::MAX);
    }
    let enough_mm = path.nearest.0 + T2_TOLERANCE_MM;
    path.found.retain(ForceMatch::is_usable);
    path.found.sort_by(|a, b| a.force_n.abs().total_cmp(&b.force_n.abs()));
    match path.found.iter().position(|found| found.residual <= enough_mm) {
        Some(index) => path.found.swap_remove(index),
        None => {
            path.found.clear();
            path.first_or_nearest()
        }
    }
}

fn amplitude_goal(target: Angle) -> impl Fn(&Solution) -> Goal {
    move |solution| {
        let value = (solution.deformed.lean() - target).wrapped().rad();
        let (rate, met) = (solution.lean_rate(0), value.abs() < 1e-9);
        Goal { value, rate, exact: true, residual: value, met, step_n: turn_step(solution) }
    }
}

/// What is sought along the force: a value whose zeros count, its derivative, and the residual to report.
#[derive(Debug, Clone, Copy)]
struct Goal {
    value: f64,
    rate: f64,
    /// Whether the derivative is complete.
    exact: bool,
    residual: f64,
    met: bool,
    /// How far the force may grow before the next look.
    step_n: f64,
}

impl Goal {
    fn sample(&self, force_n: f64) -> Sample {
        let Self { value, rate, exact, met, .. } = *self;
        Sample { at: force_n, value, rate, exact, met }
    }
}

/// The force that turns the fastest hinge by a step.
fn turn_step(solution: &Solution) -> f64 {
    STEP_RAD / solution.fastest_turn(0).max(f64::MIN_POSITIVE)
}

/// The path of equilibria as a force grows from zero, and the zeros of a goal along it.
struct Path<'a, G> {
    statics: &'a Statics<'a>,
    load: &'a Load,
    goal: G,
    /// The last shape, and its force.
    solution: Solution,
    force_n: f64,
    evaluations: u32,
    found: Vec<ForceMatch>,
    /// So many zeros are looked for.
    enough: usize,
    /// Least residual of all shapes seen, and its force.
    nearest: (f64, f64),
    converged: bool,
}

impl<'a, G: Fn(&Solution) -> Goal> Path<'a, G> {
    fn new(statics: &'a Statics<'a>, load: &'a Load, goal: G) -> Self {
        Self {
            statics,
            load,
            goal,
            solution: Solution::default(),
            force_n: 0.0,
            evaluations: 0,
            found: Vec::new(),
            enough: 0,
            nearest: (f64::INFINITY, 0.0),
            converged: true,
        }
    }

    fn at(&mut self, force_n: f64) -> Goal {
        self.evaluations += 1;
        // Where T2 goes on to, as a start for a load that moves with it.
        let top = self.statics.model().midpoints_mm.len() - 1;
        if let [rates, ..] = &self.solution.midpoint_rates[..] {
            let step_mm = rates[top] * (force_n - self.force_n);
            if self.solution.converged && step_mm.norm() < LONGEST_GUESS_MM {
                self.solution.deformed.midpoints_mm[top] += step_mm;
            }
        }
        self.force_n = force_n;
        self.statics.solve(self.load, &[force_n], &[Parameter::Load(0)], &mut self.solution);
        let goal = (self.goal)(&self.solution);
        if self.solution.converged && goal.residual.abs() < self.nearest.0 {
            self.nearest = (goal.residual.abs(), force_n);
        }
        goal
    }

    /// Whether no hinge of the last shape turns too far.
    fn is_plausible(&self) -> bool {
        self.solution.deformed.largest_hinge_rad() <= LARGEST_HINGE_RAD
    }

    fn record(&mut self, status: MatchStatus, force_n: f64, residual: f64) {
        let (evaluations, solution) = (self.evaluations, self.solution.clone());
        self.found.push(ForceMatch { status, force_n, residual, evaluations, solution });
    }

    /// Follows the path of one sign until so many zeros were found, or to its end.
    fn follow(&mut self, sign: ForceSign, most: usize) {
        let sign = sign.factor();
        let cap_n = LARGEST_FORCE_PER_STIFFNESS * self.statics.mean_lateral_nmm_per_rad();
        self.enough = self.found.len().saturating_add(most);
        self.solution = Solution::default();
        let (mut force_n, mut now) = (0.0, self.at(0.0));
        let last = self.evaluations + MOST_EVALUATIONS;
        while self.evaluations < last {
            if now.met {
                self.record(MatchStatus::Matched, force_n, now.residual);
                if self.found.len() >= self.enough {
                    return;
                }
                // Past the zero, on the other side or back on the same one.
                force_n += sign * 1e-3 * now.step_n.min(cap_n);
                now = self.at(force_n);
                if now.met {
                    self.converged = false;
                    return;
                }
            }
            let newton = -now.value / now.rate * sign;
            let step = if newton > 0.0 && newton < now.step_n { newton } else { now.step_n };
            let next_n = (force_n + sign * step).clamp(-cap_n, cap_n);
            let next = self.at(next_n);
            if !self.solution.converged {
                self.converged = false;
                return;
            }
            let plausible = self.is_plausible();
            let stops = next_n.abs() >= cap_n || !plausible;
            if next.met {
                if stops && plausible {
                    self.record(MatchStatus::Matched, next_n, next.residual);
                }
            } else {
                let before = self.evaluations;
                zeros_between(&now.sample(force_n), &next.sample(next_n), self);
                if self.found.len() >= self.enough {
                    return;
                }
                if self.evaluations > before {
                    // Where the path goes on from.
                    self.at(next_n);
                }
            }
            if stops {
                return;
            }
            (force_n, now) = (next_n, next);
        }
        self.converged = false;
    }

    /// The first zero that was found, or else the nearest shape with the reason.
    fn first_or_nearest(mut self) -> ForceMatch {
        if self.found.is_empty() {
            let status =
                if self.converged { MatchStatus::Unreachable } else { MatchStatus::NotConverged };
            let force_n = self.nearest.1;
            let residual = self.at(force_n).residual;
            self.record(status, force_n, residual);
        }
        self.found.swap_remove(0)
    }
}

impl<G: Fn(&Solution) -> Goal> Along for Path<'_, G> {
    fn sample(&mut self, force_n: f64) -> Option<Sample> {
        let goal = self.at(force_n);
        self.solution.converged.then(|| goal.sample(force_n))
    }

    fn found(&mut self, zero: Result<Sample, Lost>) -> bool {
        if zero.is_ok() && !self.is_plausible() {
            return true;
        }
        let (status, residual) = (
            if zero.is_ok() { MatchStatus::Matched } else { MatchStatus::NotConverged },
            (self.goal)(&self.solution).residual,
        );
        self.record(status, self.force_n, residual);
        self.found.len() < self.enough
    }
}
