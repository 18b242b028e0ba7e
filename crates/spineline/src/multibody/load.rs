use crate::action::LineOfAction;
use crate::spatial::Vec3;

/// A force and its moment about the origin of `G`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// Force.
    pub force_n: Vec3,
    /// Moment about the origin.
    pub moment_nmm: Vec3,
}

impl Wrench {
    /// A force at a point.
    #[must_use]
    pub fn at(point_mm: Vec3, force_n: Vec3) -> Self {
        Self { force_n, moment_nmm: point_mm.cross(&force_n) }
    }
}

/// The load on T2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// A force along a line of action.
    Line {
        /// The line.
        line: LineOfAction,
        /// Sagittal place of a line fixed in space; a line at T2 goes through T2's midpoint.
        depth_mm: f64,
    },
    /// Any force and moment in a frontal plane, fixed in space: the force is `(fy, fz)`, the moment is about +X.
    Frontal {
        /// Sagittal place of the force.
        depth_mm: f64,
    },
}

impl Load {
    /// A load along a line at a given depth.
    #[must_use]
    pub const fn along(line: LineOfAction, depth_mm: f64) -> Self {
        Self::Line { line, depth_mm }
    }

    /// Number of components: one along a line, three in a plane.
    #[must_use]
    pub const fn components(&self) -> usize {
        match self {
            Self::Line { .. } => 1,
            Self::Frontal { .. } => 3,
        }
    }

    /// The wrench per unit of each component, where the film shows the line; zero for components that it has not.
    #[must_use]
    pub fn units_on_film(&self) -> [Wrench; 3] {
        match self {
            Self::Line { line, depth_mm } => {
                let point = Vec3::new(*depth_mm, line.point.y_mm, line.point.z_mm);
                let direction = Vec3::new(0.0, line.direction.y_mm, line.direction.z_mm);
                let none = Wrench { force_n: Vec3::zeros(), moment_nmm: Vec3::zeros() };
                [Wrench::at(point, direction), none, none]
            }
            Self::Frontal { depth_mm } => {
                let point = Vec3::new(*depth_mm, 0.0, 0.0);
                let couple = Wrench { force_n: Vec3::zeros(), moment_nmm: Vec3::x() };
                [Wrench::at(point, Vec3::y()), Wrench::at(point, Vec3::z()), couple]
            }
        }
    }
}
