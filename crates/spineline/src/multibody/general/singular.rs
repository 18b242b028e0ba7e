//! Singular points of the branch: where the factor turns, and where other branches cross.

use super::path::{Base, Walk};
use super::stability::smallest_singular_value;
use crate::multibody::follow::{BranchEventKind, Event};
use crate::multibody::roots::{Sample, turning_point};

/// A change of signs is narrowed down to this part of its step.
const NARROW: f64 = 1e-9;
/// Elimination loses its digits beside a zero pivot, though the tangent be regular: then this has to do.
const NARROW_ENOUGH: f64 = 1e-3;
/// Shapes on both sides of such a gap are the same, or the step went from one branch to another.
const SAME_RAD: f64 = 1e-3;
/// A tangent is singular in a gap where its smallest singular value is below this.
const SINGULAR: f64 = 1e-3;

impl Walk<'_, '_> {
    /// Singular points between two points; `None` where the two are not on one branch.
    ///
    /// A step over a sharp bend may land on the branch beyond it. The signs show it: where they change, the branch must be
    /// singular, or the shapes on both sides of the change are not neighbours.
    pub(super) fn events_between(&mut self, base: &Base, next: &Base) -> Option<Vec<Event>> {
        let mut events = Vec::new();
        let mut gaps = Vec::new();
        if base.signs != next.signs {
            let mut from = base.clone();
            from.goal.at = 0.0;
            gaps.push((from, next.clone()));
        }
        let length = next.goal.at;
        while let Some((low, high)) = gaps.pop() {
            let width = high.goal.at - low.goal.at;
            let middle = if width > NARROW * length {
                self.beside(base, f64::midpoint(low.goal.at, high.goal.at))
            } else {
                None
            };
            if let Some((middle, _)) = middle {
                if middle.signs != high.signs {
                    gaps.push((middle.clone(), high));
                }
                if low.signs != middle.signs {
                    gaps.push((low, middle));
                }
            } else if width <= NARROW_ENOUGH * length {
                events.extend(self.event_in_gap(&low, &high)?);
            } else {
                return None;
            }
        }
        let turned = base.tangent.factor * next.tangent.factor < 0.0;
        let is_limit = |event: &Event| {
            matches!(event, Event::Singular { kind: BranchEventKind::LimitPoint, .. })
        };
        if turned && !events.iter().any(is_limit) {
            events.push(self.limit_point(base, next)?);
        }
        Some(events)
    }

    /// The singular point in a narrow gap over which the signs change, if any; an outer `None` if its sides differ.
    fn event_in_gap(&mut self, low: &Base, high: &Base) -> Option<Option<Event>> {
        let apart = low.hinges.iter().zip(&high.hinges);
        if apart.map(|(a, b)| (a - b).amax()).fold(0.0, f64::max) > SAME_RAD {
            return None;
        }
        let least = [low, high].map(|side| {
            self.restore(side);
            smallest_singular_value(&self.balance, &self.newton.state)
        });
        if least[0].min(least[1]) > SINGULAR {
            return Some(None);
        }
        let turned = low.tangent.factor * high.tangent.factor < 0.0;
        let kind = if turned { BranchEventKind::LimitPoint } else { BranchEventKind::BranchPoint };
        Some(Some(Event::Singular { at: low.goal.at, factor: low.factor, kind }))
    }

    /// Where the factor turns between two points.
    fn limit_point(&mut self, base: &Base, next: &Base) -> Option<Event> {
        let sample = |at, base: &Base| Sample {
            at,
            value: base.factor,
            rate: base.tangent.factor,
            exact: true,
            met: false,
        };
        let (from, to) = (sample(0.0, base), sample(next.goal.at, next));
        let turn = turning_point(&from, &to, |at| {
            self.beside(base, at).map(|(between, _)| sample(at, &between))
        });
        let Sample { at, value, .. } = turn.ok()?;
        Some(Event::Singular { at, factor: value, kind: BranchEventKind::LimitPoint })
    }
}
