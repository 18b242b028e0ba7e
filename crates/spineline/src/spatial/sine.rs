//! Sine and cosine of a small angle.

use nalgebra::Vector2;

/// Up to this angle, in rad, a series is used; a hinge turns by less in a plausible shape of a spine.
const SMALL_RAD: f64 = 0.5;

/// `(-1)ᵏ / (2k+1)!` and `(-1)ᵏ / (2k)!` for k = 1 to 7: the series of sine and cosine after their first terms.
const SERIES: [Vector2<f64>; 7] = [
    Vector2::new(-1.0 / 6.0, -1.0 / 2.0),
    Vector2::new(1.0 / 120.0, 1.0 / 24.0),
    Vector2::new(-1.0 / 5_040.0, -1.0 / 720.0),
    Vector2::new(1.0 / 362_880.0, 1.0 / 40_320.0),
    Vector2::new(-1.0 / 39_916_800.0, -1.0 / 3_628_800.0),
    Vector2::new(1.0 / 6_227_020_800.0, 1.0 / 479_001_600.0),
    Vector2::new(-1.0 / 1_307_674_368_000.0, -1.0 / 87_178_291_200.0),
];

/// Sine and cosine of an angle in rad.
///
/// An equilibrium needs 42 of them one after the other, nearly all of small angles. Up to half a radian they are
/// summed here from their Taylor series, in place and with fewer instructions than the library's take.
///
/// # Accuracy
/// The first omitted terms are 1e-19 of the sine and 1e-18 of the cosine at half a radian, so that the error is
/// rounding: within 2.5e-16 of the true value, relative to it. NaN and larger angles use `f64::sin_cos`.
#[inline]
#[must_use]
pub fn sin_cos(angle_rad: f64) -> (f64, f64) {
    if angle_rad.abs() <= SMALL_RAD { series(angle_rad) } else { angle_rad.sin_cos() }
}

/// Sine and cosine of an angle up to [`SMALL_RAD`].
#[inline]
fn series(angle_rad: f64) -> (f64, f64) {
    let (x, u) = (angle_rad, angle_rad * angle_rad);
    let (u2, u4) = (u * u, (u * u) * (u * u));
    // Added in pairs that do not wait for one another.
    let [a, b, c, d, e, f, g] = SERIES;
    let sums = ((a + b * u) + (c + d * u) * u2) + ((e + f * u) + g * u2) * u4;
    (x + x * u * sums.x, 1.0 + u * sums.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One unit in the last place is 1.1e-16 to 2.2e-16 of a number; the library itself is within half of one.
    const RELATIVE: f64 = 2.5e-16;

    fn assert_agrees(x: f64) {
        let ((s, c), (sine, cosine)) = (sin_cos(x), x.sin_cos());
        assert!((s - sine).abs() <= RELATIVE * sine.abs(), "sine of {x:e}: {s:e}, not {sine:e}");
        assert!(
            (c - cosine).abs() <= RELATIVE * cosine.abs(),
            "cosine of {x:e}: {c}, not {cosine}"
        );
    }

    #[test]
    fn small_angles_agree_with_the_library() {
        let steps = 200_000;
        for i in -steps..=steps {
            assert_agrees(SMALL_RAD * f64::from(i) / f64::from(steps));
        }
        for exponent in 1..300 {
            assert_agrees(0.7 * 10_f64.powi(-exponent));
        }
        assert_agrees(f64::MIN_POSITIVE);
    }

    #[test]
    fn the_edge_of_the_series_is_not_a_step() {
        for x in [SMALL_RAD, -SMALL_RAD] {
            for near in [x.next_down(), x, x.next_up()] {
                assert_agrees(near);
            }
        }
    }

    #[test]
    fn other_angles_are_the_librarys() {
        for x in [0.6, -1.0, 3.0, 1e3, -1e9] {
            assert_eq!(sin_cos(x), x.sin_cos());
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
    }

    #[test]
    fn a_mirrored_angle_has_a_mirrored_sine() {
        for i in 1..1000 {
            let x = 0.001 * f64::from(i);
            let ((s, c), (t, d)) = (sin_cos(x), sin_cos(-x));
            assert_eq!((s, c), (-t, d));
        }
    }
}
