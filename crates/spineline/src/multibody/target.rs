//! Targets of a search along an increasing force: a lateral tilt of the line L4→T2, or the smallest distance of T2 from a
//! place.

use super::Solution;
use super::roots::Sample;
use crate::spatial::{Angle, Frontal, Vec3};

/// A hinge turns by at most this from one step to the next.
const STEP_RAD: f64 = 0.25;
/// T2 may move by this from one state to the next; if it is far away, by this part of its distance.
const T2_STEP_MM: f64 = 4.0;
const T2_STEP_OF_GAP: f64 = 0.25;
/// Further away a step might end on another path.
const MAX_T2_STEP_MM: f64 = 60.0;
/// Distances of T2 that differ by less are equally good: about the error of a location's reading and of the model's joints.
pub(super) const T2_TOLERANCE_MM: f64 = 1.0;

/// Residual of the target of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Residual {
    /// Of an amplitude: lateral tilt of the line L4→T2 beyond the target's.
    Amplitude(Angle),
    /// Distance of T2 from the target's place.
    Distance {
        /// In mm.
        mm: f64,
    },
}

impl Residual {
    /// The tilt of an amplitude; `None` for a distance.
    #[must_use]
    pub const fn tilt(self) -> Option<Angle> {
        match self {
            Self::Amplitude(tilt) => Some(tilt),
            Self::Distance { .. } => None,
        }
    }

    /// The distance of T2; `None` for an amplitude.
    #[must_use]
    pub const fn distance_mm(self) -> Option<f64> {
        match self {
            Self::Amplitude(_) => None,
            Self::Distance { mm } => Some(mm),
        }
    }
}

/// A condition on the shape that a search along the force looks for.
pub(super) trait SearchTarget {
    /// The state of the path under a force; `nearest` is the least residual so far.
    fn state(&self, force_n: f64, solution: &Solution, nearest: f64) -> PathState;

    /// Whether a step was short enough that no zero was passed unnoticed.
    fn is_fine(&self, _from: &PathState, _to: &PathState) -> bool {
        true
    }

    /// Whether a zero between two states may be a result; `nearest` is the least residual so far.
    fn counts_between(&self, _from: &PathState, _to: &PathState, _nearest: f64) -> bool {
        true
    }

    fn residual(of_state: f64) -> Residual;

    /// The least residual that a result between two states may have; `None` without one, or without a lower bound.
    fn least_between(&self, _from: &PathState, _to: &PathState) -> Option<f64> {
        None
    }
}

/// A lateral tilt of the line L4→T2.
pub(super) struct AmplitudeTarget(pub Angle);

impl SearchTarget for AmplitudeTarget {
    fn state(&self, force_n: f64, solution: &Solution, _nearest: f64) -> PathState {
        let value = (solution.deformed.lateral_tilt() - self.0).wrapped().rad();
        let (rate, met) = (solution.lateral_tilt_rate(0), value.abs() < 1e-9);
        let (step_n, [t2, t2_rate]) = (turn_step(solution), t2_of(solution));
        PathState { force_n, value, rate, exact: true, residual: value, met, step_n, t2, t2_rate }
    }

    fn residual(rad: f64) -> Residual {
        Residual::Amplitude(Angle::from_rad(rad))
    }
}

/// The smallest distance of T2 from a place.
pub(super) struct NearestT2Target(pub Frontal);

impl SearchTarget for NearestT2Target {
    fn state(&self, force_n: f64, solution: &Solution, nearest: f64) -> PathState {
        let [t2, t2_rate] = t2_of(solution);
        let gap = Frontal::new(t2.y, t2.z) - self.0;
        let moves = Frontal::new(t2_rate.y, t2_rate.z);
        // Half the derivative of the squared distance, and the derivative of this half without the curvature of the path.
        let (value, rate) = (gap.dot(moves), moves.dot(moves).max(f64::MIN_POSITIVE));
        let met = value.abs() < 1e-10 * rate.sqrt().max(1e-6);
        let gap_mm = gap.norm_mm();
        // What a step jumps over lies hardly nearer than a part of the distance now; and once T2 went away, it must come
        // back before its distance can count.
        let travel_mm = (T2_STEP_OF_GAP * gap_mm)
            .max(gap_mm - nearest - T2_TOLERANCE_MM)
            .clamp(T2_STEP_MM, MAX_T2_STEP_MM);
        let step_n = turn_step(solution).min(travel_mm / rate.sqrt());
        PathState { force_n, value, rate, exact: false, residual: gap_mm, met, step_n, t2, t2_rate }
    }

    fn residual(mm: f64) -> Residual {
        Residual::Distance { mm }
    }

    /// Whether T2 moved about as far as its rate said.
    fn is_fine(&self, from: &PathState, to: &PathState) -> bool {
        let step_n = (to.force_n - from.force_n).abs();
        let [foreseen_mm, moved_mm] = [from, to].map(|state| step_n * state.rate.sqrt());
        let moved_mm = moved_mm.max((to.t2 - from.t2).norm());
        moved_mm <= 2.0 * foreseen_mm.max(T2_STEP_MM)
    }

    /// Where the distance is least between them, not greatest, and may be as small as that.
    fn counts_between(&self, from: &PathState, to: &PathState, nearest: f64) -> bool {
        let step_n = to.force_n - from.force_n;
        from.value * step_n < 0.0 && lower_bound_mm(from, to) <= nearest + T2_TOLERANCE_MM
    }

    fn least_between(&self, from: &PathState, to: &PathState) -> Option<f64> {
        let step_n = to.force_n - from.force_n;
        let has_minimum = from.value * step_n <= 0.0 && to.value * step_n >= 0.0;
        has_minimum.then(|| lower_bound_mm(from, to))
    }
}

/// A lower bound of T2's distance between two states.
fn lower_bound_mm(from: &PathState, to: &PathState) -> f64 {
    let travel_mm = (to.force_n - from.force_n).abs() * from.rate.max(to.rate).sqrt();
    0.5 * (from.residual + to.residual) - travel_mm
}

/// One point of the path: a value whose zeros are looked for, its derivative, and the residual to report.
#[derive(Debug, Clone, Copy)]
pub(super) struct PathState {
    pub force_n: f64,
    value: f64,
    rate: f64,
    /// Whether the derivative is complete.
    exact: bool,
    /// In rad or mm, as the target measures it.
    pub residual: f64,
    pub met: bool,
    /// How far the force may grow before the next state is computed.
    pub step_n: f64,
    /// Where T2 is, and its derivative.
    pub t2: Vec3,
    pub t2_rate: Vec3,
}

impl PathState {
    /// Whether the residual still falls along the path in the direction of a sign.
    pub fn falls(&self, sign: f64) -> bool {
        self.value * sign < 0.0
    }

    /// How far T2 moves when the force grows by `step_n`.
    pub fn travel_mm(&self, step_n: f64) -> f64 {
        step_n.abs() * self.t2_rate.norm()
    }

    pub fn sample(&self) -> Sample {
        let Self { force_n, value, rate, exact, met, .. } = *self;
        Sample { at: force_n, value, rate, exact, met }
    }

    /// How far a zero is off: by Newton, or where the derivative is not whole, by the state before.
    pub fn newton_step_n(&self, before: Option<&Self>) -> f64 {
        let secant = before
            .map(|before| (self.value - before.value) / (self.force_n - before.force_n))
            .filter(|secant| !self.exact && *secant > 0.0);
        -self.value / secant.unwrap_or(self.rate)
    }
}

/// Where T2 is, and its derivative by the force.
fn t2_of(solution: &Solution) -> [Vec3; 2] {
    let top = solution.deformed.midpoints_mm.len() - 1;
    [solution.deformed.midpoints_mm[top], solution.midpoint_rates[0][top]]
}

/// The force that turns the fastest hinge by a step.
fn turn_step(solution: &Solution) -> f64 {
    STEP_RAD / solution.fastest_turn(0).max(f64::MIN_POSITIVE)
}
