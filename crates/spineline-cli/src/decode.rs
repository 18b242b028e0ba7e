//! Films decoded in a process of their own, which is this program once more: they may be made to do harm.

use std::path::PathBuf;

use spineline_films::{ChildLimits, FilmError, FilmFile, decode_in_child, serve_child};

use crate::failure::{Ending, Failure};

/// The parent's side.
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

/// The child's side: `spineline decode-film`, which is not for people.
pub fn run() -> Result<Ending, Failure> {
    let mut output = std::io::stdout().lock();
    serve_child(&mut std::io::stdin().lock(), &mut output)
        .map_err(|error| Failure::write("the decoder's answer", &error))?;
    Ok(Ending::Done)
}
