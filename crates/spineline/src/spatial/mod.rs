//! Angles, typed points and small vectors: the only place of degree conversion and of `atan2`.
//!
//! # Frames
//! - `I`, image: column to the right, row down, in pixels: [`Pixel`].
//! - `G`, global: origin at the midpoint of L4, +X anterior, +Y to the patient's left, +Z cranial along L4's own axis.
//!   Its frontal plane holds [`Frontal`] points, in millimetres.
//! - `V`, vertebra and `J`, joint: [`Vec3`] and [`Mat3`], named by their frame where they are not in `G`.

mod angle;
mod frontal;
mod orientation;
mod sine;
mod words;

pub use angle::Angle;
pub use frontal::{Frontal, Pixel};
pub use orientation::Orientation;
pub use sine::sin_cos;
pub use words::{displacement_words, moment_words, rotation_words, sideways_words, vector_words};

/// A vector of three components; millimetres, newtons or newton millimetres as its name says.
pub type Vec3 = nalgebra::Vector3<f64>;
/// A rotation or another 3 × 3 matrix; a rotation's columns are the axes of the frame that it describes.
pub type Mat3 = nalgebra::Matrix3<f64>;

/// Right-handed rotation about the first axis.
#[must_use]
pub fn rotation_x(angle: Angle) -> Mat3 {
    let (s, c) = angle.rad().sin_cos();
    Mat3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

/// Right-handed rotation about the second axis.
#[must_use]
pub fn rotation_y(angle: Angle) -> Mat3 {
    let (s, c) = angle.rad().sin_cos();
    Mat3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)
}

/// Right-handed rotation about the third axis.
#[must_use]
pub fn rotation_z(angle: Angle) -> Mat3 {
    let (s, c) = angle.rad().sin_cos();
    Mat3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}
