//! A shape of a loaded spine, and its derivatives.

use crate::spatial::{Angle, Frontal, Mat3, Vec3};

/// Parameters of the derivatives of a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// The magnitude of the load: force along a line; or component 0, 1 or 2 of `(fy, fz, mx)`.
    Load(usize),
    /// The natural logarithm of a group's lateral stiffness.
    LogStiffness(usize),
}

/// The vertebrae under load.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deformed {
    /// Midpoints in `G`.
    pub midpoints_mm: Vec<Vec3>,
    /// Axes in `G`.
    pub axes: Vec<Mat3>,
    /// Hinge angles of every joint about x, y and z, in rad.
    pub hinges_rad: Vec<[f64; 3]>,
}

impl Deformed {
    /// Midpoints as a frontal film would show them.
    #[must_use]
    pub fn location(&self, vertebra: usize) -> Frontal {
        let midpoint = self.midpoints_mm[vertebra];
        Frontal::new(midpoint.y, midpoint.z)
    }

    /// Tilt of a vertebra as a frontal film would show it.
    #[must_use]
    pub fn tilt(&self, vertebra: usize) -> Angle {
        let cranial = self.axes[vertebra].column(2);
        Angle::from_sin_cos(-cranial[1], cranial[2])
    }

    /// Lateral tilt of the line L4→T2.
    #[must_use]
    pub fn lateral_tilt(&self) -> Angle {
        self.location(self.midpoints_mm.len() - 1).lateral_tilt()
    }

    /// The largest hinge angle.
    #[must_use]
    pub fn largest_hinge_rad(&self) -> f64 {
        self.hinges_rad.iter().flatten().fold(0.0, |most: f64, angle| most.max(angle.abs()))
    }
}

/// An equilibrium and its derivatives.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Solution {
    /// The vertebrae.
    pub deformed: Deformed,
    /// Per parameter and vertebra: derivative of the midpoint (mm per unit of the parameter).
    pub midpoint_rates: Vec<Vec<Vec3>>,
    /// Per parameter and vertebra: rotation vector per unit of the parameter.
    pub turn_rates: Vec<Vec<Vec3>>,
    /// Whether the place of a load that moves with T2 was found.
    pub converged: bool,
    /// Distance of T2's midpoint from the line on which a load at T2 was put.
    pub residual_mm: f64,
    /// Room for derivatives by the place of a load at T2, which only its search needs.
    pub(super) spare_rates: Vec<Vec<Vec3>>,
}

impl Solution {
    /// Derivative of a vertebra's tilt.
    #[must_use]
    pub fn tilt_rate(&self, parameter: usize, vertebra: usize) -> f64 {
        let cranial: Vec3 = self.deformed.axes[vertebra].column(2).into();
        let change = self.turn_rates[parameter][vertebra].cross(&cranial);
        // tilt = atan2(-cy, cz)
        (cranial.y * change.z - cranial.z * change.y)
            / (cranial.y * cranial.y + cranial.z * cranial.z)
    }

    /// Derivative of a vertebra's location on a frontal film.
    #[must_use]
    pub fn location_rate(&self, parameter: usize, vertebra: usize) -> Frontal {
        let rate = self.midpoint_rates[parameter][vertebra];
        Frontal::new(rate.y, rate.z)
    }

    /// Derivative of the lateral tilt of the line L4→T2.
    #[must_use]
    pub fn lateral_tilt_rate(&self, parameter: usize) -> f64 {
        let top = self.deformed.midpoints_mm.len() - 1;
        let place = self.deformed.location(top);
        place.cross(self.location_rate(parameter, top)) / place.dot(place)
    }

    /// How fast every joint turns, in rad per unit of the parameter.
    pub(super) fn joint_rates(&self, parameter: usize) -> impl Iterator<Item = Vec3> {
        self.turn_rates[parameter].windows(2).map(|pair| pair[1] - pair[0])
    }

    /// The fastest hinge, in rad per unit of the parameter.
    #[must_use]
    pub fn fastest_turn(&self, parameter: usize) -> f64 {
        self.joint_rates(parameter).map(|rate| rate.norm()).fold(0.0, f64::max)
    }
}
