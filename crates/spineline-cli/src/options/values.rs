//! Values that options take, parsed from text.

use spineline::anatomy::{Named, Posture};
use spineline_store::Name;

use crate::run::failure::Failure;

/// A posture by its key, with `-` or `_`.
///
/// # Errors
/// If there is no such posture.
pub fn posture(text: &str) -> Result<Posture, String> {
    let wanted = text.replace('-', "_");
    Posture::from_key(&wanted).ok_or_else(|| {
        format!(
            "unknown posture `{text}`; expected one of {}",
            Posture::ALL.map(Posture::key).join(", ")
        )
    })
}

/// A finite number.
///
/// # Errors
/// If the text is none.
pub fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a number")),
    }
}

/// A number of threads; 0 stands for all cores.
///
/// # Errors
/// If it is not from 0 to 1024.
pub fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(number @ 0..=1024) => Ok(number),
        _ => Err("expected 0 (all cores) to 1024".to_owned()),
    }
}

/// An identifier of a study or of a person in a store.
///
/// # Errors
/// If the text is not allowed as one.
pub fn store_name(text: &str) -> Result<Name, Failure> {
    Name::new(text).map_err(|error| Failure::usage(format!("{error}; {}", error.help())))
}
