use std::ops::ControlFlow;

use super::balance::{Balance, Factors, State};
use super::loading::{BodyLoad, Loading, LoadingError, Timing};
use super::newton::{Closing, Newton, NewtonEnding, force_and_moment_at};
use super::path::{Goal, OnPoint, PathOptions, Stop, Walk};
use super::stability::smallest_singular_value;
use crate::multibody::{Deformed, SpineModel, Support};
use crate::spatial::{Mat3, Vec3};

/// How a search for equilibria ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathEnding {
    /// The goal is met on the branch that starts at the erect spine, before it turns or splits, and only once.
    Converged,
    /// As converged; further along, the same branch meets the goal again.
    SeveralEquilibria,
    /// The load has a maximum on the branch before the goal: a real spine would snap. Equilibria beyond it may be listed.
    LimitPoint,
    /// Another branch crosses before the goal: a real spine would leave this one (buckling).
    BranchPoint,
    /// The goal is not met up to the largest hinge angle or factor, or a rod's pose cannot be had.
    Unreachable,
    /// The path could not be followed to an end.
    NotConverged,
    /// The caller broke off: what lies further on the path is not known.
    Interrupted,
}

impl PathEnding {
    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::SeveralEquilibria => "several_equilibria",
            Self::LimitPoint => "limit_point",
            Self::BranchPoint => "branch_point",
            Self::Unreachable => "unreachable",
            Self::NotConverged => "not_converged",
            Self::Interrupted => "interrupted",
        }
    }

    /// Whether the first equilibrium may be shown as a result.
    #[must_use]
    pub const fn is_usable(self) -> bool {
        matches!(self, Self::Converged | Self::SeveralEquilibria)
    }
}

/// What happened to the branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchEventKind {
    /// The factor has a maximum or minimum.
    LimitPoint,
    /// Another branch crosses.
    BranchPoint,
}

impl BranchEventKind {
    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::LimitPoint => "limit_point",
            Self::BranchPoint => "branch_point",
        }
    }
}

/// A singular point that the path went through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchEvent {
    /// What it was.
    pub kind: BranchEventKind,
    /// Which loads were varied.
    pub timing: Timing,
    /// Their factor there.
    pub factor: f64,
    /// Length of the path up to there: hinges in rad, and a factor of one as much as it turns the unloaded hinges.
    pub arc_rad: f64,
}

/// One shape on the path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPoint {
    /// Which loads are varied.
    pub timing: Timing,
    /// Their factor.
    pub factor: f64,
    /// Length of the path up to here.
    pub arc_rad: f64,
    /// Limit points before it.
    pub limit_points: usize,
    /// Branch points before it.
    pub branch_points: usize,
    /// Newton's iterations.
    pub iterations: u32,
    /// Largest angle by which a hinge misses the one that its moment asks for.
    pub residual_rad: f64,
    /// The vertebrae.
    pub deformed: Deformed,
}

/// A shape that meets the goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Factor of the growing loads.
    pub factor: f64,
    /// The vertebrae.
    pub deformed: Deformed,
    /// Largest angle by which a hinge misses the one that its moment asks for.
    pub residual_rad: f64,
    /// Smallest singular value of the tangent, scaled so that it is one for an unloaded spine with diagonal springs;
    /// zero where the branch turns or splits. Where rods leave no hinge free it is one.
    pub smallest_singular_value: f64,
    /// Limit points between the erect spine and this shape.
    pub limit_points: usize,
    /// Branch points between the erect spine and this shape.
    pub branch_points: usize,
    /// Force of every pad and strap, by its place among the loads; negative for a pad that pulls or a strap that pushes.
    pub spring_forces_n: Vec<(usize, f64)>,
    /// Force and moment, about its midpoint, that every rod puts on its upper vertebra.
    pub rod_reactions: Vec<(Vec3, Vec3)>,
}

impl Equilibrium {
    pub(super) fn new(
        balance: &Balance<'_>,
        factors: &Factors,
        state: &State,
        path: &EquilibriumPath,
    ) -> Self {
        let springs = balance.loading.items.iter().enumerate();
        let spring_forces_n = springs
            .filter_map(|(number, item)| {
                let (BodyLoad::Pad { point_in_vertebra_mm, .. }
                | BodyLoad::Strap { point_in_vertebra_mm, .. }) = &item.load
                else {
                    return None;
                };
                let v = item.vertebra;
                let point = state.midpoints[v] + state.axes[v] * point_in_vertebra_mm;
                let factor = factors.of(item.timing);
                Some((number, item.load.spring(&point, factor, balance.model, v).force_n))
            })
            .collect();
        let rods = balance.loading.rods.iter().zip(&state.reactions);
        Self {
            factor: factors.growing,
            deformed: state.deformed(),
            residual_rad: balance.residual_rad(state),
            smallest_singular_value: smallest_singular_value(balance, state),
            limit_points: path.count(BranchEventKind::LimitPoint),
            branch_points: path.count(BranchEventKind::BranchPoint),
            spring_forces_n,
            rod_reactions: rods
                .map(|(rod, wrench)| force_and_moment_at(wrench, &state.midpoints[rod.superior]))
                .collect(),
        }
    }

    /// Whether the branch neither turned nor split on the way from the erect spine.
    #[must_use]
    pub const fn is_on_erect_branch(&self) -> bool {
        self.limit_points == 0 && self.branch_points == 0
    }
}

/// The branch of equilibria from the erect spine, and what was met on it.
#[derive(Debug, Clone, PartialEq)]
pub struct EquilibriumPath {
    /// How the search ended.
    pub ending: PathEnding,
    /// The shapes, from the unloaded one on.
    pub points: Vec<PathPoint>,
    /// Every shape that meets the goal, in the order of the path.
    pub equilibria: Vec<Equilibrium>,
    /// Singular points, in the order of the path.
    pub events: Vec<BranchEvent>,
    /// Newton's iterations altogether.
    pub iterations: u64,
}

impl EquilibriumPath {
    pub(super) fn count(&self, kind: BranchEventKind) -> usize {
        self.events.iter().filter(|event| event.kind == kind).count()
    }

    /// The shape that may be shown as the result: the first that meets the goal, if the ending allows.
    #[must_use]
    pub fn result(&self) -> Option<&Equilibrium> {
        self.equilibria.first().filter(|_| self.ending.is_usable())
    }

    fn ending(&self, stop: Stop) -> PathEnding {
        let limit_points = self.count(BranchEventKind::LimitPoint) > 0;
        match (&self.equilibria[..], stop) {
            (_, Stop::Interrupted) => PathEnding::Interrupted,
            ([first, others @ ..], _) if first.is_on_erect_branch() => {
                if others.is_empty() {
                    PathEnding::Converged
                } else {
                    PathEnding::SeveralEquilibria
                }
            }
            ([first, ..], _) if first.limit_points > 0 => PathEnding::LimitPoint,
            ([_, ..], _) => PathEnding::BranchPoint,
            ([], _) if limit_points => PathEnding::LimitPoint,
            ([], Stop::Limit | Stop::RodOutOfReach) => PathEnding::Unreachable,
            ([], Stop::Enough | Stop::Stuck) => PathEnding::NotConverged,
        }
    }
}

/// A spring matrix that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpringError {
    /// Not symmetric and positive definite: it would give energy away.
    #[error("the stiffness of joint {joint} is not symmetric and positive definite")]
    NotPositive {
        /// Which joint, from the fixed vertebra upwards.
        joint: usize,
    },
    /// Not one per joint.
    #[error("there are {given} joint stiffnesses for {joints} joints")]
    Count {
        /// How many there are.
        given: usize,
        /// How many there must be.
        joints: usize,
    },
}

/// A spine with springs under any loads: the general solver beside the explicit march.
///
/// Newton on the hinge angles with an analytic, unsymmetric tangent ([`GeneralStatics::solve_near`]), and pseudo-arclength
/// continuation of the branch that starts at the erect spine ([`GeneralStatics::follow`]).
#[derive(Debug, Clone)]
pub struct GeneralStatics<'a> {
    model: &'a SpineModel,
    stiffness: Vec<Mat3>,
    support: Support,
}

/// How Newton from a nearby start ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearbyReport {
    /// Whether hinges and rods balance.
    pub converged: bool,
    /// Newton's iterations.
    pub iterations: u32,
    /// Largest angle by which a hinge misses the one that its moment asks for; NaN where the shape was lost.
    pub residual_rad: f64,
}

/// Newton's buffers for one spine under one loading: made once, used for many starts and factors.
#[derive(Debug, Clone, PartialEq)]
pub struct NewtonWork(Newton);

impl NewtonWork {
    /// Hinge angles, in and out.
    pub fn hinges_mut(&mut self) -> &mut [Vec3] {
        &mut self.0.state.hinges
    }

    /// Midpoints of the last shape.
    #[must_use]
    pub fn midpoints_mm(&self) -> &[Vec3] {
        &self.0.state.midpoints
    }

    /// The last shape.
    #[must_use]
    pub fn deformed(&self) -> Deformed {
        self.0.state.deformed()
    }
}

impl<'a> GeneralStatics<'a> {
    /// Springs of every joint about its hinges x, y and z, in N·mm/rad; off the diagonal they couple the hinges.
    ///
    /// # Errors
    /// [`SpringError`].
    pub fn new(
        model: &'a SpineModel,
        nmm_per_rad: impl IntoIterator<Item = Mat3>,
        support: Support,
    ) -> Result<Self, SpringError> {
        let mut stiffness: Vec<Mat3> = nmm_per_rad.into_iter().collect();
        let (given, joints) = (stiffness.len(), model.joints.len());
        if given != joints {
            return Err(SpringError::Count { given, joints });
        }
        for (joint, matrix) in stiffness.iter_mut().enumerate() {
            let symmetric = (*matrix - matrix.transpose()).amax() <= 1e-9 * matrix.amax();
            let finite = matrix.iter().all(|entry| entry.is_finite());
            if !(finite && symmetric && matrix.cholesky().is_some()) {
                return Err(SpringError::NotPositive { joint });
            }
            if support == Support::Frontal {
                // Locked hinges neither turn nor take part.
                *matrix = Mat3::from_diagonal(&matrix.diagonal());
            }
        }
        Ok(Self { model, stiffness, support })
    }

    fn balance<'b>(&'b self, loading: &'b Loading) -> Balance<'b> {
        Balance { model: self.model, stiffness: &self.stiffness, support: self.support, loading }
    }

    /// Buffers for [`GeneralStatics::solve_near`], at the erect spine.
    ///
    /// # Errors
    /// [`LoadingError`] where a load cannot be applied to this spine.
    pub fn work(&self, loading: &Loading) -> Result<NewtonWork, LoadingError> {
        loading.check(self.model)?;
        Ok(NewtonWork(Newton::new(&self.balance(loading))))
    }

    /// Equilibrium under a loading whose growing loads are multiplied by a factor, by Newton from the hinge angles in
    /// `work`. No allocation.
    ///
    /// The start must be near: nothing tells which branch was found. `work` must have been made for this loading.
    ///
    /// # Accuracy
    /// Newton stops once a step is below 1e-9 rad, so what is left is of the order of its square, and rounding.
    pub fn solve_near(
        &self,
        loading: &Loading,
        factor: f64,
        work: &mut NewtonWork,
    ) -> NearbyReport {
        let mut factors = Factors { held: 1.0, growing: factor, varies: Timing::Growing };
        let report = work.0.correct(&self.balance(loading), &mut factors, &Closing::Factor);
        NearbyReport {
            converged: report.ending == NewtonEnding::Balanced,
            iterations: report.iterations,
            residual_rad: report.residual_rad,
        }
    }

    /// Follows the branch of equilibria from the erect spine: first while the held loads come, then as the growing ones do.
    ///
    /// The branch is followed past limit points; the solver never steps to another branch without saying so.
    ///
    /// # Errors
    /// [`LoadingError`] where a load cannot be applied to this spine.
    pub fn follow(
        &self,
        loading: &Loading,
        goal: Goal,
        options: &PathOptions,
    ) -> Result<EquilibriumPath, LoadingError> {
        self.follow_with(loading, goal, options, &mut |_| ControlFlow::Continue(()))
    }

    /// As [`GeneralStatics::follow`], telling of every point as it is found; the caller may break off.
    ///
    /// # Errors
    /// [`LoadingError`] where a load cannot be applied to this spine.
    pub fn follow_with(
        &self,
        loading: &Loading,
        goal: Goal,
        options: &PathOptions,
        on_point: OnPoint<'_>,
    ) -> Result<EquilibriumPath, LoadingError> {
        let NewtonWork(mut newton) = self.work(loading)?;
        let balance = self.balance(loading);
        let mut path = EquilibriumPath {
            ending: PathEnding::NotConverged,
            points: Vec::new(),
            equilibria: Vec::new(),
            events: Vec::new(),
            iterations: 0,
        };
        if loading.has_held() {
            let factors = Factors { held: 0.0, growing: 0.0, varies: Timing::Held };
            let once = PathOptions {
                sign: crate::multibody::ForceSign::Positive,
                largest_factor: 1.0,
                look_beyond: false,
                ..*options
            };
            let stage = (factors, Goal::FullLoad);
            let stop = Walk::new(balance, &mut newton, stage, &once, &mut path, on_point).run();
            path.ending = path.ending(stop);
            let stands = path.result().is_some() && stop != Stop::Interrupted;
            // These shapes do not meet the goal, whatever came of them.
            path.equilibria.clear();
            if !stands {
                return Ok(path);
            }
        }
        let factors = Factors { held: 1.0, growing: 0.0, varies: Timing::Growing };
        let stop =
            Walk::new(balance, &mut newton, (factors, goal), options, &mut path, on_point).run();
        path.ending = path.ending(stop);
        Ok(path)
    }
}
