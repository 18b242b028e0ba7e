//! Results that are written piece by piece.

use std::io::Write;
use std::path::{Path, PathBuf};

use spineline_files::{InputFile, RunningDigest};
use tempfile::NamedTempFile;

use super::staged::{Outputs, failed, name_of};
use crate::run::failure::Failure;
use crate::run::interrupt;

/// A result in the making; without [`Pieces::keep`] nothing of it is left.
pub struct Pieces<'a> {
    outputs: &'a Outputs,
    path: PathBuf,
    digest: RunningDigest,
    place: Place,
}

enum Place {
    /// What is printed or goes to a pipe, all at once.
    Memory(Vec<u8>),
    /// Beside its target; none once it is kept.
    File { part: Option<NamedTempFile>, file: PathBuf },
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
        Self { outputs, path: path.to_owned(), digest: RunningDigest::default(), place }
    }

    /// Adds the next piece.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, piece: impl AsRef<[u8]>) -> Result<(), Failure> {
        let piece = piece.as_ref();
        self.digest.update(piece);
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

    /// Keeps the result for its path, and returns its name and digest.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep(mut self) -> Result<InputFile, Failure> {
        let digest = std::mem::take(&mut self.digest);
        match &mut self.place {
            Place::Memory(bytes) => self.outputs.write(&self.path, std::mem::take(bytes))?,
            Place::File { part, file } => {
                if let Some(mut whole) = part.take() {
                    if let Err(error) = whole.flush() {
                        interrupt::forget_part(whole.path());
                        return Err(failed(&self.path)(error));
                    }
                    let file = std::mem::take(file);
                    self.outputs.keep(whole.into_temp_path(), file, self.path.clone());
                }
            }
        }
        Ok(InputFile { name: name_of(&self.path), sha256: digest.hex() })
    }
}

impl Drop for Pieces<'_> {
    fn drop(&mut self) {
        if let Place::File { part: Some(part), .. } = &self.place {
            interrupt::forget_part(part.path());
        }
    }
}
