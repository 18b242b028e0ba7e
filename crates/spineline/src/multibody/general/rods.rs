//! The equations of a rod: six, in the poses of its two vertebrae and in the reaction.

use super::loading::{Rod, RodPose};
use super::wrench::{Spatial, SpatialMatrix, first, second, spatial};
use crate::multibody::Support;
use crate::spatial::{Angle, Mat3, Vec3};

/// The vertebrae that a rod joins, and the wrench on the upper one.
pub(super) struct RodState<'s> {
    /// Midpoints of the lower and of the upper vertebra.
    pub midpoints: [&'s Vec3; 2],
    /// Their axes.
    pub axes: [&'s Mat3; 2],
    pub reaction: &'s Spatial,
    /// The prescribed pose at the factor as it is.
    pub wanted: RodPose,
    /// Lateral spring of the joint above the lower vertebra, in N·mm/rad.
    pub lateral_nmm_per_rad: f64,
    /// Whether the rod's pose changes with the factor that varies.
    pub varies: bool,
}

/// Six equations: by how much each is not met, and how that changes.
///
/// A free support leaves all six components of the pose to the rod. In a frontal support the rod prescribes the first
/// [`prescribed`] rows; the others say that the rod does not act where the support does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RodEquations {
    pub errors: Spatial,
    /// Change with the factor that varies.
    pub rates: Spatial,
    /// Change with the twist of the upper vertebra beside the lower one.
    pub by_relative: SpatialMatrix,
    /// Change with a twist of both.
    pub by_both: SpatialMatrix,
    /// Change with the reaction.
    pub by_reaction: SpatialMatrix,
    /// Distance (mm) and angle (rad) from the prescribed pose.
    pub gap: (f64, f64),
}

/// How many components of a pose a rod prescribes, the others being the support's.
pub(super) const fn prescribed(support: Support) -> usize {
    match support {
        Support::Free => 6,
        Support::Frontal => FRONTAL,
    }
}

/// Tilt of the upper vertebra and its lateral place.
const FRONTAL: usize = 2;

impl RodEquations {
    pub(super) fn zeros() -> Self {
        Self {
            errors: Spatial::zeros(),
            rates: Spatial::zeros(),
            by_relative: SpatialMatrix::identity(),
            by_both: SpatialMatrix::zeros(),
            by_reaction: SpatialMatrix::zeros(),
            gap: (0.0, 0.0),
        }
    }

    pub(super) fn of(support: Support, rod: &Rod, state: &RodState<'_>) -> Self {
        match support {
            Support::Free => Self::free(rod, state),
            Support::Frontal => Self::frontal(rod, state),
        }
    }

    /// The whole pose: the errors are the twist from where the rod wants its upper vertebra to where that is.
    fn free(rod: &Rod, state: &RodState<'_>) -> Self {
        let ([low_mm, high_mm], [low, high]) = (state.midpoints, state.axes);
        let wanted_mm = low_mm + low * state.wanted.place_mm;
        let wanted_axes = low * state.wanted.axes;
        let turn = rotation_vector(&(high * wanted_axes.transpose()));
        let shift = high_mm - wanted_mm;
        let mut equations = Self::zeros();
        equations.errors = spatial(&turn, &(shift - turn.cross(high_mm)));
        equations.gap = (shift.norm(), turn.norm());
        if state.varies {
            let (turn, shift) = (low * rod.turn_rad, low * rod.shift_mm);
            equations.rates = -spatial(&turn, &(shift - turn.cross(&wanted_mm)));
        }
        equations
    }

    /// Tilt and lateral place in the lower vertebra's axes; no force along its x and z, no moment but about the axis of the tilt.
    ///
    /// With `z` the cranial axis of the upper vertebra and `w` square to the prescribed one in the lower vertebra's frontal
    /// plane, the tilt is met where `z·w = 0`, and the work of a moment on that is along `z × w`.
    fn frontal(rod: &Rod, state: &RodState<'_>) -> Self {
        let ([low_mm, p], [low, high]) = (state.midpoints, state.axes);
        let [x, y, up]: [Vec3; 3] = [0, 1, 2].map(|axis| low.column(axis).into());
        let z: Vec3 = high.column(2).into();
        let wanted: Vec3 = state.wanted.axes.column(2).into();
        let across = Vec3::new(0.0, -wanted.z, wanted.y).normalize();
        let w = low * across;
        let (moment, force) = (first(state.reaction), second(state.reaction));
        let moment = moment - p.cross(&force);
        let apart = y.dot(&(p - low_mm)) - state.wanted.place_mm.y;
        // In the units of the other rows: rad and mm.
        let per_moment = 1.0 / state.lateral_nmm_per_rad;
        let per_force = per_moment * state.wanted.place_mm.norm_squared();

        let mut equations = Self::zeros();
        equations.gap = (apart.abs(), z.dot(&w).abs());
        equations.by_relative = SpatialMatrix::zeros();
        equations.prescribe(0, z.dot(&w), &spatial(&z.cross(&w), &Vec3::zeros()));
        equations.prescribe(1, apart, &spatial(&p.cross(&y), &y));
        for (row, axis) in [(2, &x), (3, &up)] {
            let by_both = spatial(&axis.cross(&force), &Vec3::zeros());
            equations.errors[row] = per_force * axis.dot(&force);
            let by_reaction = spatial(&Vec3::zeros(), axis);
            equations.set(row, per_force, &Spatial::zeros(), &by_both, &by_reaction);
        }
        for (row, axis, is_upper) in [(4, &z, true), (5, &w, false)] {
            let lever = force.cross(axis);
            let by_place = spatial(&-p.cross(&lever), &-lever);
            let by_turn = spatial(&axis.cross(&moment), &Vec3::zeros());
            let by_relative = if is_upper { by_place + by_turn } else { by_place };
            equations.errors[row] = per_moment * axis.dot(&moment);
            let by_reaction = spatial(axis, &p.cross(axis));
            equations.set(row, per_moment, &by_relative, &(by_place + by_turn), &by_reaction);
        }
        if state.varies {
            let turned = Vec3::x().cross(&across) * rod.turn_rad.x;
            equations.rates[0] = z.dot(&(low * turned));
            equations.rates[1] = -rod.shift_mm.y;
        }
        equations
    }

    fn prescribe(&mut self, row: usize, error: f64, by_relative: &Spatial) {
        self.errors[row] = error;
        self.by_relative.set_row(row, &by_relative.transpose());
    }

    fn set(
        &mut self,
        row: usize,
        scale: f64,
        by_relative: &Spatial,
        by_both: &Spatial,
        by_reaction: &Spatial,
    ) {
        self.by_relative.set_row(row, &(by_relative * scale).transpose());
        self.by_both.set_row(row, &(by_both * scale).transpose());
        self.by_reaction.set_row(row, &(by_reaction * scale).transpose());
    }
}

/// The rotation vector of a rotation, to rounding near the identity too (an arc cosine would leave 1e-8).
fn rotation_vector(rotation: &Mat3) -> Vec3 {
    let sine = Vec3::new(
        rotation[(2, 1)] - rotation[(1, 2)],
        rotation[(0, 2)] - rotation[(2, 0)],
        rotation[(1, 0)] - rotation[(0, 1)],
    ) * 0.5;
    let size = sine.norm();
    if size < 1e-12 {
        return sine;
    }
    sine * (Angle::from_sin_cos(size, 0.5 * (rotation.trace() - 1.0)).rad() / size)
}
