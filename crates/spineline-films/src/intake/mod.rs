//! Search for films in files, folders and ZIP archives.
//!
//! Nothing is unpacked to disk and no name from an archive becomes a path. Links are not followed, archives within
//! archives are not opened, and every count and size has a limit. Files that are not films are listed with the reason.

mod archive;
mod folder;
mod search;

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::sniff;
pub use search::{Found, IntakeError, IntakeLimits, PassedOver, Place, Reason, Survey};
use search::{Surveyor, head_of, read_limited};

/// Looks for films at the given paths: files, folders with all below them, ZIP archives. `seen` is called with the number of
/// files looked at so far, for a progress bar.
///
/// # Errors
/// [`IntakeError::Missing`] for a given path that does not open, [`IntakeError::TooMany`].
pub fn survey(
    paths: &[PathBuf],
    limits: &IntakeLimits,
    mut seen: impl FnMut(usize),
) -> Result<Survey, IntakeError> {
    let mut surveyor = Surveyor { limits: *limits, looked_at: 0, survey: Survey::default() };
    for path in paths {
        folder::walk(&mut surveyor, path, &mut seen)?;
    }
    Ok(surveyor.survey)
}

/// The bytes of a film. Of other files, only the first bytes are read, by which a decoder names their kind: a device is
/// endless.
///
/// # Errors
/// [`IntakeError::Gone`] where it has changed, or exceeds `limits`.
pub fn read(place: &Place, limits: &IntakeLimits) -> Result<Vec<u8>, IntakeError> {
    let bytes = match place {
        Place::File(path) => {
            let file = File::open(path).map_err(|error| Reason::Unreadable(error.kind()));
            file.and_then(|file| read_film(file, limits.entry_bytes))
        }
        Place::Entry { archive, index } => archive::read(archive, *index, limits),
    };
    bytes.map_err(|reason| IntakeError::Gone { place: place.clone(), reason })
}

/// As [`read`], for a film that a case names: a pipe or a device there could block for ever, and is refused.
///
/// # Errors
/// As [`read`].
pub fn read_plain(path: &Path, limits: &IntakeLimits) -> Result<Vec<u8>, IntakeError> {
    let place = Place::File(path.to_owned());
    match fs::metadata(path) {
        Ok(found) if !found.is_file() && !found.is_dir() => {
            Err(IntakeError::Gone { place, reason: Reason::NotPlain })
        }
        _ => read(&place, limits),
    }
}

/// A whole file if it is a film, otherwise its first bytes.
fn read_film(mut file: File, limit: u64) -> Result<Vec<u8>, Reason> {
    let unreadable = |error: std::io::Error| Reason::Unreadable(error.kind());
    let stated = file.metadata().map_err(unreadable)?;
    if stated.is_file() && stated.len() > limit {
        return Err(Reason::TooLarge { bytes: stated.len(), limit });
    }
    let head = head_of(&mut file).map_err(unreadable)?;
    if sniff(&head).is_err() {
        return Ok(head);
    }
    read_limited(head.as_slice().chain(file), limit)
}
