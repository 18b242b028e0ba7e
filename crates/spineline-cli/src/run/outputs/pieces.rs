//! Results that are written piece by piece.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use spineline_files::{InputFile, RunningContent};
use tempfile::NamedTempFile;

use super::staged::{Outputs, failed, name_of};
use super::target::Target;
use crate::run::failure::Failure;
use crate::run::interrupt;

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
    /// Beside its target; none once it is kept.
    File { part: Option<NamedTempFile>, file: PathBuf },
}

impl Outputs {
    /// Begins a result that is made piece by piece, so that it need not fit into memory where it goes to a file.
    ///
    /// # Errors
    /// As [`Outputs::file`], or if it cannot be written.
    pub fn begin(&self, path: &Path) -> Result<Pieces<'_>, Failure> {
        let Target::File(file) = Target::of(path)? else {
            return Ok(Pieces::in_memory(self, path));
        };
        self.check_replaceable(path, &file, None)?;
        let part = self.begin_file(path, &file)?;
        Ok(Pieces::in_file(self, path, file, part))
    }
}

impl<'a> Pieces<'a> {
    pub(super) fn in_memory(outputs: &'a Outputs, path: &Path) -> Self {
        Self::new(outputs, path, Place::Memory(Vec::new()))
    }

    pub(super) fn in_file(
        outputs: &'a Outputs,
        path: &Path,
        file: PathBuf,
        part: NamedTempFile,
    ) -> Self {
        Self::new(outputs, path, Place::File { part: Some(part), file })
    }

    fn new(outputs: &'a Outputs, path: &Path, place: Place) -> Self {
        Self { outputs, path: path.to_owned(), content: RunningContent::default(), place }
    }

    /// Adds the next piece.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, piece: impl AsRef<[u8]>) -> Result<(), Failure> {
        let piece = piece.as_ref();
        self.content.update(piece);
        match &mut self.place {
            Place::Memory(all) => all.extend_from_slice(piece),
            Place::File { part, .. } => {
                if let Some(part) = part {
                    part.write_all(piece).map_err(failed(&self.path))?;
                }
            }
        }
        Ok(())
    }

    /// Keeps the result for its path, and returns its name and hash.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep(mut self) -> Result<InputFile, Failure> {
        let (sha256, places) = std::mem::take(&mut self.content).finish();
        match &mut self.place {
            Place::Memory(bytes) => self.outputs.write(&self.path, std::mem::take(bytes))?,
            Place::File { part, file } => {
                if let Some(mut whole) = part.take() {
                    let filled = fill(whole.as_file_mut(), &sha256, &places);
                    let kept = filled.map_err(failed(&self.path)).and_then(|()| {
                        self.outputs.check_replaceable(&self.path, file, Some(&BTreeSet::new()))
                    });
                    if let Err(failure) = kept {
                        interrupt::forget_part(whole.path());
                        return Err(failure);
                    }
                    let file = std::mem::take(file);
                    self.outputs.keep(whole.into_temp_path(), file, self.path.clone());
                }
            }
        }
        Ok(InputFile { name: name_of(&self.path), sha256 })
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

impl Drop for Pieces<'_> {
    fn drop(&mut self) {
        if let Place::File { part: Some(part), .. } = &self.place {
            interrupt::forget_part(part.path());
        }
    }
}
