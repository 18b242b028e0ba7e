//! Numbers of JSON from other programs: missing values have many spellings, and a whole number may have decimals.

use std::fmt;

use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use spineline_files::{is_no_number, whole_number};

/// A number, or a missing one: `null`, `NaN`, an empty text. A number may be written as a text. It may be infinite: the reader of its
/// place refuses it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Loose(pub Option<f64>);

impl<'de> Deserialize<'de> for Loose {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LooseVisitor)
    }
}

struct LooseVisitor;

impl Visitor<'_> for LooseVisitor {
    type Value = Loose;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Loose, E> {
        Ok(Loose((!value.is_nan()).then_some(value)))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Loose, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Loose, E> {
        self.visit_f64(value as f64)
    }

    fn visit_unit<E: Error>(self) -> Result<Loose, E> {
        Ok(Loose(None))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Loose, E> {
        if is_no_number(text) {
            return Ok(Loose(None));
        }
        match text.trim().parse::<f64>() {
            Ok(value) => self.visit_f64(value),
            Err(_) => Err(E::invalid_value(Unexpected::Str(text), &self)),
        }
    }
}

/// A whole number of pixels or repeats from 0, also written as `1.0` or as a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Whole(pub u32);

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let found = serde_json::Value::deserialize(deserializer)?;
        let text = found.as_str().map_or_else(|| found.to_string(), str::to_owned);
        whole_number(&text)
            .map(Self)
            .ok_or_else(|| D::Error::custom(format!("`{text}` is not a whole number from 0")))
    }
}

/// An identifier: a number, also with decimals of zero, or a text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Id(pub String);

impl<'de> Deserialize<'de> for Id {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let found = serde_json::Value::deserialize(deserializer)?;
        let text = found.as_str().map_or_else(|| found.to_string(), str::to_owned);
        Ok(Self(text.strip_suffix(".0").map_or(text.clone(), str::to_owned)))
    }
}

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&super::names::shown(&self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_and_whole_numbers_are_read_in_every_spelling() {
        let read = |text: &str| serde_json::from_str::<Vec<Loose>>(text).expect(text);
        assert_eq!(read(r#"[1, 2.5, "3", -4]"#), [1.0, 2.5, 3.0, -4.0].map(|x| Loose(Some(x))));
        assert_eq!(read(r#"[null, "", "NaN", "-"]"#), [Loose(None); 4]);
        let infinite = [f64::INFINITY, f64::NEG_INFINITY].map(|x| Loose(Some(x)));
        assert_eq!(read(r#"["inf", "-Infinity"]"#), infinite);
        for bad in ["[[1]]", "[true]", "[\"left\"]"] {
            assert!(serde_json::from_str::<Vec<Loose>>(bad).is_err(), "{bad}");
        }
        let whole = |text: &str| serde_json::from_str::<Whole>(text).ok().map(|whole| whole.0);
        assert_eq!(
            ["1", "1.0", "\"2\"", "1.5", "-1", "[1]"].map(whole),
            [Some(1), Some(1), Some(2), None, None, None]
        );
        let ids = serde_json::from_str::<Vec<Id>>(r#"[7, 7.0, "7", "b"]"#).expect("identifiers");
        assert_eq!(ids, ["7", "7", "7", "b"].map(|text| Id(text.to_owned())));
    }
}
