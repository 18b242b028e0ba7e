//! Names of points, and numbers as text.

use std::fmt;

use spineline::anatomy::Level;
use spineline::measure::CornerName;
use spineline_files::nearest;

use super::LandmarkError;

/// Maximum coordinate in pixels or millimetres; a larger one is an error.
const MAX_COORDINATE: f64 = 1e6;
/// Maximum length of an observer's name.
const MAX_NAME: usize = 64;

/// The short name of a corner.
const fn short(corner: CornerName) -> &'static str {
    match corner {
        CornerName::SuperiorLeft => "SL",
        CornerName::SuperiorRight => "SR",
        CornerName::InferiorLeft => "IL",
        CornerName::InferiorRight => "IR",
    }
}

/// The corner of a name, long or short, in any case.
pub(super) fn parse_corner(text: &str) -> Option<CornerName> {
    let text = text.to_ascii_lowercase();
    let is =
        |corner: &CornerName| corner.key() == text || short(*corner).to_ascii_lowercase() == text;
    CornerName::ALL.into_iter().find(is)
}

/// A named point: a corner of a vertebra, or the tip of an iliac crest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PointName {
    Corner(Level, CornerName),
    CrestLeft,
    CrestRight,
}

pub(super) const CREST_LEFT: &str = "iliac_crest_left";
pub(super) const CREST_RIGHT: &str = "iliac_crest_right";

impl fmt::Display for PointName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Corner(level, corner) => write!(f, "{level}_{}", corner.key()),
            Self::CrestLeft => f.write_str(CREST_LEFT),
            Self::CrestRight => f.write_str(CREST_RIGHT),
        }
    }
}

impl PointName {
    /// Reads `T12_superior_left`, and `T12 SL` with a blank, a dash or an underscore.
    pub fn parse(text: &str, at: &str) -> Result<Self, LandmarkError> {
        let text = text.trim();
        match text.to_ascii_lowercase().as_str() {
            CREST_LEFT => return Ok(Self::CrestLeft),
            CREST_RIGHT => return Ok(Self::CrestRight),
            _ => {}
        }
        let split = text.split_once(['_', ' ', '-']);
        let corner = split.and_then(|(_, corner)| parse_corner(corner));
        match (split, corner) {
            (Some((level, _)), Some(corner)) => Ok(Self::Corner(parse_level(level, at)?, corner)),
            _ => Err(LandmarkError::Unknown {
                at: at.to_owned(),
                what: "name of a point",
                nearest: Self::resembling(text),
                name: shown(text),
            }),
        }
    }

    fn resembling(text: &str) -> Option<String> {
        let mut names: Vec<String> = vec![CREST_LEFT.to_owned(), CREST_RIGHT.to_owned()];
        for level in Level::ALL {
            names.extend(CornerName::ALL.map(|corner| Self::Corner(level, corner).to_string()));
        }
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        nearest(&shown(text), &names)
    }
}

/// The vertebra of a name; an unknown name gives the nearest known one.
pub(super) fn parse_level(text: &str, at: &str) -> Result<Level, LandmarkError> {
    let trimmed = text.trim();
    let found = trimmed.parse::<Level>().or_else(|_| {
        // `t12` is as clear as `T12`; `th12` and `TH12` as `Th12`.
        let upper = trimmed.to_ascii_uppercase();
        upper.strip_prefix("TH").map_or(upper.clone(), |number| format!("T{number}")).parse()
    });
    found.map_err(|_| LandmarkError::Vertebra {
        at: at.to_owned(),
        name: shown(trimmed),
        hint: hint(&trimmed.to_ascii_uppercase()),
    })
}

fn hint(name: &str) -> Option<&'static str> {
    let (region, number) = name.split_at_checked(1)?;
    let number = number.parse::<u32>().ok()?;
    match (region, number) {
        ("T", 13) => Some(
            "a thirteenth thoracic vertebra has no place in the model, which counts seventeen from T1 to L5; leave it out, \
             or count again from below",
        ),
        ("L", 6) => Some(
            "a sixth lumbar vertebra has no place in the model, which counts seventeen from T1 to L5; leave it out, or \
             count again from above",
        ),
        ("C", 1..=7) | ("S", 1..=5) => {
            Some("cervical and sacral vertebrae are not supported; remove it")
        }
        _ => None,
    }
}

/// A finite number of plausible size.
pub(super) fn coordinate(value: f64, at: &str) -> Result<f64, LandmarkError> {
    if value.is_finite() && value.abs() <= MAX_COORDINATE {
        Ok(value)
    } else {
        Err(LandmarkError::Value {
            at: at.to_owned(),
            value: value.to_string(),
            expected: "a number between -1000000 and 1000000",
        })
    }
}

/// The name of an observer, checked as a code.
pub(super) fn observer(text: &str, at: &str) -> Result<String, LandmarkError> {
    let refused =
        |expected| Err(LandmarkError::Value { at: at.to_owned(), value: shown(text), expected });
    if text.trim().is_empty() {
        return refused("the code of an observer");
    }
    if text.chars().count() > MAX_NAME || text.chars().any(char::is_control) {
        return refused("a code of at most 64 plain characters");
    }
    Ok(text.to_owned())
}

/// The beginning of a text from a file without control characters, for display.
pub(super) fn shown(text: &str) -> String {
    const MAX_SHOWN: usize = 40;
    let clean: String =
        text.chars().take(MAX_SHOWN).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(MAX_SHOWN).is_some() { clean + "…" } else { clean }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_named_in_full_or_in_short() {
        let t12 = PointName::Corner(Level::T12, CornerName::InferiorRight);
        for text in ["T12_inferior_right", "Th12_inferior_right", "D12-IR", "T12 ir", " t12_ir "] {
            assert_eq!(PointName::parse(text, "here").expect(text), t12);
        }
        assert_eq!(t12.to_string(), "T12_inferior_right");
        assert_eq!(PointName::parse(CREST_LEFT, "here").expect("a crest"), PointName::CrestLeft);
    }

    #[test]
    fn an_unknown_name_is_reported_with_the_nearest_one() {
        let error = PointName::parse("T12_superior_lfet", "point 3").expect_err("misspelt");
        let text = error.to_string();
        assert!(text.contains("point 3") && text.contains("`T12_superior_left`?"), "{text}");
        for (name, part) in [("T13", "thirteenth"), ("L6", "sixth"), ("C7", "cervical")] {
            let text = parse_level(name, "row 2").expect_err(name).to_string();
            assert!(text.contains(name) && text.contains(part), "{text}");
        }
        assert!(parse_level("12", "row 2").is_err() && parse_level("é", "row 2").is_err());
    }

    #[test]
    fn implausible_numbers_are_refused() {
        for value in [f64::NAN, f64::INFINITY, 1e308, -2e6] {
            assert!(coordinate(value, "here").is_err(), "{value}");
        }
        assert_eq!(coordinate(-0.5, "here").expect("a coordinate"), -0.5);
    }
}
