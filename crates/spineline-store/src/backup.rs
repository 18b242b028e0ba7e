//! Complete, flushed and verified copies of a store, which never replace a file.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use rusqlite::backup::{Backup, StepResult};
use rusqlite::{Connection, OpenFlags};

use crate::connection::Store;
use crate::error::StoreError;
use crate::privacy;
use crate::schema;
use crate::verify::{Verification, verify};

impl Store {
    /// Copies the store, as it is at this moment, into a new file, flushes it to the disk and verifies the copy.
    ///
    /// A damaged store is copied too; the caller checks the result of the verification.
    ///
    /// # Errors
    /// [`StoreError::AlreadyExists`]; [`StoreError::Full`], [`StoreError::File`] and the like, which leave no file.
    pub fn backup_to(&self, path: &Path) -> Result<Verification, StoreError> {
        copy(&self.connection, path)
    }
}

/// The final name is reserved first and filled last, by renaming: under that name there is never half a copy. A process
/// that is killed here leaves an empty file of that name and a `.part` beside it, which is not a valid store.
fn copy(source: &Connection, target: &Path) -> Result<Verification, StoreError> {
    let mut part = OsString::from(target);
    part.push(".part");
    let part = PathBuf::from(part);
    reserve(target)?;
    if let Err(error) = reserve(&part) {
        let _ = fs::remove_file(target);
        return Err(error);
    }
    let failed = |source| StoreError::File { path: target.to_owned(), source };
    let filled = fill(source, &part).and_then(|verification| {
        File::open(&part).and_then(|file| file.sync_all()).map_err(failed)?;
        fs::rename(&part, target).map_err(failed)?;
        sync_folder(target).map_err(failed)?;
        Ok(verification)
    });
    if filled.is_err() {
        // The first error is reported; a failed clean-up must not hide it.
        let _ = fs::remove_file(&part);
        let _ = fs::remove_file(target);
    }
    filled
}

/// Makes an empty file where there is none.
fn reserve(path: &Path) -> Result<(), StoreError> {
    match privacy::owner_only(OpenOptions::new().write(true).create_new(true)).open(path) {
        Ok(_) => Ok(()),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            Err(StoreError::AlreadyExists { path: path.to_owned() })
        }
        Err(source) => Err(StoreError::File { path: path.to_owned(), source }),
    }
}

fn fill(source: &Connection, part: &Path) -> Result<Verification, StoreError> {
    let mut copy = schema::connect(part, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
    schema::configure(&copy)?;
    {
        let backup = Backup::new(source, &mut copy)?;
        // All pages in one step are one snapshot.
        if backup.step(-1)? != StepResult::Done {
            return Err(StoreError::Busy);
        }
    }
    // One file alone, which can be read from a read-only disk too.
    copy.pragma_update_and_check(None, "journal_mode", "DELETE", |_| Ok(()))?;
    let verification = verify(&copy, None)?;
    copy.close().map_err(|(_, error)| error)?;
    Ok(verification)
}

/// Flushes a folder, so that a new name survives a power failure, where the system allows it.
fn sync_folder(path: &Path) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        File::open(folder.unwrap_or(Path::new(".")))?.sync_all()?;
    }
    #[cfg(not(unix))]
    let _ = path;
    Ok(())
}
