//! Numbers for display: a number that is not zero never shows as zero, and one that is not one never as one.

use super::Statistic;
use crate::number::{fixed, none, scientific};

/// A correlation: three decimals, and more where these would say 0 or ±1 of a number that is neither.
///
/// ```
/// use spineline::reliability::shown_coefficient;
/// assert_eq!(shown_coefficient(0.7148), "0.715");
/// assert_eq!(shown_coefficient(0.999_96), "0.99996");
/// assert_eq!(shown_coefficient(0.000_04), "4.0e−5");
/// assert_eq!(shown_coefficient(1.0), "1");
/// ```
#[must_use]
#[expect(clippy::float_cmp, reason = "a number beside 1 must not be shown as 1")]
pub fn shown_coefficient(value: f64) -> String {
    if value == 0.0 || value.abs() == 1.0 {
        return fixed(value, 0);
    }
    if value.abs() < 0.000_5 {
        return scientific(value, 1);
    }
    let rounded = |places: usize| fixed(value, places);
    let is_one = |text: &str| text.trim_start_matches('−').parse() == Ok(1.0);
    // Seventeen places distinguish every double from one.
    (3..17).map(rounded).find(|text| !is_one(text)).unwrap_or_else(|| rounded(17))
}

/// A value with a unit: three digits that count, and a power of ten where it is very small or large.
///
/// ```
/// use spineline::reliability::shown_measure;
/// assert_eq!(shown_measure(0.1234), "0.123");
/// assert_eq!(shown_measure(-12.345), "−12.3");
/// assert_eq!(shown_measure(0.000_012_34), "1.23e−5");
/// assert_eq!(shown_measure(1234.5), "1234");
/// ```
#[must_use]
pub fn shown_measure(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let size = value.abs();
    if !(1e-3..1e6).contains(&size) {
        return scientific(value, 2);
    }
    let places = (2.0 - size.log10().floor()).clamp(0.0, 5.0) as usize;
    fixed(value, places)
}

impl Statistic {
    /// The value with its spread, and its 95 % interval or why it is missing; `None` and the reason without a value.
    #[must_use]
    pub fn shown(&self) -> (Option<String>, String) {
        let shown: fn(f64) -> String =
            if self.kind.has_unit() { shown_measure } else { shown_coefficient };
        match self.outcome {
            Err(reason) => (None, format!("undefined: {reason}")),
            Ok(estimate) => {
                let value = match estimate.sd {
                    Some(sd) => format!("{} ± {}", shown(estimate.value), shown_measure(sd)),
                    None => shown(estimate.value),
                };
                let range = |[low, high]: [f64; 2]| format!("{} to {}", shown(low), shown(high));
                (Some(value), estimate.interval.map_or_else(|_| none(), range))
            }
        }
    }

    /// All in one, such as `0.52 mm (95 % CI 0.41 to 0.70)`; `unit` belongs to the readings.
    #[must_use]
    pub fn words(&self, unit: &str) -> String {
        let (value, range) = self.shown();
        let Some(value) = value else { return range };
        let unit = if self.kind.has_unit() { format!(" {unit}") } else { String::new() };
        if range == none() {
            return format!("{value}{unit}");
        }
        format!("{value}{unit} (95 % CI {range})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back(text: &str) -> f64 {
        text.replace('−', "-").parse().expect("a number")
    }

    #[test]
    fn nothing_but_zero_looks_like_zero_and_nothing_but_one_like_one() {
        for value in [1e-300, -3e-9, 4.9e-4, 5.1e-4, 0.04, 0.999_499, 0.999_999_9, -0.999_96] {
            for text in [shown_coefficient(value), shown_measure(value)] {
                assert!(back(&text) != 0.0, "{value} shows as {text}");
            }
        }
        for value in [0.999_96, 1.000_04, 1.0 - f64::EPSILON, -0.999_999_9] {
            let text = shown_coefficient(value);
            assert!(back(&text).abs() != 1.0, "{value} shows as {text}");
        }
    }
}
