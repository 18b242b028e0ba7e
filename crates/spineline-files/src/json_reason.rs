//! Why JSON cannot be read, in words for people: `serde_json` speaks of types of Rust.

use serde_json::error::Category;

/// The reason without the place.
#[must_use]
pub(crate) fn json_reason(error: &serde_json::Error) -> String {
    if error.classify() == Category::Eof {
        return "the text ends before its JSON is complete".to_owned();
    }
    let text = error.to_string();
    let text = text.rsplit_once(" at line ").map_or(text.as_str(), |(reason, _)| reason);
    if let Some(key) = text.strip_prefix("missing field ") {
        return format!("the key {key} is missing");
    }
    if let Some(names) = text.strip_prefix("unknown variant ") {
        return format!("unknown name {names}");
    }
    let mismatch = ["invalid type: ", "invalid value: ", "invalid length "]
        .into_iter()
        .find_map(|kind| text.strip_prefix(kind)?.rsplit_once(", expected "));
    match mismatch {
        Some((found, expected)) => {
            format!("{} where {} is expected", found_words(found), expected_words(expected))
        }
        None => text.to_owned(),
    }
}

fn found_words(found: &str) -> String {
    let number = ["integer ", "floating point ", "boolean "];
    match found {
        "map" => "an object".to_owned(),
        "sequence" => "a list".to_owned(),
        "null" => "`null`".to_owned(),
        text if text.starts_with("string ") => text.replacen("string", "the text", 1),
        length if length.bytes().all(|byte| byte.is_ascii_digit()) => format!("{length} values"),
        other => {
            number.iter().find_map(|kind| other.strip_prefix(kind)).unwrap_or(other).to_owned()
        }
    }
}

fn expected_words(expected: &str) -> String {
    let mut lists = ["an array of length ", "a tuple of size "].into_iter();
    if let Some(length) = lists.find_map(|kind| expected.strip_prefix(kind)) {
        return format!("a list of {length}");
    }
    let words = match expected {
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number from 0",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "f32" | "f64" => "a number",
        "a string" | "string" => "a text",
        "a boolean" => "`true` or `false`",
        "a sequence" => "a list",
        "a map" => "an object",
        "variant identifier" | "string or map" => "a name",
        kind if kind.starts_with("enum ") => "a name",
        kind if kind.starts_with("struct ") || kind.starts_with("internally tagged enum ") => {
            "an object"
        }
        other => other,
    };
    words.to_owned()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::Deserialize;
    use serde::de::DeserializeOwned;

    use super::json_reason;

    #[derive(Debug, Deserialize)]
    struct Point {
        #[serde(rename = "x")]
        _x: f64,
    }

    fn reason<T: DeserializeOwned>(text: &str) -> String {
        json_reason(&serde_json::from_str::<T>(text).err().expect(text))
    }

    #[test]
    fn reasons_name_what_json_has() {
        assert_eq!(
            reason::<u32>("\"a, expected b\""),
            "the text \"a, expected b\" where a whole number from 0 is expected"
        );
        assert_eq!(reason::<u32>("-1"), "`-1` where a whole number from 0 is expected");
        assert_eq!(reason::<i64>("1.5"), "`1.5` where a whole number is expected");
        assert_eq!(reason::<f64>("null"), "`null` where a number is expected");
        assert_eq!(reason::<String>("[]"), "a list where a text is expected");
        assert_eq!(reason::<Vec<f64>>("{}"), "an object where a list is expected");
        assert_eq!(reason::<[f64; 2]>("[1]"), "1 values where a list of 2 is expected");
        assert_eq!(reason::<bool>("0"), "`0` where `true` or `false` is expected");
        assert_eq!(reason::<BTreeMap<String, f64>>("true"), "`true` where an object is expected");
        assert_eq!(reason::<Point>("3"), "`3` where an object is expected");
        assert_eq!(reason::<Point>("{}"), "the key `x` is missing");
        assert_eq!(reason::<Point>("{\"x\": 1"), "the text ends before its JSON is complete");
    }
}
