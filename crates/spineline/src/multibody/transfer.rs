//! Transfer of axes and wrench from one joint to the next, in the march.

use super::{SpineModel, Wrench};
use crate::spatial::{Mat3, Vec3, sin_cos, small_sin_cos};

/// An axis in `G`, and in the fourth place the force along it.
type Axis = nalgebra::Vector4<f64>;

/// A vertebra's axes, and the wrench about the joint above it in these axes.
///
/// A hinge's angle follows from the moment along its axis. Turned with the axes, the moment need not be taken anew at every
/// hinge's place, so each angle depends only on the angle before it.
pub(super) struct WrenchTransfer {
    axes: [Axis; 3],
    moment_nmm: [f64; 3],
}

impl WrenchTransfer {
    #[inline]
    pub fn new(model: &SpineModel, wrench: &Wrench) -> Self {
        let axes = &model.axes[0];
        let centre = model.midpoints_mm[0] + axes * model.joints[0].centre_in_inferior_mm;
        let moment = wrench.moment_nmm - centre.cross(&wrench.force_n);
        let along = |axes: &Mat3, i: usize| {
            let axis: Vec3 = axes.column(i).into();
            axis.push(axis.dot(&wrench.force_n))
        };
        Self {
            axes: [along(axes, 0), along(axes, 1), along(axes, 2)],
            moment_nmm: axes.tr_mul(&moment).into(),
        }
    }

    /// The axes in `G`.
    #[inline]
    pub fn axes(&self) -> Mat3 {
        let [x, y, z] = &self.axes;
        Mat3::from_columns(&[x.xyz(), y.xyz(), z.xyz()])
    }

    /// Three hinges in series; each turns the axes that come after it. Gives their angles, and their axes in `G`.
    ///
    /// With `SMALL` the axes are right only if all three angles are small.
    #[inline(always)]
    pub fn turn<const SMALL: bool>(&mut self, compliance: &[f64; 3]) -> ([f64; 3], [Vec3; 3]) {
        let Self { axes: [x, y, z], moment_nmm: [mx, my, mz] } = self;
        let (hinge_x, angle_x) = (*x, compliance[0] * *mx);
        turn_pair::<SMALL>(y, z, my, mz, angle_x);
        if compliance[1] == 0.0 && compliance[2] == 0.0 {
            return ([angle_x, 0.0, 0.0], [hinge_x.xyz(), y.xyz(), z.xyz()]);
        }
        let (hinge_y, angle_y) = (*y, compliance[1] * *my);
        turn_pair::<SMALL>(z, x, mz, mx, angle_y);
        let (hinge_z, angle_z) = (*z, compliance[2] * *mz);
        turn_pair::<SMALL>(x, y, mx, my, angle_z);
        ([angle_x, angle_y, angle_z], [hinge_x.xyz(), hinge_y.xyz(), hinge_z.xyz()])
    }

    /// As [`WrenchTransfer::turn`], where the axial spring is unstressed at `ratio` times the lateral angle.
    pub fn turn_coupled(&mut self, compliance: &[f64; 3], ratio: f64) -> ([f64; 3], [Vec3; 3]) {
        let angle_x = coupled_lateral(&self.moment_nmm, compliance, ratio);
        let Self { axes: [x, y, z], moment_nmm: [mx, my, mz] } = self;
        let hinge_x = *x;
        turn_pair::<false>(y, z, my, mz, angle_x);
        let (hinge_y, angle_y) = (*y, compliance[1] * *my);
        turn_pair::<false>(z, x, mz, mx, angle_y);
        let (hinge_z, angle_z) = (*z, ratio * angle_x + compliance[2] * *mz);
        turn_pair::<false>(x, y, mx, my, angle_z);
        ([angle_x, angle_y, angle_z], [hinge_x.xyz(), hinge_y.xyz(), hinge_z.xyz()])
    }

    /// A vector of these axes, in `G`.
    #[inline]
    pub fn in_g(&self, vector: &Vec3) -> Vec3 {
        combine(&self.axes, vector).xyz()
    }

    /// Goes on to the next joint's centre and to the superior vertebra's axes.
    #[inline]
    pub fn pass_on(&mut self, to_next_mm: &Vec3, inferior_from_superior: &Mat3) {
        let [x, y, z] = &self.axes;
        let moment = Vec3::from(self.moment_nmm) - to_next_mm.cross(&Vec3::new(x.w, y.w, z.w));
        self.moment_nmm = inferior_from_superior.tr_mul(&moment).into();
        let column = |i: usize| combine(&self.axes, &inferior_from_superior.column(i).into());
        self.axes = [column(0), column(1), column(2)];
    }
}

/// The lateral angle of a coupled joint under a moment in the axes of its inferior vertebra: the root of
///
/// ```text
/// f(θ) = θ - C_x (m_x + r (m_x sin θ_y + q cos θ_y)),  θ_y = C_y (m_y cos θ + m_z sin θ),  q = m_z cos θ - m_y sin θ
/// ```
///
/// by Newton, kept between bounds of opposite sign.
fn coupled_lateral([mx, my, mz]: &[f64; 3], compliance: &[f64; 3], ratio: f64) -> f64 {
    let size = compliance[0] * Vec3::new(*mx, *my, *mz).norm() * (1.0 + ratio.abs());
    let (mut low, mut high) = (-size, size);
    let mut angle = (compliance[0] * (mx + ratio * mz)).clamp(low, high);
    for _ in 0..60 {
        let (s, c) = sin_cos(angle);
        let (p, q) = (my * c + mz * s, mz * c - my * s);
        let (sy, cy) = sin_cos(compliance[1] * p);
        let value = angle - compliance[0] * (mx + ratio * (mx * sy + q * cy));
        if value > 0.0 {
            high = angle;
        } else {
            low = angle;
        }
        let flexing = compliance[1] * q;
        let slope = 1.0 - compliance[0] * ratio * (mx * cy * flexing - sy * flexing * q - cy * p);
        let newton = angle - value / slope;
        let next = if newton >= low && newton <= high { newton } else { f64::midpoint(low, high) };
        let step = (next - angle).abs();
        angle = next;
        if step <= 1e-15 {
            break;
        }
    }
    angle
}

#[inline]
fn combine([x, y, z]: &[Axis; 3], by: &Vec3) -> Axis {
    x * by.x + y * by.y + z * by.z
}

/// Turns two axes by an angle about the third, `a` towards `b`, and the moments along them.
#[inline(always)]
fn turn_pair<const SMALL: bool>(
    a: &mut Axis,
    b: &mut Axis,
    ma: &mut f64,
    mb: &mut f64,
    angle_rad: f64,
) {
    let (s, c) = if SMALL { small_sin_cos(angle_rad) } else { sin_cos(angle_rad) };
    (*ma, *mb) = (*ma * c + *mb * s, *mb * c - *ma * s);
    (*a, *b) = (*a * c + *b * s, *b * c - *a * s);
}
