use crate::anatomy::named;
use std::ops::ControlFlow;

use crate::multibody::{
    BodyLoad, Deformed, Equilibrium, EquilibriumPath, ForceSign, GeneralStatics, Goal, Loading,
    LoadingError, MAX_FORCE_PER_STIFFNESS, PathEnding, PathOptions, PathPoint, SpineModel, Timing,
};
use crate::spatial::Mat3;

/// A goal that is met at a smaller factor is met by the unloaded spine.
const NO_LOAD: f64 = 1e-9;
/// Loads given in small units take many points; more than these lead nowhere.
const MAX_POINTS: usize = 20_000;

/// A path whose proportional loads grow along or against themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct SignedPath {
    /// Along or against.
    pub sign: ForceSign,
    /// The path.
    pub path: EquilibriumPath,
}

named! {
    /// Why a shape that meets the goal is the one that the spine takes, or is not.
    pub enum Verdict {
        /// The least loaded shape that the erect spine reaches without snapping or buckling.
        Reached = "reached",
        /// Reached as well, but under greater loads, or later on the path.
        Later = "later",
        /// The loads have a maximum before it: the spine would have snapped.
        BeyondLimitPoint = "beyond_limit_point",
        /// Another branch crosses before it: the spine would have buckled away.
        BeyondBranchPoint = "beyond_branch_point",
        /// No human spine takes this shape ([`Deformed::beyond_human_range`]).
        BeyondHumanRange = "beyond_human_range",
    }
}

/// A shape that meets the goal.
#[derive(Debug, Clone, PartialEq)]
pub struct GoalEquilibrium {
    /// On which path.
    pub sign: ForceSign,
    /// The shape.
    pub equilibrium: Equilibrium,
    /// The verdict on it.
    pub verdict: Verdict,
}

/// The response of a spine to loads.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Target of the search.
    pub goal: Goal,
    /// No factor beyond this one was looked at.
    pub largest_factor: f64,
    /// How the search ended, over all paths.
    pub ending: PathEnding,
    /// One path for a given load; for a given amplitude one along and one against the loads.
    pub paths: Vec<SignedPath>,
    /// Every shape that meets the goal: those on the erect branch first, of these the shapes within the human range, and the smaller
    /// factor first.
    pub equilibria: Vec<GoalEquilibrium>,
}

impl Response {
    /// The shape that may be shown as the result.
    #[must_use]
    pub fn result(&self) -> Option<&Equilibrium> {
        self.equilibria.first().filter(|_| self.ending.is_usable()).map(|found| &found.equilibrium)
    }

    /// Whether every path was followed to its end; else there may be more shapes that meet the goal.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.paths.iter().all(|signed| signed.path.is_complete)
    }

    /// The point of the paths that comes nearest to the goal; `None` where no path could be started.
    #[must_use]
    pub fn nearest(&self) -> Option<&PathPoint> {
        let points = || self.paths.iter().flat_map(|signed| &signed.path.points);
        // The goal does not apply while constant loads are applied.
        let grows = points().any(|point| point.timing == Timing::Proportional);
        let counts = |point: &&PathPoint| !grows || point.timing == Timing::Proportional;
        let away = |point: &PathPoint| match self.goal {
            Goal::LateralTilt(tilt) if grows => {
                (point.deformed.lateral_tilt() - tilt).wrapped().rad().abs()
            }
            _ => (point.factor - 1.0).abs(),
        };
        points().filter(counts).min_by(|a, b| away(a).total_cmp(&away(b)))
    }

    /// The last shape within the human range that the erect spine reaches without snapping or buckling: the result, or where
    /// the loads had to stop before it. `None` where no path could be started.
    ///
    /// # Panics
    /// If `erect` is not the model that was loaded.
    #[must_use]
    pub fn last_reached(&self, erect: &SpineModel) -> Option<(f64, &Deformed)> {
        let result = self.result().map(|equilibrium| (equilibrium.factor, &equilibrium.deformed));
        result.or_else(|| {
            let last = self.reached_points(erect).last()?;
            Some((last.factor, &last.deformed))
        })
    }

    /// The shapes that the spine takes one after another, without snapping, buckling or leaving the human range: those before
    /// the result, or without one those before the loads had to stop.
    ///
    /// # Panics
    /// If `erect` is not the model that was loaded.
    pub fn reached_points<'a>(&'a self, erect: &SpineModel) -> impl Iterator<Item = &'a PathPoint> {
        let result = self.result();
        let sign = result.and(self.equilibria.first()).map(|met| met.sign);
        let path = self.paths.iter().find(|signed| sign.is_none_or(|sign| signed.sign == sign));
        let points = path.into_iter().flat_map(|signed| &signed.path.points);
        points.take_while(move |point| {
            let before = result.is_none_or(|result| {
                point.timing == Timing::Constant || point.factor.abs() < result.factor.abs()
            });
            before
                && point.limit_points == 0
                && point.branch_points == 0
                && point.deformed.beyond_human_range(erect).is_none()
        })
    }

    /// The shape that may be shown as the result, or else the nearest one, which may not.
    #[must_use]
    pub fn shape(&self) -> Option<&Deformed> {
        let result = self.result().map(|equilibrium| &equilibrium.deformed);
        result.or_else(|| self.nearest().map(|point| &point.deformed))
    }
}

/// The factor up to which loads are worth following: 1500 N altogether for springs of the usual mean lateral stiffness,
/// and in proportion for others.
///
/// A moment counts as the force that makes it at the spine's other end; a pad or strap as the force that it would have
/// on a rigid spine. Loads without any of these, such as rods, are followed to twice their size.
#[must_use]
pub fn largest_factor(model: &SpineModel, stiffness: &[Mat3], loading: &Loading) -> f64 {
    let top = model.midpoints_mm.len() - 1;
    let length_mm = (model.midpoints_mm[top] - model.midpoints_mm[0]).norm();
    let proportional = loading.items.iter().filter(|item| item.timing == Timing::Proportional);
    let total_n: f64 = proportional
        .map(|item| match &item.load {
            BodyLoad::ForceOnLine { force_n, .. } | BodyLoad::ForceAtPoint { force_n, .. } => {
                force_n.norm()
            }
            BodyLoad::FollowerForce { force_in_vertebra_n, .. } => force_in_vertebra_n.norm(),
            BodyLoad::Moment { moment_nmm: moment }
            | BodyLoad::FollowerMoment { moment_in_vertebra_nmm: moment } => {
                moment.norm() / length_mm
            }
            BodyLoad::Pad { n_per_mm, advance_mm: mm, .. }
            | BodyLoad::Strap { n_per_mm, shortening_mm: mm, .. } => (n_per_mm * mm).abs(),
        })
        .sum();
    let lateral: f64 = stiffness.iter().map(|matrix| matrix[(0, 0)]).sum();
    let mean_lateral = lateral / stiffness.len() as f64;
    let factor = MAX_FORCE_PER_STIFFNESS * mean_lateral / total_n;
    if factor.is_finite() { factor } else { PathOptions::default().largest_factor }
}

/// The factor up to which a search looks where none is given: of [`PathOptions`] for given loads, [`largest_factor`] for a lateral
/// tilt.
#[must_use]
pub fn usual_limit(model: &SpineModel, stiffness: &[Mat3], loading: &Loading, goal: Goal) -> f64 {
    match goal {
        Goal::FullLoad => PathOptions::default().largest_factor,
        Goal::LateralTilt(_) => largest_factor(model, stiffness, loading),
    }
}

/// Called for every point of a path; breaking off leaves the paths as far as they are.
pub type OnSignedPoint<'o> = &'o mut dyn FnMut(ForceSign, &PathPoint) -> ControlFlow<()>;

/// An [`OnSignedPoint`] that never breaks off.
pub fn go_on(_: ForceSign, _: &PathPoint) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Finds the equilibria of a spine under loads that meet a goal.
///
/// For [`Goal::LateralTilt`] the paths along and against the loads are followed. `largest_factor` limits the factor of the
/// proportional loads; [`largest_factor`] proposes it. `on_point` is called for every point of a path and may break off.
///
/// # Errors
/// [`LoadingError`] where a load cannot be applied to this spine.
///
/// ```
/// use spineline::anatomy::SagittalProfile;
/// use spineline::measure::{TiltRule, measure_film};
/// use spineline::multibody::{BodyLoad, GeneralStatics, Goal, Loading, SpineModel, Support};
/// use spineline::response::{go_on, largest_factor, respond};
/// use spineline::spatial::{Angle, Mat3, Vec3};
/// use spineline::warning::Warnings;
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let case = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case;
/// let erect = measure_film(&case.films[0], TiltRule::default(), &mut Warnings::default())?;
/// let model = SpineModel::from_outline(&erect, &SagittalProfile::default());
/// let springs = vec![Mat3::from_diagonal(&Vec3::new(1.5e5, 1.5e5, 3e5)); model.joints.len()];
/// let statics = GeneralStatics::new(&model, springs.clone(), Support::Free)?;
/// // 10 N at T2 to the patient's left, increased until the lateral tilt is 20° left.
/// let push = BodyLoad::at_midpoint(Vec3::new(0.0, 10.0, 0.0));
/// let loading = Loading::single(model.joints.len(), push);
/// let goal = Goal::LateralTilt(Angle::from_deg(-20.0));
/// let most = largest_factor(&model, &springs, &loading);
/// let response = respond(&statics, &loading, goal, most, &mut go_on)?;
/// let found = response.result().ok_or("no equilibrium")?;
/// assert!(found.factor > 0.0);
/// assert!((found.deformed.lateral_tilt().deg() + 20.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn respond(
    statics: &GeneralStatics<'_>,
    loading: &Loading,
    goal: Goal,
    largest_factor: f64,
    on_point: OnSignedPoint<'_>,
) -> Result<Response, LoadingError> {
    let signs: &[ForceSign] = match goal {
        Goal::FullLoad => &[ForceSign::Positive],
        Goal::LateralTilt(_) => &ForceSign::ALL,
    };
    let (mut paths, mut equilibria) = (Vec::new(), Vec::new());
    let mut interrupted = false;
    for &sign in signs {
        let options =
            PathOptions { sign, largest_factor, most_points: MAX_POINTS, ..Default::default() };
        let path = statics.follow_with(loading, goal, &options, &mut |point| {
            let flow = on_point(sign, point);
            interrupted |= flow.is_break();
            flow
        })?;
        let grew = path.points.last().is_some_and(|point| point.timing == Timing::Proportional);
        // An equilibrium under a part of the constant loads does not meet the goal; a goal met at no load is met once.
        let counts =
            |e: &&Equilibrium| grew && !(sign == ForceSign::Negative && e.factor.abs() < NO_LOAD);
        equilibria.extend(path.equilibria.iter().filter(counts).map(|equilibrium| {
            let verdict = verdict_before_choice(equilibrium, statics.model());
            GoalEquilibrium { sign, equilibrium: equilibrium.clone(), verdict }
        }));
        paths.push(SignedPath { sign, path });
        if interrupted || !grew {
            break;
        }
    }
    equilibria.sort_by(|a, b| {
        let order = |found: &GoalEquilibrium| {
            let beyond = found.verdict == Verdict::BeyondHumanRange;
            let ranks = (!found.equilibrium.is_on_erect_branch(), beyond);
            (ranks, found.equilibrium.factor.abs())
        };
        let ((a, near), (b, far)) = (order(a), order(b));
        a.cmp(&b).then(near.total_cmp(&far))
    });
    if let Some(first) = equilibria.first_mut().filter(|found| found.verdict == Verdict::Later) {
        first.verdict = Verdict::Reached;
    }
    let ending = if interrupted {
        PathEnding::Interrupted
    } else if is_folded(statics.model(), goal, &equilibria, &paths) {
        PathEnding::BeyondHumanRange
    } else {
        ending(&equilibria, &paths)
    };
    Ok(Response { goal, largest_factor, ending, paths, equilibria })
}

/// The verdict on a shape that is not chosen.
fn verdict_before_choice(equilibrium: &Equilibrium, erect: &SpineModel) -> Verdict {
    if equilibrium.limit_points > 0 {
        Verdict::BeyondLimitPoint
    } else if equilibrium.branch_points > 0 {
        Verdict::BeyondBranchPoint
    } else if equilibrium.deformed.beyond_human_range(erect).is_some() {
        Verdict::BeyondHumanRange
    } else {
        Verdict::Later
    }
}

/// Whether the given loads fold the spine beyond the human range before they act in full.
fn is_folded(
    erect: &SpineModel,
    goal: Goal,
    equilibria: &[GoalEquilibrium],
    paths: &[SignedPath],
) -> bool {
    let folds = |signed: &SignedPath| {
        let last = signed.path.points.last();
        signed.path.ending == PathEnding::Unreachable
            && last.is_some_and(|point| point.deformed.beyond_human_range(erect).is_some())
    };
    goal == Goal::FullLoad && equilibria.is_empty() && paths.iter().any(folds)
}

fn ending(equilibria: &[GoalEquilibrium], paths: &[SignedPath]) -> PathEnding {
    // Where a path did not converge at smaller loads, an earlier equilibrium may be missed.
    let lost_before = |factor: f64| {
        let lost = paths.iter().filter(|signed| !signed.path.is_complete);
        lost.filter_map(|signed| signed.path.points.last()).any(|last| last.factor.abs() < factor)
    };
    match equilibria {
        [first, ..] if lost_before(first.equilibrium.factor.abs()) => PathEnding::NotConverged,
        [first, ..] if first.verdict == Verdict::BeyondLimitPoint => PathEnding::LimitPoint,
        [first, ..] if first.verdict == Verdict::BeyondBranchPoint => PathEnding::BranchPoint,
        [first, ..] if first.verdict == Verdict::BeyondHumanRange => PathEnding::BeyondHumanRange,
        [_] => PathEnding::Converged,
        [_, _, ..] => PathEnding::SeveralEquilibria,
        [] => {
            let ended = |ending| paths.iter().any(|signed| signed.path.ending == ending);
            // The most doubtful ending of any path is the ending of the search.
            [PathEnding::NotConverged, PathEnding::LimitPoint, PathEnding::BranchPoint]
                .into_iter()
                .find(|&doubtful| ended(doubtful))
                .unwrap_or(PathEnding::Unreachable)
        }
    }
}
