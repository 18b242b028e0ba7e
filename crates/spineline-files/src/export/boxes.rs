//! The box that stands for a vertebral body, with sides of 1 about its centre.

use spineline::spatial::Vec3;

/// The corners: bits 0, 1 and 2 of the index are the upper end along x, y and z.
pub(super) fn corners() -> [Vec3; 8] {
    std::array::from_fn(|i| Vec3::from_fn(|axis, _| if i & (1 << axis) == 0 { -0.5 } else { 0.5 }))
}

/// The sides, +x, −x, +y, −y, +z and −z, each by its corners counter-clockwise as seen from outside.
pub(super) const SIDES: [[usize; 4]; 6] =
    [[1, 3, 7, 5], [0, 4, 6, 2], [2, 6, 7, 3], [0, 1, 5, 4], [4, 5, 7, 6], [0, 2, 3, 1]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_side_faces_outwards() {
        for (i, side) in SIDES.into_iter().enumerate() {
            let [a, b, c, d] = side.map(|corner| corners()[corner]);
            let mut outwards = Vec3::zeros();
            outwards[i / 2] = if i % 2 == 0 { 1.0 } else { -1.0 };
            assert_eq!((b - a).cross(&(c - b)), outwards);
            assert_eq!(a + c, b + d, "one plane, in a ring");
            assert_eq!((a + c).component_mul(&outwards.abs()), outwards);
        }
    }
}
