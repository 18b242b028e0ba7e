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
/// If the name is given to a command without a change.
pub fn author(by: Option<&Name>, has_author: bool) -> Result<Name, Failure> {
    match by {
        Some(_) if !has_author => {
            Err(Failure::usage("--by names who makes a change, and this command makes none"))
        }
        Some(name) => Ok(name.clone()),
        None => store_name("cli").map_err(Failure::usage),
    }
}

/// An identifier of a study or of a person in a store. Blanks around it do not count, as after the commas of a list.
///
/// # Errors
/// If the text is not allowed as one.
pub fn store_name(text: &str) -> Result<Name, String> {
    Name::new(text.trim()).map_err(|error| format!("{error}; {}", error.help()))
}
