use crate::multibody::{BodyLoad, Deformed, Loading, Timing};
use crate::spatial::Vec3;

/// Action of a load on a spine in one shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ActingKind {
    /// A force; for a strap or pad, what it puts on the vertebra.
    Force(Vec3),
    /// A moment in N·mm.
    Moment(Vec3),
}

/// A load where it acts, in `G`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActingLoad {
    /// Its place among the loads.
    pub item: usize,
    /// Which vertebra.
    pub vertebra: usize,
    /// Where it acts: for a line fixed in space, its point that is nearest to the vertebra's midpoint.
    pub point_mm: Vec3,
    /// What it does.
    pub kind: ActingKind,
}

/// Where and how strongly every load acts on a shape, at a factor of the proportional ones.
///
/// `spring_forces_n` belong to the pads and straps, as in [`crate::multibody::Equilibrium`]; a pad or strap
/// without one is left out.
#[must_use]
pub fn acting_loads(
    loading: &Loading,
    shape: &Deformed,
    factor: f64,
    spring_forces_n: &[(usize, f64)],
) -> Vec<ActingLoad> {
    let items = loading.items.iter().enumerate();
    let acting = items.filter_map(|(number, item)| {
        let vertebra = item.vertebra;
        let (midpoint, axes) = (shape.midpoints_mm[vertebra], shape.axes[vertebra]);
        let place = |in_vertebra: &Vec3| midpoint + axes * in_vertebra;
        let part = match item.timing {
            Timing::Constant => 1.0,
            Timing::Proportional => factor,
        };
        let spring = || spring_forces_n.iter().find(|(of, _)| *of == number).map(|(_, n)| *n);
        let (point_mm, kind) = match &item.load {
            BodyLoad::ForceOnLine { force_n, point_mm } => {
                let size = force_n.norm_squared().max(f64::MIN_POSITIVE);
                let along = (midpoint - point_mm).dot(force_n) / size;
                (point_mm + force_n * along, ActingKind::Force(force_n * part))
            }
            BodyLoad::ForceAtPoint { force_n, point_in_vertebra_mm } => {
                (place(point_in_vertebra_mm), ActingKind::Force(force_n * part))
            }
            BodyLoad::FollowerForce { force_in_vertebra_n, point_in_vertebra_mm } => {
                let force_n = axes * force_in_vertebra_n * part;
                (place(point_in_vertebra_mm), ActingKind::Force(force_n))
            }
            BodyLoad::Moment { moment_nmm } => (midpoint, ActingKind::Moment(moment_nmm * part)),
            BodyLoad::FollowerMoment { moment_in_vertebra_nmm } => {
                (midpoint, ActingKind::Moment(axes * moment_in_vertebra_nmm * part))
            }
            BodyLoad::Pad { point_in_vertebra_mm, direction, .. } => {
                (place(point_in_vertebra_mm), ActingKind::Force(direction * spring()?))
            }
            BodyLoad::Strap { point_in_vertebra_mm, anchor_mm, .. } => {
                let point_mm = place(point_in_vertebra_mm);
                let reach = anchor_mm - point_mm;
                let along = reach / reach.norm().max(f64::MIN_POSITIVE);
                (point_mm, ActingKind::Force(along * spring()?))
            }
        };
        Some(ActingLoad { item: number, vertebra, point_mm, kind })
    });
    acting.collect()
}
