//! Results that are written piece by piece.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use spineline_files::{InputFile, RunningContent};

use super::staged::{Outputs, failed, name_of};
use super::target::Target;
use crate::run::failure::Failure;
use crate::run::interrupt::Part;

/// A result that is written in pieces; without [`Pieces::keep`] it is removed.
pub struct Pieces<'a> {
    outputs: &'a Outputs,
    path: PathBuf,
    content: RunningContent,
    place: Place,
}

enum Place {
    /// Printed or written to a pipe, all at once.
    Memory(Vec<u8>),
    /// Beside its target.
    File { part: Part, file: PathBuf },
}

impl Outputs {
    /// Begins a result that is made piece by piece, so that it need not fit into memory where it goes to a file.
    ///
    /// # Errors
    /// As [`Outputs::file`], or if it cannot be written.
    pub fn begin(&self, path: &Path) -> Result<Pieces<'_>, Failure> {
        let place = match Target::of(path)? {
            Target::StandardOutput | Target::Into(_) => Place::Memory(Vec::new()),
            Target::File(file) => {
                self.check_replaceable(path, &file, None)?;
                Place::File { part: self.begin_file(path, &file)?, file }
            }
        };
        let content = RunningContent::default();
        Ok(Pieces { outputs: self, path: path.to_owned(), content, place })
    }
}

impl Pieces<'_> {
    pub fn add(&mut self, piece: impl AsRef<[u8]>) -> Result<(), Failure> {
        let piece = piece.as_ref();
        self.content.update(piece);
        match &mut self.place {
            Place::Memory(all) => {
                all.extend_from_slice(piece);
                Ok(())
            }
            Place::File { part, .. } => part.file.write_all(piece).map_err(failed(&self.path)),
        }
    }

    /// Keeps the result for its path, and returns its name and hash.
    pub fn keep(self) -> Result<InputFile, Failure> {
        let Self { outputs, path, content, place } = self;
        let (sha256, places) = content.finish();
        let name = name_of(&path);
        match place {
            Place::Memory(bytes) => outputs.write(&path, bytes)?,
            Place::File { mut part, file } => {
                fill(part.file.as_file_mut(), &sha256, &places).map_err(failed(&path))?;
                outputs.check_replaceable(&path, &file, Some(&BTreeSet::new()))?;
                outputs.keep(part.close(), file, path);
            }
        }
        Ok(InputFile { name, sha256 })
    }
}

/// Writes the hash of the content into its places.
fn fill(file: &mut File, hash: &str, places: &[u64]) -> io::Result<()> {
    for &place in places {
        file.seek(SeekFrom::Start(place))?;
        file.write_all(hash.as_bytes())?;
    }
    file.flush()
}
