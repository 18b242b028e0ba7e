//! Continuation: a branch of equilibria is followed from the unloaded spine, step by step, until nothing more is wanted.
//!
//! Two kinds of places make a [`Branch`]. Where a shape is a function of the force, a place is a force ([`super::matching`]). Where
//! loads move with the spine, the branch may turn and split, and a place is a length along it (`general::path`).

use std::ops::ControlFlow;

use super::roots::Sample;
use crate::anatomy::named;

named! {
    /// How a search for equilibria ended.
    ///
    /// A force along a line ends as converged, beyond the human range, unreachable or not converged, or its fit did.
    pub enum PathEnding {
        /// The goal is met on the branch that starts at the erect spine, before it turns or splits, and only once; or the load was
        /// known and its equilibrium found.
        Converged = "converged",
        /// As converged; further along, the same branch meets the goal again. Forces along a line that meet the goal are listed
        /// instead.
        SeveralEquilibria = "several_equilibria",
        /// The load has a maximum on the branch before the goal: a real spine would snap. Equilibria beyond it may be listed.
        LimitPoint = "limit_point",
        /// Another branch crosses before the goal: a real spine would leave this one (buckling).
        BranchPoint = "branch_point",
        /// The goal is met, but by a shape beyond the human range of motion. Only responses to loads and simulations of films judge
        /// this.
        BeyondHumanRange = "beyond_human_range",
        /// The goal is not met up to the largest hinge angle or load, or a rod's pose cannot be had; a search for a force gives the
        /// nearest shape.
        Unreachable = "unreachable",
        /// The path could not be followed to an end.
        NotConverged = "not_converged",
        /// The search ended, but the fit of its stiffness did not converge. Only simulations of films have fits.
        FitNotConverged = "fit_not_converged",
        /// The caller broke off: the rest of the path is not known.
        Interrupted = "interrupted",
    }
}

impl PathEnding {
    /// What it means, and what to do about it.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Converged => "the target is met once on the path from the erect spine",
            Self::SeveralEquilibria => {
                "several equilibria meet the target; the first one on the path from the erect spine is the result"
            }
            Self::LimitPoint => {
                "the path has a limit point before the target, and a real spine would snap there"
            }
            Self::BranchPoint => {
                "the path has a branch point before the target, and a real spine would buckle there"
            }
            Self::BeyondHumanRange => {
                "the loads rotate joints or the whole spine farther than any human spine; linear springs do not limit it as ligaments, facets and muscles do; reduce the loads or the amplitude"
            }
            Self::Unreachable => {
                "the target is not met up to the largest load factor and hinge angle, or the pose of a rod cannot be reached; reduce the loads or the amplitude, or load another vertebra"
            }
            Self::NotConverged => {
                "the solver did not converge along the path of equilibria, with or against the loads, before the first solution was certain; try smaller loads, and rods whose poses do not contradict each other"
            }
            Self::FitNotConverged => {
                "the fit of the stiffness did not converge; check the landmarks of the bends"
            }
            Self::Interrupted => "the search was interrupted",
        }
    }

    /// Whether the first equilibrium may be shown as a result.
    #[must_use]
    pub const fn is_usable(self) -> bool {
        matches!(self, Self::Converged | Self::SeveralEquilibria)
    }
}

named! {
    /// What happened to the branch.
    pub enum BranchEventKind {
        /// The factor has a maximum or minimum.
        LimitPoint = "limit_point",
        /// Another branch crosses.
        BranchPoint = "branch_point",
    }
}

/// What a step passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// The goal is met.
    GoalMet(Sample),
    /// The branch turns or splits.
    Singular {
        /// How far along the step.
        at: f64,
        /// The factor there.
        factor: f64,
        kind: BranchEventKind,
    },
}

impl Event {
    /// How far along the step.
    pub const fn at(&self) -> f64 {
        match self {
            Self::GoalMet(sample) => sample.at,
            Self::Singular { at, .. } => *at,
        }
    }
}

/// Why a branch is followed no further.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// Nothing more is requested.
    Enough,
    /// The largest hinge angle or load.
    Limit,
    RodOutOfReach,
    /// No step, however short, led on; or the largest number of steps.
    Stuck,
    Interrupted,
}

/// A branch of equilibria on which steps can be taken.
pub(super) trait Branch {
    /// A place on it, from which to step.
    type Place;

    /// The unloaded spine; `None` where it is not in equilibrium.
    fn start(&mut self) -> Option<Self::Place>;

    /// Takes note of a place; whether the branch is followed from there. It may move the place on, past a goal that is met there.
    fn arrive(&mut self, place: &mut Self::Place) -> ControlFlow<Stop>;

    /// Lengths of the first and of the shortest step to try from a place.
    fn lengths(&self, place: &Self::Place) -> [f64; 2];

    /// The place at a step; `None` where it does not converge, or where a step of this length may pass something unnoticed.
    fn step(&mut self, from: &Self::Place, length: f64) -> Option<Self::Place>;

    /// Reports what lies between two places, in order; whether the branch is followed beyond.
    fn pass(&mut self, from: &Self::Place, to: &Self::Place) -> ControlFlow<Stop>;

    /// Why no step led on.
    fn stuck(&self) -> Stop {
        Stop::Stuck
    }
}

/// Follows a branch; a step that fails is halved.
pub(super) fn follow<B: Branch>(branch: &mut B) -> Stop {
    let Some(mut now) = branch.start() else { return Stop::Stuck };
    loop {
        if let ControlFlow::Break(stop) = branch.arrive(&mut now) {
            return stop;
        }
        let [mut length, shortest] = branch.lengths(&now);
        let next = loop {
            if let Some(next) = branch.step(&now, length) {
                break next;
            }
            length *= 0.5;
            if length < shortest {
                return branch.stuck();
            }
        };
        if let ControlFlow::Break(stop) = branch.pass(&now, &next) {
            return stop;
        }
        now = next;
    }
}
