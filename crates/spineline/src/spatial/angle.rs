use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

use serde::{Deserialize, Serialize};

use crate::anatomy::Side;
use crate::number::fixed;

/// A plane angle, right-handed about +X, +Y or +Z, held in radians.
///
/// In the frontal plane a positive angle is to the patient's **right**; users see a side, never a sign.
/// Degrees are used only at input and output: [`Angle::from_deg`], [`Angle::deg`].
///
/// ```
/// use spineline::{anatomy::Side, spatial::Angle};
/// let tilt = Angle::from_deg(-12.5);
/// assert_eq!(tilt.side(), Some(Side::Left));
/// assert_eq!(tilt.leaning(), "12.5° left");
/// ```
/// Serialised in radians, for computations that are read back to the last bit; results for people state degrees.
///
/// A bare number is not an angle:
/// ```compile_fail
/// let tilt: spineline::spatial::Angle = 12.5;
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default, Serialize, Deserialize)]
pub struct Angle(f64);

impl Angle {
    /// The zero angle.
    pub const ZERO: Self = Self(0.0);

    /// Creates an angle from radians.
    #[must_use]
    pub const fn from_rad(rad: f64) -> Self {
        Self(rad)
    }

    /// Creates an angle from degrees.
    #[must_use]
    pub const fn from_deg(deg: f64) -> Self {
        Self(deg * (std::f64::consts::PI / 180.0))
    }

    /// Creates an angle from degrees of at most half a turn; `None` for others, which name a direction in a second way.
    #[must_use]
    pub fn within_half_turn(deg: f64) -> Option<Self> {
        (-180.0..=180.0).contains(&deg).then(|| Self::from_deg(deg))
    }

    /// The angle whose sine and cosine are proportional to the arguments, in (-π, π].
    #[must_use]
    pub fn from_sin_cos(sin: f64, cos: f64) -> Self {
        Self(sin.atan2(cos))
    }

    /// Radians.
    #[must_use]
    pub const fn rad(self) -> f64 {
        self.0
    }

    /// Degrees, for people and files.
    #[must_use]
    pub const fn deg(self) -> f64 {
        self.0 * (180.0 / std::f64::consts::PI)
    }

    /// Magnitude.
    #[must_use]
    pub const fn abs(self) -> Self {
        Self(self.0.abs())
    }

    /// The same direction in (-π, π].
    #[must_use]
    pub fn wrapped(self) -> Self {
        if self.0 > -std::f64::consts::PI && self.0 <= std::f64::consts::PI {
            return self;
        }
        Self::from_sin_cos(self.0.sin(), self.0.cos())
    }

    /// The side of a frontal angle; `None` for zero.
    #[must_use]
    pub fn side(self) -> Option<Side> {
        if self.0 > 0.0 {
            Some(Side::Right)
        } else if self.0 < 0.0 {
            Some(Side::Left)
        } else {
            None
        }
    }

    /// Degrees with these decimal places, such as `12.5°`.
    #[must_use]
    pub fn text(self, places: usize) -> String {
        format!("{}°", fixed(self.deg(), places))
    }

    /// The side of a frontal angle in words with one decimal place; `None` where it rounds to zero.
    #[must_use]
    pub fn shown_side(self) -> Option<Side> {
        self.side().filter(|_| self.abs().to_string() != "0.0°")
    }

    /// A frontal angle in words, such as `12.5° left`.
    #[must_use]
    pub fn leaning(self) -> String {
        let size = self.abs();
        self.shown_side().map_or_else(|| size.to_string(), |side| format!("{size} {side}"))
    }
}

impl fmt::Display for Angle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(f.precision().unwrap_or(1)))
    }
}

impl Add for Angle {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Angle {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Neg for Angle {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Mul<f64> for Angle {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self(self.0 * factor)
    }
}
