//! Rotations as the formats write them, exact to rounding for every rotation.

use spineline::spatial::{Angle, Mat3, Vec3};

/// Unit quaternion, scalar first.
pub(super) fn quaternion(r: &Mat3) -> [f64; 4] {
    let (x, y, z) = (r[(0, 0)], r[(1, 1)], r[(2, 2)]);
    // Four times the square of each component; the largest one is safe to divide by.
    let squares = [1.0 + x + y + z, 1.0 + x - y - z, 1.0 - x + y - z, 1.0 - x - y + z];
    let largest = (0..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let (a, b, c) = (r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let (xy, xz, yz) = (r[(1, 0)] + r[(0, 1)], r[(0, 2)] + r[(2, 0)], r[(2, 1)] + r[(1, 2)]);
    let s = squares[largest];
    let products = match largest {
        0 => [s, a, b, c],
        1 => [a, s, xy, xz],
        2 => [b, xy, s, yz],
        _ => [c, xz, yz, s],
    };
    let length = products.iter().map(|p| p * p).sum::<f64>().sqrt();
    products.map(|p| p / length)
}

/// Angles in rad of turns about x, then the new y, then the new z.
pub(super) fn body_xyz(r: &Mat3) -> Vec3 {
    let about_x = Angle::from_sin_cos(-r[(1, 2)], r[(2, 2)]);
    let (s, c) = about_x.rad().sin_cos();
    let about_y = Angle::from_sin_cos(r[(0, 2)], c * r[(2, 2)] - s * r[(1, 2)]);
    let about_z = Angle::from_sin_cos(c * r[(1, 0)] + s * r[(2, 0)], c * r[(1, 1)] + s * r[(2, 1)]);
    Vec3::new(about_x.rad(), about_y.rad(), about_z.rad())
}

/// Roll, pitch and yaw in rad: turns about the fixed x, then y, then z.
pub(super) fn roll_pitch_yaw(r: &Mat3) -> Vec3 {
    -body_xyz(&r.transpose())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use spineline::spatial::{rotation_x, rotation_y, rotation_z};

    /// Rounding of a few products.
    const ROUNDING: f64 = 4e-15;

    fn samples() -> Vec<Mat3> {
        let angles = [-3.1, -FRAC_PI_2, -0.4, 0.0, 1e-9, 0.7, FRAC_PI_2, 3.0];
        let turn = |f: fn(Angle) -> Mat3, a: f64| f(Angle::from_rad(a));
        let mut all = Vec::new();
        for a in angles {
            for b in angles {
                for c in angles {
                    all.push(turn(rotation_x, a) * turn(rotation_y, b) * turn(rotation_z, c));
                }
            }
        }
        all
    }

    #[test]
    fn a_quaternion_rotates_axes_like_its_matrix() {
        for r in samples() {
            let [w, x, y, z] = quaternion(&r);
            assert!((w * w + x * x + y * y + z * z - 1.0).abs() < ROUNDING, "no unit quaternion");
            let v = Vec3::new(x, y, z);
            for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
                let turned = axis + 2.0 * w * v.cross(&axis) + 2.0 * v.cross(&v.cross(&axis));
                assert!((turned - r * axis).norm() < ROUNDING, "{r}");
            }
        }
    }

    #[test]
    fn euler_angles_round_trip_also_at_right_angles() {
        let turn = |f: fn(Angle) -> Mat3, a: f64| f(Angle::from_rad(a));
        for r in samples() {
            let a = body_xyz(&r);
            let body = turn(rotation_x, a.x) * turn(rotation_y, a.y) * turn(rotation_z, a.z);
            assert!((body - r).norm() < ROUNDING, "{r}");
            let a = roll_pitch_yaw(&r);
            let fixed = turn(rotation_z, a.z) * turn(rotation_y, a.y) * turn(rotation_x, a.x);
            assert!((fixed - r).norm() < ROUNDING, "{r}");
        }
    }
}
