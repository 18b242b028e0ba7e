use std::ops::{Add, Mul, Sub};

use serde::{Deserialize, Serialize};

use super::Angle;

/// A place on an image, in files `[column, row]`: column to the right, row down, both in pixels, the centre of the first pixel at (0, 0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Pixel {
    /// Column, to the right.
    pub column_px: f64,
    /// Row, downwards.
    pub row_px: f64,
}

impl Pixel {
    /// A place by column and row.
    ///
    /// Pixels are not millimetres; only [`crate::measure::ImageGeometry::frontal`] turns one into the other:
    /// ```compile_fail
    /// use spineline::spatial::{Frontal, Pixel};
    /// let d = Frontal::new(0.0, 0.0) - Pixel::new(1.0, 2.0);
    /// ```
    #[must_use]
    pub const fn new(column_px: f64, row_px: f64) -> Self {
        Self { column_px, row_px }
    }

    /// Whether both coordinates are numbers.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.column_px.is_finite() && self.row_px.is_finite()
    }
}

impl From<[f64; 2]> for Pixel {
    fn from([column_px, row_px]: [f64; 2]) -> Self {
        Self { column_px, row_px }
    }
}

impl From<Pixel> for [f64; 2] {
    fn from(place: Pixel) -> Self {
        [place.column_px, place.row_px]
    }
}

/// A point or displacement in a frontal plane: `y` to the patient's left, `z` cranial, both in millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Frontal {
    /// To the patient's left.
    pub y_mm: f64,
    /// Cranial.
    pub z_mm: f64,
}

impl Frontal {
    /// A point by its coordinates.
    #[must_use]
    pub const fn new(y_mm: f64, z_mm: f64) -> Self {
        Self { y_mm, z_mm }
    }

    /// The unit vector at the angle `tilt` from the cranial direction; positive to the patient's right.
    #[must_use]
    pub fn leaning(tilt: Angle) -> Self {
        let (s, c) = tilt.rad().sin_cos();
        Self::new(-s, c)
    }

    /// The lateral tilt of this displacement from the cranial direction, in (-π, π]; the inverse of [`Frontal::leaning`].
    #[must_use]
    pub fn lateral_tilt(self) -> Angle {
        Angle::from_sin_cos(-self.y_mm, self.z_mm)
    }

    /// This displacement turned by a right-handed angle about +X.
    #[must_use]
    pub fn rotated(self, angle: Angle) -> Self {
        self.rotated_by(angle.rad().sin_cos())
    }

    /// As [`Frontal::rotated`], by the angle's sine and cosine.
    pub(crate) fn rotated_by(self, sin_cos: (f64, f64)) -> Self {
        let (s, c) = sin_cos;
        Self::new(c * self.y_mm - s * self.z_mm, s * self.y_mm + c * self.z_mm)
    }

    /// Length.
    #[must_use]
    pub fn norm_mm(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// Distance to another point.
    #[must_use]
    pub fn distance_mm(self, other: Self) -> f64 {
        (self - other).norm_mm()
    }

    /// Scalar product.
    #[must_use]
    pub fn dot(self, other: Self) -> f64 {
        self.y_mm * other.y_mm + self.z_mm * other.z_mm
    }

    /// The +X component of the vector product: positive where `other` lies a right-handed turn from `self`.
    #[must_use]
    pub fn cross(self, other: Self) -> f64 {
        self.y_mm * other.z_mm - self.z_mm * other.y_mm
    }

    /// Whether both coordinates are numbers.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.y_mm.is_finite() && self.z_mm.is_finite()
    }
}

impl Add for Frontal {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.y_mm + other.y_mm, self.z_mm + other.z_mm)
    }
}

impl Sub for Frontal {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.y_mm - other.y_mm, self.z_mm - other.z_mm)
    }
}

impl Mul<f64> for Frontal {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::new(self.y_mm * factor, self.z_mm * factor)
    }
}
