use super::balance::{Balance, Factors, State};
use super::loading::Timing;
use super::newton::force_and_moment_at;
use super::stability::smallest_singular_value;
use crate::multibody::Deformed;
use crate::multibody::follow::{BranchEventKind, PathEnding, Stop};
use crate::spatial::Vec3;

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
    /// Largest difference between a hinge angle and the one of its moment.
    pub residual_rad: f64,
    /// The vertebrae.
    pub deformed: Deformed,
}

/// A shape that meets the goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Factor of the proportional loads.
    pub factor: f64,
    /// The vertebrae.
    pub deformed: Deformed,
    /// Largest difference between a hinge angle and the one of its moment.
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
                let (v, factor) = (item.vertebra, factors.of(item.timing));
                let spring = item.load.spring(&state.pose(v), factor, balance.model, v)?;
                Some((number, spring.force_n))
            })
            .collect();
        let rods = balance.loading.rods.iter().zip(&state.reactions);
        Self {
            factor: factors.proportional,
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
    /// Whether it was followed to its end: a largest factor or hinge, a rod's reach, or as far as was asked. Else there may
    /// be more shapes that meet the goal.
    pub is_complete: bool,
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

    pub(super) fn ending(&self, stop: Stop) -> PathEnding {
        let limit_points = self.count(BranchEventKind::LimitPoint) > 0;
        let branch_points = self.count(BranchEventKind::BranchPoint) > 0;
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
            ([], _) if branch_points => PathEnding::BranchPoint,
            ([], Stop::Limit | Stop::RodOutOfReach) => PathEnding::Unreachable,
            ([], Stop::Enough | Stop::Stuck) => PathEnding::NotConverged,
        }
    }
}
