//! Radiographs are decoded in a child process with limits, because a hostile file may attack the decoder.

use std::path::{Path, PathBuf};

use spineline_films::intake::{IntakeError, IntakeLimits, Place, read, read_plain};
use spineline_films::{ChildLimits, FilmError, FilmFile, decode_in_child};

use super::failure::Failure;

/// Decodes films by calling this program again as `spineline decode-film`.
pub struct Decoder {
    program: PathBuf,
}

impl Decoder {
    pub fn new() -> Result<Self, Failure> {
        let program = std::env::current_exe().map_err(|error| {
            Failure::internal(format!("this program cannot find itself: {error}"))
        })?;
        Ok(Self { program })
    }

    pub fn decode(&self, bytes: Vec<u8>) -> Result<FilmFile, FilmError> {
        decode_in_child(&self.program, &["decode-film"], bytes, &ChildLimits::default())
    }
}

/// The content of a film's file that the user names, which may be a pipe.
pub fn film_bytes(path: &Path) -> Result<Vec<u8>, IntakeError> {
    read(&Place::File(path.to_owned()), &IntakeLimits::default())
}

/// The content of a film's file that a case names, which is not a pipe.
pub fn case_film_bytes(path: &Path) -> Result<Vec<u8>, IntakeError> {
    read_plain(path, &IntakeLimits::default())
}
