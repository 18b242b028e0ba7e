//! JSON of other programs: unknown keys are ignored.

use serde::de::DeserializeOwned;

use super::LandmarkError;

pub(super) fn parse_foreign<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, LandmarkError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut reader = serde_json::Deserializer::from_slice(bytes);
    let value = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let path = error.path().to_string();
        let error = error.into_inner();
        let text = error.to_string();
        let reason = text.rsplit_once(" at line ").map_or(text.as_str(), |(reason, _)| reason);
        let at = if path == "." { String::new() } else { format!(", in `{path}`") };
        LandmarkError::Syntax {
            at: format!("line {}, column {}{at}", error.line(), error.column()),
            reason: reason.to_owned(),
        }
    })?;
    reader.end().map_err(|error| LandmarkError::Syntax {
        at: format!("line {}, column {}", error.line(), error.column()),
        reason: "something follows the end of the JSON".to_owned(),
    })?;
    Ok(value)
}

/// The first levels of a JSON file, to tell what it is.
#[derive(serde::Deserialize)]
pub(super) struct Outline {
    pub format: Option<serde::de::IgnoredAny>,
    pub markups: Option<serde::de::IgnoredAny>,
    pub shapes: Option<serde::de::IgnoredAny>,
    pub annotations: Option<serde::de::IgnoredAny>,
    pub midlines: Option<serde::de::IgnoredAny>,
}
