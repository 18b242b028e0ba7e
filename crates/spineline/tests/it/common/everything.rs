//! A crooked chain under every kind of load at once, as it is, mirrored or moved.

use spineline::multibody::{BodyLoad, LoadItem, Loading, Rod, SpineModel, Timing};
use spineline::spatial::{Mat3, Vec3};

use super::Draw;

/// A spine, its springs and its loads.
#[derive(Debug, Clone)]
pub struct Problem {
    pub model: SpineModel,
    pub stiffness: Vec<Mat3>,
    pub loading: Loading,
}

pub fn draw_vector(draw: &mut Draw, size: f64) -> Vec3 {
    Vec3::from_fn(|_, _| draw.between(-size, size))
}

fn draw_rotation(draw: &mut Draw, size: f64) -> Mat3 {
    nalgebra::Rotation3::new(draw_vector(draw, size)).into_inner()
}

pub fn draw_spine(draw: &mut Draw, joints: usize) -> SpineModel {
    let upright = |i: usize| Vec3::new(0.0, 0.0, 28.0 * i as f64);
    let midpoints = (0..=joints)
        .map(|i| if i == 0 { Vec3::zeros() } else { upright(i) + draw_vector(draw, 8.0) })
        .collect();
    let axes = (0..=joints).map(|_| draw_rotation(draw, 0.3)).collect();
    let centres: Vec<Vec3> =
        (0..joints).map(|_| Vec3::new(-15.0, 0.0, 13.0) + draw_vector(draw, 4.0)).collect();
    SpineModel::from_poses(midpoints, axes, &centres)
}

/// Springs that couple the hinges of a joint.
pub fn draw_springs(draw: &mut Draw, joints: usize) -> Vec<Mat3> {
    let spring = |draw: &mut Draw| {
        let root = Mat3::from_fn(|_, _| draw.between(-1.0, 1.0));
        (root * root.transpose() + Mat3::identity()) * 1.2e5
    };
    (0..joints).map(|_| spring(draw)).collect()
}

/// One load of every kind.
pub fn draw_loads(draw: &mut Draw) -> [BodyLoad; 7] {
    let point_in_vertebra_mm = draw_vector(draw, 25.0);
    [
        BodyLoad::ForceOnLine {
            force_n: draw_vector(draw, 40.0),
            point_mm: draw_vector(draw, 200.0),
        },
        BodyLoad::ForceAtPoint { force_n: draw_vector(draw, 40.0), point_in_vertebra_mm },
        BodyLoad::FollowerForce {
            force_in_vertebra_n: draw_vector(draw, 40.0),
            point_in_vertebra_mm,
        },
        BodyLoad::Moment { moment_nmm: draw_vector(draw, 4000.0) },
        BodyLoad::FollowerMoment { moment_in_vertebra_nmm: draw_vector(draw, 4000.0) },
        BodyLoad::Pad {
            point_in_vertebra_mm,
            direction: draw_vector(draw, 1.0).normalize(),
            n_per_mm: 3.0,
            advance_mm: 12.0,
        },
        BodyLoad::Strap {
            point_in_vertebra_mm,
            anchor_mm: Vec3::new(150.0, 200.0, 300.0),
            n_per_mm: 2.0,
            shortening_mm: 15.0,
        },
    ]
}

/// A rod over four joints, which shortens what it spans: a chain that is nearly stretched has little to give.
pub fn draw_rod(draw: &mut Draw) -> Rod {
    let (shift, turn_rad) = (draw_vector(draw, 1.5), draw_vector(draw, 0.05));
    let shift_mm = Vec3::new(shift.x, shift.y, -2.0 - shift.z.abs());
    Rod { inferior: 2, superior: 6, shift_mm, turn_rad, timing: Timing::Proportional }
}

impl Problem {
    /// Every kind of load, constant and proportional by turns.
    pub fn draw(draw: &mut Draw, joints: usize) -> Self {
        let loads = draw_loads(draw).into_iter().enumerate();
        let items = loads.map(|(i, load)| LoadItem {
            vertebra: 1 + (i * 5) % joints,
            load,
            timing: if i % 2 == 0 { Timing::Proportional } else { Timing::Constant },
        });
        let items = items.collect();
        Self {
            model: draw_spine(draw, joints),
            stiffness: draw_springs(draw, joints),
            loading: Loading { items, rods: Vec::new() },
        }
    }

    /// The same with a rod.
    pub fn with_rod(mut self, draw: &mut Draw) -> Self {
        self.loading.rods.push(draw_rod(draw));
        self
    }

    /// What a mirror in the sagittal plane shows: y → -y. Moments and turns are axial, and the hinges x and z turn the
    /// other way; axes stay right-handed, so that `left` is left again.
    pub fn mirrored(&self) -> Self {
        let mirror = Mat3::from_diagonal(&Vec3::new(1.0, -1.0, 1.0));
        let axial = -mirror;
        self.mapped(&mirror, &axial, &Vec3::zeros(), &mirror, |k| axial * k * axial)
    }

    /// The whole problem turned about the origin and then shifted.
    pub fn moved(&self, turn: &Mat3, shift: &Vec3) -> Self {
        self.mapped(turn, turn, shift, &Mat3::identity(), |k| *k)
    }

    /// With polar and axial vectors mapped in space, and what is given in a vertebra's axes.
    fn mapped(
        &self,
        polar: &Mat3,
        axial: &Mat3,
        shift: &Vec3,
        inside: &Mat3,
        stiffness: impl Fn(&Mat3) -> Mat3,
    ) -> Self {
        let midpoints = self.model.midpoints_mm.iter().map(|place| polar * place + shift).collect();
        let axes = self.model.axes.iter().map(|axes| polar * axes * inside).collect();
        let joints = &self.model.joints;
        let centres: Vec<Vec3> =
            joints.iter().map(|joint| inside * joint.centre_in_inferior_mm).collect();
        // The axial map in a vertebra's axes.
        let inside_axial = inside * inside.determinant();
        let map =
            |load: &BodyLoad| mapped_load(load, (polar, axial, shift), (inside, &inside_axial));
        let items =
            self.loading.items.iter().map(|item| LoadItem { load: map(&item.load), ..*item });
        let rods = self.loading.rods.iter().map(|rod| Rod {
            shift_mm: inside * rod.shift_mm,
            turn_rad: inside_axial * rod.turn_rad,
            ..*rod
        });
        Self {
            loading: Loading { items: items.collect(), rods: rods.collect() },
            model: SpineModel::from_poses(midpoints, axes, &centres),
            stiffness: self.stiffness.iter().map(stiffness).collect(),
        }
    }
}

fn mapped_load(
    load: &BodyLoad,
    (polar, axial, shift): (&Mat3, &Mat3, &Vec3),
    (inside, inside_axial): (&Mat3, &Mat3),
) -> BodyLoad {
    match *load {
        BodyLoad::ForceOnLine { force_n, point_mm } => {
            BodyLoad::ForceOnLine { force_n: polar * force_n, point_mm: polar * point_mm + shift }
        }
        BodyLoad::ForceAtPoint { force_n, point_in_vertebra_mm } => BodyLoad::ForceAtPoint {
            force_n: polar * force_n,
            point_in_vertebra_mm: inside * point_in_vertebra_mm,
        },
        BodyLoad::FollowerForce { force_in_vertebra_n, point_in_vertebra_mm } => {
            BodyLoad::FollowerForce {
                force_in_vertebra_n: inside * force_in_vertebra_n,
                point_in_vertebra_mm: inside * point_in_vertebra_mm,
            }
        }
        BodyLoad::Moment { moment_nmm } => BodyLoad::Moment { moment_nmm: axial * moment_nmm },
        BodyLoad::FollowerMoment { moment_in_vertebra_nmm } => BodyLoad::FollowerMoment {
            moment_in_vertebra_nmm: inside_axial * moment_in_vertebra_nmm,
        },
        BodyLoad::Pad { point_in_vertebra_mm, direction, n_per_mm, advance_mm } => BodyLoad::Pad {
            point_in_vertebra_mm: inside * point_in_vertebra_mm,
            direction: polar * direction,
            n_per_mm,
            advance_mm,
        },
        BodyLoad::Strap { point_in_vertebra_mm, anchor_mm, n_per_mm, shortening_mm } => {
            BodyLoad::Strap {
                point_in_vertebra_mm: inside * point_in_vertebra_mm,
                anchor_mm: polar * anchor_mm + shift,
                n_per_mm,
                shortening_mm,
            }
        }
    }
}
