//! The tangent of the equilibrium, and its solution in one pass down and one pass up.
//!
//! The tangent is unsymmetric: a moment that is fixed in space is not conservative. Above a joint everything hangs on the
//! twist of one vertebra, so eliminating joint by joint from T2 downwards costs a few 6 × 3 products per joint instead of
//! a factorisation of a 42 × 42 matrix. Loads that do not depend on the pose leave a triangular tangent: the march.

use super::balance::{Balance, HingeTwists, RowsOf6, State, moment_by_twist};
use super::stability::Signs;
use super::wrench::{Spatial, SpatialMatrix};
use crate::spatial::{Mat3, Vec3};

#[derive(Debug, Clone, PartialEq)]
struct Eliminated {
    /// Turns of the hinges per twist of the inferior vertebra.
    by_twist: RowsOf6,
    /// Inverse of the joint's stiffness with all above it.
    compliance: Mat3,
    /// Change of the wrench from above with the hinges; `None` where it does not depend on the pose.
    wrench_by_hinges: Option<HingeTwists>,
}

/// The tangent of a state, eliminated.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Elimination {
    joints: Vec<Eliminated>,
    twists: Vec<HingeTwists>,
    /// Signs of the pivots.
    pub signs: Signs,
    shares: Vec<Vec3>,
}

impl Elimination {
    pub(super) fn new(joints: usize) -> Self {
        let empty = Eliminated {
            by_twist: RowsOf6::zeros(),
            compliance: Mat3::zeros(),
            wrench_by_hinges: None,
        };
        Self {
            joints: vec![empty; joints],
            twists: vec![HingeTwists::zeros(); joints],
            signs: Signs::UNLOADED,
            shares: vec![Vec3::zeros(); joints],
        }
    }

    /// Eliminates the tangent of an evaluated state; `false` if a pivot is not finite.
    pub(super) fn factor(&mut self, balance: &Balance<'_>, state: &State) -> bool {
        self.signs = Signs::UNLOADED;
        self.twists.clone_from(&state.twists);
        // Change of the wrench from above a joint with the twist of the vertebra above it.
        let mut above: Option<SpatialMatrix> = None;
        for j in (0..self.joints.len()).rev() {
            let twists = &state.twists[j];
            let of_load = state.load_tangents[j + 1].as_ref();
            above = match (above, of_load) {
                (Some(above), Some(load)) => Some(above + load),
                (None, load) => load.copied(),
                (above, None) => above,
            };
            let mut by_twist = moment_by_twist(twists, &state.above[j]);
            let mut stiffness = balance.stiffness[j];
            // Within the joint, a hinge turns the axes of those after it.
            for row in 1..3 {
                for column in 0..row {
                    stiffness[(row, column)] -= (by_twist.row(row) * twists.column(column)).x;
                }
            }
            let wrench_by_hinges = above.as_ref().map(|above| above * twists);
            if let (Some(above), Some(carried)) = (&above, &wrench_by_hinges) {
                stiffness -= twists.tr_mul(carried);
                by_twist += twists.tr_mul(above);
            }
            let Some(compliance) = stiffness.try_inverse() else { return false };
            self.signs.add(&stiffness);
            by_twist = compliance * by_twist;
            if let (Some(above), Some(carried)) = (&mut above, &wrench_by_hinges) {
                *above += carried * by_twist;
            }
            self.joints[j] = Eliminated { by_twist, compliance, wrench_by_hinges };
        }
        true
    }

    /// Turns of the hinges that answer given moments about them.
    pub(super) fn solve(&mut self, moments: impl Fn(usize) -> Vec3, turns: &mut [Vec3]) {
        let mut wrench = Spatial::zeros();
        for (j, joint) in self.joints.iter().enumerate().rev() {
            let mut moment = moments(j);
            match &joint.wrench_by_hinges {
                Some(carried) => {
                    moment += self.twists[j].tr_mul(&wrench);
                    self.shares[j] = joint.compliance * moment;
                    wrench += carried * self.shares[j];
                }
                None => self.shares[j] = joint.compliance * moment,
            }
        }
        let mut twist = Spatial::zeros();
        for (j, joint) in self.joints.iter().enumerate() {
            turns[j] = joint.by_twist * twist + self.shares[j];
            twist += self.twists[j] * turns[j];
        }
    }
}
