//! Numbers: their mean, and their text for people. Messages, reports and the program's own texts write numbers by these functions.

use serde::{Deserialize, Deserializer};

/// Normal quantile of a two-sided 95 % interval.
pub(crate) const NORMAL_975: f64 = 1.959_963_984_540_054;

/// Mean of some values; `None` without a value.
#[must_use]
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.into_iter().fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// Text in place of a missing number.
#[must_use]
pub fn none() -> String {
    "–".to_owned()
}

/// The sign of a negative number in text.
const MINUS: &str = "−";
/// Keeps a number and its unit on one line.
pub const NO_BREAK: char = '\u{a0}';

/// From here on a number has its exponent instead of all its digits.
const SCIENTIFIC_FROM: f64 = 1e12;

/// A number with its decimal places, such as `−0.17`; `–` for a value that is not finite. A number with more than twelve digits before the
/// point has its exponent.
#[must_use]
pub fn fixed(value: f64, places: usize) -> String {
    if !value.is_finite() {
        return none();
    }
    if value.abs() >= SCIENTIFIC_FROM {
        return scientific(value, places);
    }
    let text = format!("{value:.places$}");
    match text.strip_prefix('-') {
        None => text,
        Some(size) if is_zero(size) => size.to_owned(),
        Some(size) => format!("{MINUS}{size}"),
    }
}

/// A difference: as [`fixed`], with a plus sign above zero.
#[must_use]
pub fn signed(value: f64, places: usize) -> String {
    let text = fixed(value, places);
    if value.is_finite() && value > 0.0 && !is_zero(&text) { format!("+{text}") } else { text }
}

/// A very small or very large number with its exponent, such as `4.0e−13`; `–` for a value that is not finite.
#[must_use]
pub fn scientific(value: f64, places: usize) -> String {
    if !value.is_finite() {
        return none();
    }
    // A negative zero plus zero is zero.
    format!("{:.places$e}", value + 0.0).replace('-', MINUS)
}

/// A number rounded to significant digits: the double next to the decimal number, and zero without a sign.
#[must_use]
pub fn significant(value: f64, digits: usize) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value + 0.0;
    }
    let places = digits as i32 - 1 - value.abs().log10().floor() as i32;
    // A double holds these powers of ten exactly.
    if (0..=22).contains(&places) {
        let power = 10_f64.powi(places);
        return (value * power).round() / power;
    }
    let places = digits - 1;
    format!("{value:.places$e}").parse().unwrap_or(value)
}

/// A mean with its standard deviation, such as `2.90 ± 0.64`.
#[must_use]
pub fn with_sd(mean: f64, sd: f64, places: usize) -> String {
    format!("{} ± {}", fixed(mean, places), fixed(sd, places))
}

/// The two ends of an interval, such as `−0.17 to 2.08`.
#[must_use]
pub fn interval([low, high]: [f64; 2], places: usize) -> String {
    format!("{} to {}", fixed(low, places), fixed(high, places))
}

/// A p value for a sentence, such as `= 0.0312` and `< 0.0001`: never zero.
#[must_use]
pub fn probability(p: f64) -> String {
    if p < 1e-4 { "< 0.0001".to_owned() } else { format!("= {}", fixed(p, 4)) }
}

/// A p value for a cell, such as `0.0312` and `< 0.0001`; `–` where the test was not made.
#[must_use]
pub fn p_value(p: Option<f64>) -> String {
    p.map_or_else(none, |p| probability(p).trim_start_matches("= ").to_owned())
}

/// A ratio with two digits, or with all digits before the point, such as `0.59 ×` and `121 ×`.
#[must_use]
pub fn times(ratio: f64) -> String {
    let magnitude = if ratio > 0.0 { ratio.log10().floor() } else { 0.0 };
    with_unit(&fixed(ratio, (1.0 - magnitude).max(0.0) as usize), "×")
}

/// A number and its unit on one line, such as `3.3 %`.
#[must_use]
pub fn with_unit(number: &str, unit: &str) -> String {
    format!("{number}{NO_BREAK}{unit}")
}

/// Reads a number that may be infinite: JSON writes it as `null`.
///
/// # Errors
/// If the value is neither a number nor `null`.
pub fn or_infinite<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
}

fn is_zero(size: &str) -> bool {
    size.bytes().all(|byte| matches!(byte, b'0' | b'.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_its_places_whatever_its_last_bits() {
        assert_eq!(with_unit(&fixed(100.0 * 0.033, 1), "%"), "3.3\u{a0}%");
        assert_eq!([fixed(-1e300, 1), fixed(999_999_999_999.0, 1)], ["−1.0e300", "999999999999.0"]);
        assert_eq!(fixed(1.0 / 3.0, 4), "0.3333");
        assert_eq!(fixed(998.0, 0), "998");
    }

    #[test]
    fn significant_digits_equal_the_decimal_text_at_every_size() {
        for value in [
            std::f64::consts::PI,
            -0.1 - 0.2,
            1e-300 / 3.0,
            2e300 / 3.0,
            999_999_999_999.9,
            1e-13 / 7.0,
            123_456_789_012_345.0,
        ] {
            let text: f64 = format!("{value:.9e}").parse().expect("a number");
            assert_eq!(significant(value, 10).to_bits(), text.to_bits(), "{value}");
        }
        assert_eq!(significant(-0.0, 10).to_bits(), 0.0_f64.to_bits());
    }

    #[test]
    fn a_negative_number_has_a_minus_sign_and_no_hyphen() {
        assert_eq!(fixed(-0.17, 2), "−0.17");
        assert_eq!(signed(-4.8, 2), "−4.80");
        assert_eq!(signed(1.37, 2), "+1.37");
        assert_eq!(interval([-5.41, -4.19], 2), "−5.41 to −4.19");
        assert_eq!(with_sd(-2.904, 0.641, 2), "−2.90 ± 0.64");
    }

    #[test]
    fn zero_has_no_sign() {
        for tiny in [0.0, -0.0, -0.004, 0.004] {
            assert_eq!((fixed(tiny, 2), signed(tiny, 2)), ("0.00".to_owned(), "0.00".to_owned()));
        }
        assert_eq!(interval([-0.004, 0.37], 2), "0.00 to 0.37");
    }

    #[test]
    fn an_exponent_has_a_minus_sign_and_no_hyphen() {
        assert_eq!(scientific(4.04e-13, 1), "4.0e−13");
        assert_eq!(scientific(-1_234_000.0, 2), "−1.23e6");
        assert_eq!(scientific(-0.0, 0), "0e0");
    }

    #[test]
    fn what_is_missing_is_a_dash() {
        for missing in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!((fixed(missing, 2), signed(missing, 0)), ("–".to_owned(), "–".to_owned()));
            assert_eq!(scientific(missing, 2), "–");
        }
        assert_eq!((p_value(None), p_value(Some(f64::NAN))), ("–".to_owned(), "–".to_owned()));
    }

    #[test]
    fn a_ratio_has_two_digits() {
        let shown = [0.0112, 0.588, 1.0, 1.7, 26.4, 121.0].map(times);
        assert_eq!(
            shown,
            ["0.011", "0.59", "1.0", "1.7", "26", "121"].map(|text| with_unit(text, "×"))
        );
        assert_eq!(times(f64::NAN), with_unit("–", "×"));
    }
}
