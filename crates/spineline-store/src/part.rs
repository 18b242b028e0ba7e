//! A file that is written under another name, and renamed when it is complete and on the disk. The next process replaces the rest that a
//! killed one leaves.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::beside::{INDEX, JOURNAL, LOG, beside, has_content, remove};
use crate::error::StoreError;
use crate::heads;
use crate::privacy;

/// The unfinished part of a file. It is removed unless [`Part::place_new`] or [`Part::replace`] is called.
#[derive(Debug)]
pub(crate) struct Part {
    path: PathBuf,
    target: PathBuf,
    is_placed: bool,
    /// Keeps other processes from making the same part.
    _claim: File,
}

impl Part {
    /// Makes an empty part of a file.
    ///
    /// # Errors
    /// [`StoreError::Busy`] while another process makes it, [`StoreError::File`].
    pub fn of(target: &Path) -> Result<Self, StoreError> {
        let path = beside(target, ".part");
        let claim = claim(&path).map_err(|source| match source.kind() {
            ErrorKind::WouldBlock => StoreError::Busy,
            _ => StoreError::File { path: path.clone(), source },
        })?;
        Ok(Self { path, target: target.to_owned(), is_placed: false, _claim: claim })
    }

    /// Where it is made.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives it its name, where the file is missing or empty.
    ///
    /// # Errors
    /// As [`check_free`]; [`StoreError::File`].
    pub fn place_new(self) -> Result<(), StoreError> {
        check_free(&self.target)?;
        heads::forget(&self.target)?;
        self.replace()
    }

    /// Gives it its name and replaces the file of that name.
    pub fn replace(mut self) -> Result<(), StoreError> {
        let failed = |source| StoreError::File { path: self.target.clone(), source };
        File::open(&self.path).and_then(|file| file.sync_all()).map_err(failed)?;
        fs::rename(&self.path, &self.target).map_err(failed)?;
        self.is_placed = true;
        sync_folder(&self.target)
            .map_err(|source| StoreError::File { path: self.target.clone(), source })
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        if !self.is_placed {
            // The first error is reported; a failed clean-up must not hide it.
            let _ = fs::remove_file(&self.path);
            let _ = remove_logs(&self.path);
        }
    }
}

/// Empties the part, unless a running process writes it.
fn claim(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    privacy::owner_only(options.write(true));
    #[cfg(unix)]
    let part = {
        use std::os::unix::fs::MetadataExt;
        loop {
            let part = options.create(true).truncate(false).open(path)?;
            part.try_lock()?;
            // The earlier owner may have removed it in between.
            if fs::metadata(path)
                .is_ok_and(|found| Some(found.ino()) == part.metadata().ok().map(|m| m.ino()))
            {
                part.set_len(0)?;
                break part;
            }
        }
    };
    // On this system a file in use cannot be removed.
    #[cfg(not(unix))]
    let part = {
        remove(path)?;
        options.create_new(true).open(path)?
    };
    remove_logs(path)?;
    Ok(part)
}

/// Refuses the name of a file that is not empty, or that has logs of a store beside it.
///
/// # Errors
/// [`StoreError::AlreadyExists`], [`StoreError::UnfittingLog`].
pub(crate) fn check_free(path: &Path) -> Result<(), StoreError> {
    match fs::symlink_metadata(path) {
        Ok(found) if !found.is_file() || found.len() > 0 => {
            return Err(StoreError::AlreadyExists { path: path.to_owned() });
        }
        Err(source) if source.kind() != ErrorKind::NotFound => {
            return Err(StoreError::File { path: path.to_owned(), source });
        }
        _ => {}
    }
    match [LOG, JOURNAL].map(|end| beside(path, end)).into_iter().find(|log| has_content(log)) {
        Some(log) => Err(StoreError::UnfittingLog { log }),
        None => Ok(()),
    }
}

/// Removes the logs of SQLite beside a file.
fn remove_logs(path: &Path) -> io::Result<()> {
    [LOG, INDEX, JOURNAL].iter().try_for_each(|end| remove(&beside(path, end)))
}

/// Flushes a folder, so that a new name survives a power failure, where the system allows it.
fn sync_folder(path: &Path) -> io::Result<()> {
    #[cfg(unix)]
    {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        File::open(folder.unwrap_or(Path::new(".")))?.sync_all()?;
    }
    #[cfg(not(unix))]
    let _ = path;
    Ok(())
}
