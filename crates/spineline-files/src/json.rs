//! Reading JSON, with errors that name the place, the value and the nearest known key.

use std::fmt;

use serde::Deserializer;
use serde::de::{DeserializeOwned, IgnoredAny, MapAccess, Visitor};

use crate::FileError;
use crate::json_reason::json_reason;
use crate::keys_once::KeysOnce;
use crate::nearest::nearest;

/// The first two keys of every file.
#[derive(Default)]
struct Header {
    format: Option<String>,
    version: Option<u32>,
    /// Whether both were found, or all keys were read.
    is_read: bool,
}

/// Reads a file of a known format and version.
pub(crate) fn parse<T: DeserializeOwned>(
    text: &str,
    format: &'static str,
    version: u32,
) -> Result<T, FileError> {
    let text = without_mark(text);
    // Serde takes a list of the values of an object for the object.
    if text.trim_start().starts_with('[') {
        return Err(FileError::List { expected: format });
    }
    // The format is checked first: a model given as a case should be named so, and not by unknown keys.
    let header = header_of(text);
    if header.is_read {
        let found = header.format.unwrap_or_default();
        if found != format {
            return Err(FileError::Format { found, expected: format });
        }
        if let Some(found) = header.version.filter(|&found| found != version) {
            return Err(FileError::Version { found, supported: version });
        }
    }
    parse_value(text)
}

/// The format that a file states at its beginning; the rest is not read.
pub(crate) fn format_of(text: &str) -> Option<String> {
    header_of(without_mark(text)).format
}

/// Large files are read no further than their header.
fn header_of(text: &str) -> Header {
    let mut header = Header::default();
    let mut reader = serde_json::Deserializer::from_str(text);
    // Where the visitor stops within an object, the reader takes the rest for an error.
    let _rest = reader.deserialize_map(HeaderVisitor(&mut header));
    header
}

/// Reads an object as far as its `format` and `version`.
struct HeaderVisitor<'a>(&'a mut Header);

impl<'de> Visitor<'de> for HeaderVisitor<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let header = self.0;
        while header.format.is_none() || header.version.is_none() {
            match map.next_key::<String>()?.as_deref() {
                Some("format") => header.format = map.next_value()?,
                Some("version") => header.version = map.next_value()?,
                Some(_) => drop(map.next_value::<IgnoredAny>()?),
                None => break,
            }
        }
        header.is_read = true;
        Ok(())
    }
}

/// The format that a JSON file of this program states in its `format`; for a list of files, the format of the first one. `None` for any
/// other text.
#[must_use]
pub fn file_format(text: &str) -> Option<String> {
    #[derive(serde::Deserialize)]
    struct Listed {
        format: Option<String>,
    }
    let list = || serde_json::from_str::<Vec<Listed>>(without_mark(text)).ok();
    format_of(text).or_else(|| list()?.into_iter().next()?.format)
}

fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Reads any JSON; a mark of the byte order at its beginning is skipped.
///
/// # Errors
/// [`FileError::Syntax`], for a number beyond the largest one too; [`FileError::Value`] for a key that an object has twice.
pub fn parse_json(text: &str) -> Result<serde_json::Value, FileError> {
    parse_value(without_mark(text))
}

/// Reads a part of a file, or a file of another program.
///
/// # Errors
/// As [`parse_json`], and [`FileError::UnknownKey`].
pub fn parse_value<T: DeserializeOwned>(text: &str) -> Result<T, FileError> {
    let once = serde_json::from_str::<KeysOnce>(text);
    // To know the place all the way takes longer than to read, so a file with a fault is read again for its place.
    once.and_then(|_| serde_json::from_str(text)).or_else(|_| {
        parse_with_place::<KeysOnce>(text)?;
        parse_with_place(text)
    })
}

fn parse_with_place<T: DeserializeOwned>(text: &str) -> Result<T, FileError> {
    let mut reader = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize(&mut reader).map_err(explain)?;
    reader.end().map_err(|error| syntax(&error))?;
    Ok(value)
}

fn syntax(error: &serde_json::Error) -> FileError {
    FileError::Syntax { line: error.line(), column: error.column(), reason: json_reason(error) }
}

fn explain(error: serde_path_to_error::Error<serde_json::Error>) -> FileError {
    let path = error.path().to_string();
    let error = error.into_inner();
    let (line, mut reason) = (error.line(), json_reason(&error));
    if reason == "trailing characters" {
        // A list that has all its values ends for `serde_json`, and another value counts as text after it. `KeysOnce` reads all values of
        // a list, so the text has been read as JSON before.
        "more values than expected".clone_into(&mut reason);
    } else if !error.is_data() {
        return syntax(&error);
    }
    // The path of an unknown key ends with the key itself.
    let place =
        |path: &str| if path == "." { "at the top".to_owned() } else { format!("in `{path}`") };
    let quoted: Vec<&str> = reason.split('`').skip(1).step_by(2).collect();
    if reason.starts_with("unknown field") && !quoted.is_empty() {
        let key = quoted[0].to_owned();
        let parent = path.strip_suffix(&key).map_or(path.as_str(), |p| p.trim_end_matches('.'));
        let nearest = nearest(&key, &quoted[1..]);
        let place = place(if parent.is_empty() { "." } else { parent });
        return FileError::UnknownKey { line, place, key, nearest };
    }
    FileError::Value { line, place: place(&path), reason }
}
