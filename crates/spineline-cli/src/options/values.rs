//! Values that options take, parsed from text.

pub use spineline_files::method_text::{number, posture};
use spineline_store::Name;

use crate::run::failure::Failure;

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

/// Who makes a change, for the log of a store.
///
/// # Errors
/// If the name is not allowed, or is given to a command without a change.
pub fn author(by: Option<&str>, has_author: bool) -> Result<Name, Failure> {
    if by.is_some() && !has_author {
        return Err(Failure::usage("--by names who makes a change, and this command makes none"));
    }
    store_name(by.unwrap_or("cli"))
}

/// An identifier of a study or of a person in a store.
///
/// # Errors
/// If the text is not allowed as one.
pub fn store_name(text: &str) -> Result<Name, Failure> {
    Name::new(text).map_err(|error| Failure::usage(format!("{error}; {}", error.help())))
}
