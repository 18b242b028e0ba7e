//! JSON of other programs: unknown keys are ignored.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{DeserializeOwned, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use spineline_files::{FileError, decode_text, parse_value};

use super::LandmarkError;

/// Reads JSON in UTF-8 or UTF-16. `NaN`, which programs write for missing values, counts as `null`. `Infinity` is read as a text, which
/// the reader of a number refuses with its place.
pub(super) fn parse_foreign<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, LandmarkError> {
    let text =
        decode_text(bytes).ok_or_else(|| LandmarkError::Encoding { at: "the JSON".to_owned() })?;
    parse_text(&text).or_else(|error| match with_json_numbers(&text) {
        Some(text) => parse_text(&text),
        None => Err(error),
    })
}

fn parse_text<T: DeserializeOwned>(text: &str) -> Result<T, LandmarkError> {
    parse_value(text).map_err(|error| match error {
        FileError::Syntax { line, column, reason } => {
            LandmarkError::Syntax { at: format!("line {line}, column {column}"), reason }
        }
        FileError::Value { line, place, reason } => {
            LandmarkError::Syntax { at: format!("line {line}, {place}"), reason }
        }
        FileError::UnknownKey { line, place, key, .. } => LandmarkError::Syntax {
            at: format!("line {line}, {place}"),
            reason: format!("unknown key `{key}`"),
        },
        other => other.into(),
    })
}

/// The text with `null` for every `NaN` outside of quotes, and quotes around every `Infinity`; `None` without any.
fn with_json_numbers(text: &str) -> Option<String> {
    const WORDS: [(&str, &str); 4] = [
        ("-Infinity", "\"-Infinity\""),
        ("Infinity", "\"Infinity\""),
        ("NaN", "null"),
        ("nan", "null"),
    ];
    let mut clean = String::with_capacity(text.len());
    let (mut rest, mut found) = (text, false);
    while let Some(first) = rest.chars().next() {
        let length = match WORDS.into_iter().find(|(word, _)| rest.starts_with(word)) {
            Some((word, written)) => {
                clean.push_str(written);
                found = true;
                rest = rest.get(word.len()..).unwrap_or_default();
                continue;
            }
            None if first == '"' => quoted(rest),
            None => first.len_utf8(),
        };
        let (own, after) = rest.split_at_checked(length).unwrap_or((rest, ""));
        clean.push_str(own);
        rest = after;
    }
    found.then_some(clean)
}

/// Length of the text in quotes at the beginning, with its quotes.
fn quoted(text: &str) -> usize {
    let mut escaped = false;
    for (place, letter) in text.char_indices().skip(1) {
        match letter {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return place + 1,
            _ => {}
        }
    }
    text.len()
}

/// The keys of a JSON file, which show its kind: of the object, or of the first object of a list.
#[derive(Debug, Default)]
pub(super) struct Outline {
    pub is_list: bool,
    pub keys: Vec<String>,
    /// Keys of the first value of an object.
    pub of_first: Vec<String>,
}

impl Outline {
    pub fn has(&self, key: &str) -> bool {
        self.keys.iter().any(|own| own == key)
    }
}

impl<'de> Deserialize<'de> for Outline {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OutlineVisitor)
    }
}

struct OutlineVisitor;

impl<'de> Visitor<'de> for OutlineVisitor {
    type Value = Outline;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object or a list")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Outline, A::Error> {
        let mut found = Outline::default();
        while let Some(key) = map.next_key::<String>()? {
            if found.keys.is_empty() {
                found.of_first = map.next_value::<Keys>()?.0;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
            found.keys.push(key);
        }
        Ok(found)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Outline, A::Error> {
        let first = list.next_element::<Keys>()?;
        while list.next_element::<IgnoredAny>()?.is_some() {}
        let keys = first.map(|keys| keys.0).unwrap_or_default();
        Ok(Outline { is_list: true, keys, of_first: Vec::new() })
    }
}

/// The keys of an object; empty for other values.
struct Keys(Vec<String>);

impl<'de> Deserialize<'de> for Keys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Any {
            Object(BTreeMap<String, IgnoredAny>),
            Other(IgnoredAny),
        }
        Ok(Self(match Any::deserialize(deserializer)? {
            Any::Object(object) => object.into_keys().collect(),
            Any::Other(_) => Vec::new(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keys_of_objects_and_of_first_objects_are_found() {
        let outline = |text: &str| serde_json::from_str::<Outline>(text).expect(text);
        let object = outline(r#"{"a": {"b": [1], "c": 2}, "d": 3}"#);
        assert!(!object.is_list && object.keys == ["a", "d"] && object.of_first == ["b", "c"]);
        let list = outline(r#"[{"b": 1}, 2, [3]]"#);
        assert!(list.is_list && list.has("b") && !list.has("a"));
        assert!(outline("[]").is_list && outline("{}").keys.is_empty());
        assert!(serde_json::from_str::<Outline>("3").is_err());
    }

    #[test]
    fn nan_becomes_null_and_infinity_a_text_outside_of_quotes() {
        let text = r#"{"a": [NaN, -Infinity, Infinity, nan], "NaN\"NaN": "Infinity"}"#;
        let clean = r#"{"a": [null, "-Infinity", "Infinity", null], "NaN\"NaN": "Infinity"}"#;
        assert_eq!(with_json_numbers(text).as_deref(), Some(clean));
        assert_eq!(with_json_numbers(r#"{"a": "NaN"}"#), None);
    }
}
