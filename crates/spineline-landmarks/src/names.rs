//! Names of points, and numbers as text.

use std::fmt;

use spineline::anatomy::Level;
use spineline::measure::{CornerName, is_observer_code};

use super::LandmarkError;

/// Maximum coordinate in pixels or millimetres; a larger one is an error.
const MAX_COORDINATE: f64 = 1e6;

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
        match split.and_then(|(level, corner)| Some((level, parse_corner(corner)?))) {
            // `superior_left` alone would read as `superior` and `left`, but is a corner.
            Some((level, corner)) if parse_corner(text).is_none() => {
                Ok(Self::Corner(parse_level(level, at)?, corner))
            }
            _ => Err(LandmarkError::PointName {
                at: at.to_owned(),
                name: shown(text),
                reason: what_is_missing(text),
            }),
        }
    }
}

/// The missing part of a name: vertebra or corner.
fn what_is_missing(text: &str) -> String {
    let corners = CornerName::ALL.map(CornerName::key).join(", ");
    let (level, corner) = text.split_once(['_', ' ', '-']).unwrap_or((text, ""));
    if parse_corner(text).is_some() {
        return "the vertebra is missing in the name".to_owned();
    }
    match (parse_level(level, "").is_ok(), corner) {
        (true, "") => format!("the corner is missing in the name; the corners are {corners}"),
        (true, corner) => format!("`{}` is not one of the corners {corners}", shown(corner)),
        (false, _) => {
            format!("the vertebra is missing in the name, and the corner, one of {corners}")
        }
    }
}

/// The vertebra of a name.
pub(super) fn parse_level(text: &str, at: &str) -> Result<Level, LandmarkError> {
    let trimmed = text.trim();
    let found = trimmed.parse::<Level>().or_else(|_| {
        // `t12` is read as `T12`; `th12` and `TH12` as `Th12`; `T 5` and `T05` as `T5`.
        let upper = trimmed.to_ascii_uppercase();
        let upper = upper.strip_prefix("TH").map_or(upper.clone(), |number| format!("T{number}"));
        let (region, number) = upper.split_at_checked(1).unwrap_or((&upper, ""));
        format!("{region}{}", number.trim_start().trim_start_matches('0')).parse()
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
            "a thirteenth thoracic vertebra does not fit the model, which counts seventeen from T1 to L5; leave it out, \
             or count again from below",
        ),
        ("L", 6) => Some(
            "a sixth lumbar vertebra does not fit the model, which counts seventeen from T1 to L5; leave it out, or \
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
        Err(LandmarkError::Outside {
            at: at.to_owned(),
            value,
            expected: "a number between -1000000 and 1000000",
            limits: [-MAX_COORDINATE, MAX_COORDINATE],
        })
    }
}

/// The code of an observer, without blanks around it.
pub(super) fn observer(text: &str, at: &str) -> Result<String, LandmarkError> {
    let code = text.trim();
    if is_observer_code(code) {
        return Ok(code.to_owned());
    }
    Err(LandmarkError::Observer { at: at.to_owned(), value: shown(text) })
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
        for text in [
            "T12_inferior_right",
            "Th12_inferior_right",
            "D12-IR",
            "T12 ir",
            " t12_ir ",
            "T12_INFERIOR_RIGHT",
        ] {
            assert_eq!(PointName::parse(text, "here").expect(text), t12);
        }
        assert_eq!(t12.to_string(), "T12_inferior_right");
        assert_eq!(PointName::parse(CREST_LEFT, "here").expect("a crest"), PointName::CrestLeft);
    }

    #[test]
    fn an_unknown_name_is_reported_with_what_it_lacks() {
        for (name, reason) in [
            (
                "T12_superior_lfet",
                "`superior_lfet` is not one of the corners superior_left, superior_right",
            ),
            ("T12", "the corner is missing"),
            ("superior_left", "the vertebra is missing in the name"),
            ("SL", "the vertebra is missing in the name"),
            ("1", "the vertebra is missing in the name, and the corner"),
            ("", "the vertebra is missing in the name, and the corner"),
        ] {
            let error = PointName::parse(name, "point 3").expect_err(name).to_string();
            assert!(error.starts_with("point 3") && error.contains(reason), "{error}");
            assert!(!error.contains("did you mean"), "{error}");
        }
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
