use std::ops::ControlFlow;

use super::balance::{Balance, Factors};
use super::equilibrium::EquilibriumPath;
use super::loading::{Loading, LoadingError, Timing};
use super::newton::{Closing, Newton, NewtonEnding};
use super::path::{Goal, OnPoint, PathOptions, Stage, Walk};
use crate::multibody::follow::{PathEnding, Stop, follow};
use crate::multibody::{Deformed, ForceSign, SpineModel, Support};
use crate::spatial::{Mat3, Vec3};

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
///
/// ```
/// use spineline::anatomy::SagittalProfile;
/// use spineline::measure::{TiltRule, measure_film};
/// use spineline::multibody::{
///     BodyLoad, GeneralStatics, Goal, Loading, PathOptions, SpineModel, Support,
/// };
/// use spineline::spatial::{Mat3, Vec3};
/// use spineline::warning::Warnings;
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let case = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case;
/// let erect = measure_film(&case.films[0], TiltRule::default(), &mut Warnings::default())?;
/// let straight = SagittalProfile { turns_deg: [0.0; 14], axial_deg: [0.0; 15] };
/// let model = SpineModel::from_outline(&erect, &straight);
/// let springs = vec![Mat3::from_diagonal(&Vec3::new(1.5e5, 1.5e5, 3e5)); model.joints.len()];
/// let statics = GeneralStatics::new(&model, springs, Support::Frontal)?;
/// // In the frontal plane a moment on T2 turns every joint by moment over stiffness.
/// let moment = BodyLoad::Moment { moment_nmm: Vec3::new(1500.0, 0.0, 0.0) };
/// let loading = Loading::single(model.joints.len(), moment);
/// let path = statics.follow(&loading, Goal::FullLoad, &PathOptions::default())?;
/// let found = path.result().ok_or("no equilibrium")?;
/// assert!(found.deformed.hinges_rad.iter().all(|hinges| (hinges[0] - 0.01).abs() < 1e-9));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct GeneralStatics<'a> {
    model: &'a SpineModel,
    stiffness: Vec<Mat3>,
    support: Support,
}

/// Newton's buffers for one spine under one loading: made once, used for many starts and factors.
#[derive(Debug, Clone, PartialEq)]
pub struct NewtonWork(pub(super) Newton);

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
    /// [`SpringError`]: a stiffness that is not symmetric and positive definite, or not one per joint.
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

    /// The unloaded model.
    #[must_use]
    pub const fn model(&self) -> &SpineModel {
        self.model
    }

    pub(super) fn balance<'b>(&'b self, loading: &'b Loading) -> Balance<'b> {
        Balance { model: self.model, stiffness: &self.stiffness, support: self.support, loading }
    }

    /// Buffers for [`GeneralStatics::solve_near`], at the erect spine.
    ///
    /// # Errors
    /// [`LoadingError`] where a load cannot be applied to this spine.
    pub fn work(&self, loading: &Loading) -> Result<NewtonWork, LoadingError> {
        loading.check(self.model, self.support)?;
        Ok(NewtonWork(Newton::new(&self.balance(loading))))
    }

    /// Equilibrium under a loading whose proportional loads are multiplied by a factor, by Newton from the hinge angles in
    /// `work`; whether hinges and rods balance. No allocation.
    ///
    /// The start must be near: nothing shows which branch was found. `work` must have been made for this loading.
    ///
    /// # Accuracy
    /// Newton stops once a step is below 1e-9 rad, so the error is of the order of its square, and rounding.
    #[must_use]
    pub fn solve_near(&self, loading: &Loading, factor: f64, work: &mut NewtonWork) -> bool {
        let mut factors =
            Factors { constant: 1.0, proportional: factor, varies: Timing::Proportional };
        let report = work.0.correct(&self.balance(loading), &mut factors, &Closing::Factor);
        report.ending == NewtonEnding::Balanced
    }

    /// Follows the branch of equilibria from the erect spine: first while the constant loads are applied and the springs' moments in
    /// the erect posture relax, then as the proportional loads grow.
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

    /// As [`GeneralStatics::follow`], with a callback for every point, which may stop it.
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
            is_complete: false,
        };
        if loading.has_constant_loads() || self.model.is_stressed() {
            let factors = Factors { constant: 0.0, proportional: 0.0, varies: Timing::Constant };
            let once = PathOptions {
                sign: ForceSign::Positive,
                largest_factor: 1.0,
                look_beyond: false,
                ..*options
            };
            let stage = Stage { factors, goal: Goal::FullLoad, options: once };
            let stop = follow(&mut Walk::new(balance, &mut newton, stage, &mut path, on_point));
            path.ending = path.ending(stop);
            let stands = path.result().is_some() && stop != Stop::Interrupted;
            // These shapes do not meet the goal.
            path.equilibria.clear();
            if !stands {
                return Ok(path);
            }
        }
        let factors = Factors { constant: 1.0, proportional: 0.0, varies: Timing::Proportional };
        let stage = Stage { factors, goal, options: *options };
        let stop = follow(&mut Walk::new(balance, &mut newton, stage, &mut path, on_point));
        path.ending = path.ending(stop);
        path.is_complete = !matches!(stop, Stop::Stuck | Stop::Interrupted);
        Ok(path)
    }
}
