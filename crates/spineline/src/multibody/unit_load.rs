//! A load of unit size on one vertebra, as the components of a load have them.

use super::{BodyLoad, LoadItem};
use crate::spatial::{Angle, Vec3, rotation_x};

/// A load of unit size on one vertebra, in `G`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UnitLoad {
    pub vertebra: usize,
    pub kind: UnitKind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum UnitKind {
    /// A force along a line fixed in space.
    OnLine { point_mm: Vec3, force: Vec3 },
    /// A force of fixed direction at the vertebra's midpoint.
    AtMidpoint { force: Vec3 },
    /// A moment about +X, which no turn of the base changes.
    Couple { moment: f64 },
}

impl UnitLoad {
    /// The load times a factor, seen from a base that is turned by an angle about +X.
    pub fn item(&self, times: f64, base: Angle) -> LoadItem {
        let seen = rotation_x(-base);
        let load = match self.kind {
            UnitKind::OnLine { point_mm, force } => {
                BodyLoad::ForceOnLine { force_n: seen * force * times, point_mm: seen * point_mm }
            }
            UnitKind::AtMidpoint { force } => BodyLoad::at_midpoint(seen * force * times),
            UnitKind::Couple { moment } => {
                BodyLoad::Moment { moment_nmm: Vec3::x() * moment * times }
            }
        };
        LoadItem::proportional(self.vertebra, load)
    }

    /// Its size as a force: a moment counts as a pair of forces at the distance `apart_mm`.
    pub fn force_n(&self, apart_mm: f64) -> f64 {
        match self.kind {
            UnitKind::OnLine { force, .. } | UnitKind::AtMidpoint { force } => force.norm(),
            UnitKind::Couple { moment } => moment.abs() / apart_mm,
        }
    }

    /// Derivative of [`UnitLoad::item`] by the base's angle.
    pub fn turned_items(&self, times: f64, base: Angle) -> Vec<LoadItem> {
        let seen = rotation_x(-base);
        let back = |v: &Vec3| -Vec3::x().cross(v);
        let item = |load: BodyLoad| LoadItem::proportional(self.vertebra, load);
        match self.kind {
            UnitKind::OnLine { point_mm, force } => {
                let (point, force) = (seen * point_mm, seen * force * times);
                let turned = BodyLoad::ForceOnLine { force_n: back(&force), point_mm: point };
                let moved = BodyLoad::Moment { moment_nmm: back(&point).cross(&force) };
                vec![item(turned), item(moved)]
            }
            UnitKind::AtMidpoint { force } => {
                vec![item(BodyLoad::at_midpoint(back(&(seen * force * times))))]
            }
            UnitKind::Couple { .. } => Vec::new(),
        }
    }

    /// Moment about a joint, where a film shows the vertebrae; zero for a joint above.
    pub fn moment_about(&self, joint: usize, centre_mm: &Vec3, midpoints_mm: &[Vec3]) -> Vec3 {
        if self.vertebra <= joint {
            return Vec3::zeros();
        }
        match self.kind {
            UnitKind::OnLine { point_mm, force } => (point_mm - centre_mm).cross(&force),
            UnitKind::AtMidpoint { force } => {
                (midpoints_mm[self.vertebra] - centre_mm).cross(&force)
            }
            UnitKind::Couple { moment } => Vec3::x() * moment,
        }
    }
}
