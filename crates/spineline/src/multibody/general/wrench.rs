use super::loading::{BodyLoad, erect_place_mm};
use crate::multibody::SpineModel;
use crate::spatial::{Mat3, Vec3};

/// A twist (turn; velocity of the body's point at the origin) or a wrench (moment about the origin; force), in `G`.
/// The power of a wrench on a twist is their scalar product.
pub(super) type Spatial = nalgebra::Vector6<f64>;
/// Maps a twist to the change of a wrench.
pub(super) type SpatialMatrix = nalgebra::Matrix6<f64>;

pub(super) fn spatial(first: &Vec3, second: &Vec3) -> Spatial {
    Spatial::new(first.x, first.y, first.z, second.x, second.y, second.z)
}

pub(super) fn first(spatial: &Spatial) -> Vec3 {
    Vec3::new(spatial[0], spatial[1], spatial[2])
}

pub(super) fn second(spatial: &Spatial) -> Vec3 {
    Vec3::new(spatial[3], spatial[4], spatial[5])
}

pub(super) struct Pose<'a> {
    pub midpoint_mm: &'a Vec3,
    pub axes: &'a Mat3,
}

impl Pose<'_> {
    /// Where a point of the vertebra lies.
    fn place(&self, in_vertebra_mm: &Vec3) -> Vec3 {
        self.midpoint_mm + self.axes * in_vertebra_mm
    }
}

/// What a load does to its vertebra as it is.
pub(super) struct LoadWrench {
    /// The wrench.
    pub wrench: Spatial,
    /// Its change with the factor.
    pub rate: Spatial,
    /// Its change with the vertebra's twist; `None` where it does not depend on the pose.
    pub tangent: Option<SpatialMatrix>,
}

/// A force at a point, and how it changes.
struct PointForce {
    point: Vec3,
    force: Vec3,
    /// With the factor.
    rate: Vec3,
    /// With the vertebra's turn.
    by_turn: Option<Mat3>,
    /// With the point's displacement.
    by_place: Option<Mat3>,
}

impl PointForce {
    fn into_wrench(self) -> LoadWrench {
        let Self { point, force, rate, by_turn, by_place } = self;
        // The point's velocity is v - [p] ω.
        let lever = point.cross_matrix();
        let mut force_by_turn = by_turn.unwrap_or_else(Mat3::zeros);
        let force_by_place = by_place.unwrap_or_else(Mat3::zeros);
        force_by_turn -= force_by_place * lever;
        let pulled = force.cross_matrix();
        let mut tangent = SpatialMatrix::zeros();
        let moment_by_turn = pulled * lever + lever * force_by_turn;
        let moment_by_velocity = lever * force_by_place - pulled;
        tangent.fixed_view_mut::<3, 3>(0, 0).copy_from(&moment_by_turn);
        tangent.fixed_view_mut::<3, 3>(0, 3).copy_from(&moment_by_velocity);
        tangent.fixed_view_mut::<3, 3>(3, 0).copy_from(&force_by_turn);
        tangent.fixed_view_mut::<3, 3>(3, 3).copy_from(&force_by_place);
        LoadWrench {
            wrench: spatial(&point.cross(&force), &force),
            rate: spatial(&point.cross(&rate), &rate),
            tangent: Some(tangent),
        }
    }
}

impl BodyLoad {
    /// The wrench on a vertebra in a pose, at a factor of the load.
    pub(super) fn wrench(
        &self,
        pose: &Pose<'_>,
        factor: f64,
        model: &SpineModel,
        vertebra: usize,
    ) -> LoadWrench {
        match self {
            Self::ForceOnLine { force_n, point_mm } => {
                let unit = spatial(&point_mm.cross(force_n), force_n);
                LoadWrench { wrench: unit * factor, rate: unit, tangent: None }
            }
            Self::Moment { moment_nmm } => {
                let unit = spatial(moment_nmm, &Vec3::zeros());
                LoadWrench { wrench: unit * factor, rate: unit, tangent: None }
            }
            Self::ForceAtPoint { force_n, point_in_vertebra_mm } => PointForce {
                point: pose.place(point_in_vertebra_mm),
                force: force_n * factor,
                rate: *force_n,
                by_turn: None,
                by_place: None,
            }
            .into_wrench(),
            Self::FollowerForce { force_in_vertebra_n, point_in_vertebra_mm } => {
                let unit = pose.axes * force_in_vertebra_n;
                let force = unit * factor;
                PointForce {
                    point: pose.place(point_in_vertebra_mm),
                    force,
                    rate: unit,
                    by_turn: Some(-force.cross_matrix()),
                    by_place: None,
                }
                .into_wrench()
            }
            Self::FollowerMoment { moment_in_vertebra_nmm } => {
                let unit = pose.axes * moment_in_vertebra_nmm;
                let mut tangent = SpatialMatrix::zeros();
                tangent.fixed_view_mut::<3, 3>(0, 0).copy_from(&-(unit * factor).cross_matrix());
                let unit = spatial(&unit, &Vec3::zeros());
                LoadWrench { wrench: unit * factor, rate: unit, tangent: Some(tangent) }
            }
            Self::Pad { .. } | Self::Strap { .. } => {
                let spring = self.spring(pose, factor, model, vertebra).expect("a spring");
                PointForce {
                    point: spring.point,
                    force: spring.direction * spring.force_n,
                    rate: spring.direction * spring.rate_n,
                    by_turn: None,
                    by_place: Some(-spring.stiffness),
                }
                .into_wrench()
            }
        }
    }

    /// The force of a spring to ground on a vertebra in a pose; a pad that pulls or a strap that pushes is negative. `None` for other
    /// loads.
    pub(super) fn spring(
        &self,
        pose: &Pose<'_>,
        factor: f64,
        model: &SpineModel,
        vertebra: usize,
    ) -> Option<SpringForce> {
        let ends = |in_vertebra_mm: &Vec3| {
            (pose.place(in_vertebra_mm), erect_place_mm(model, vertebra, in_vertebra_mm))
        };
        Some(match self {
            Self::Pad { point_in_vertebra_mm, direction, n_per_mm, advance_mm } => {
                let (point, erect) = ends(point_in_vertebra_mm);
                let pressed_mm = factor * advance_mm - (point - erect).dot(direction);
                SpringForce {
                    point,
                    direction: *direction,
                    force_n: n_per_mm * pressed_mm,
                    rate_n: n_per_mm * advance_mm,
                    stiffness: direction * direction.transpose() * *n_per_mm,
                }
            }
            Self::Strap { point_in_vertebra_mm, anchor_mm, n_per_mm, shortening_mm } => {
                let (point, erect) = ends(point_in_vertebra_mm);
                let reach = anchor_mm - point;
                let length_mm = reach.norm().max(f64::MIN_POSITIVE);
                let direction = reach / length_mm;
                let stretch_mm = length_mm - (anchor_mm - erect).norm() + factor * shortening_mm;
                let force_n = n_per_mm * stretch_mm;
                let along = direction * direction.transpose();
                SpringForce {
                    point,
                    direction,
                    force_n,
                    rate_n: n_per_mm * shortening_mm,
                    stiffness: along * *n_per_mm
                        + (Mat3::identity() - along) * (force_n / length_mm),
                }
            }
            Self::ForceOnLine { .. }
            | Self::ForceAtPoint { .. }
            | Self::FollowerForce { .. }
            | Self::Moment { .. }
            | Self::FollowerMoment { .. } => return None,
        })
    }
}

/// A spring to ground at work.
pub(super) struct SpringForce {
    /// Where it acts.
    pub point: Vec3,
    /// The way a positive force acts on the vertebra.
    pub direction: Vec3,
    pub force_n: f64,
    /// Its change with the factor.
    pub rate_n: f64,
    /// Minus the change of the force with the point's place.
    pub stiffness: Mat3,
}
