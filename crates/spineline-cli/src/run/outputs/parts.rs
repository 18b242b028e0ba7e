//! Unfinished files, beside their targets. A killed program leaves some; the next run that writes into the folder removes them.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use crate::run::interrupt::Part;

/// Start and end of their names; between them, a word per run and a word per file.
const BEGIN: &str = ".spineline-";
const END: &str = ".part";

/// The unfinished files of this run in one folder.
pub struct Parts {
    pub folder: PathBuf,
    /// Locked while the program runs, so that its files are not taken for left ones.
    lock: Part,
}

impl Parts {
    /// Removes the files of earlier runs in a folder, and begins.
    ///
    /// # Errors
    /// If no file can be made there.
    pub fn begin(folder: &Path) -> io::Result<Self> {
        remove_left(folder);
        loop {
            let lock = make(folder, BEGIN)?;
            let locked = lock.file.as_file().try_lock();
            let is_taken = matches!(locked, Err(TryLockError::WouldBlock));
            // Another run may have removed it as a left one.
            if !is_taken && lock.file.path().exists() {
                return Ok(Self { folder: folder.to_owned(), lock });
            }
        }
    }

    /// An empty file.
    pub fn add(&self) -> io::Result<Part> {
        let name = self.lock.file.path().file_name().unwrap_or_default().to_string_lossy();
        make(&self.folder, &format!("{}-", name.trim_end_matches(END)))
    }
}

fn make(folder: &Path, begin: &str) -> io::Result<Part> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(begin).suffix(END);
    // A temporary file is its owner's alone; a result has the permissions of an ordinary new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    Part::make(|| builder.tempfile_in(folder))
}

/// Removes the files of runs that have ended without doing so.
fn remove_left(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let names: Vec<String> = names.filter(|name| run_of(name).is_some()).collect();
    let runs: BTreeSet<&str> = names.iter().filter_map(|name| run_of(name)).collect();
    for run in runs {
        let lock = folder.join(format!("{BEGIN}{run}{END}"));
        let Some(_held) = left(&lock) else { continue };
        for name in names.iter().filter(|name| run_of(name) == Some(run)) {
            let file = folder.join(name);
            if file != lock {
                // A file that cannot be removed does no harm.
                let _ = fs::remove_file(file);
            }
        }
        let _ = fs::remove_file(lock);
    }
}

/// The run of an unfinished file, by its name.
fn run_of(name: &str) -> Option<&str> {
    let words = name.strip_prefix(BEGIN)?.strip_suffix(END)?;
    words.split('-').next()
}

/// The lock of an ended run, held from now on, without a file if that is gone; `None` for a running one.
fn left(lock: &Path) -> Option<Option<File>> {
    match File::options().write(true).open(lock) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Some(None),
        Err(_) => None,
        Ok(file) => file.try_lock().is_ok().then_some(Some(file)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(folder: &Path) -> usize {
        fs::read_dir(folder).expect("a folder").count()
    }

    #[test]
    fn files_of_a_killed_run_are_removed_and_files_of_a_running_one_stay() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["aaaaaa", "aaaaaa-bbbbbb", "cccccc-dddddd"] {
            fs::write(folder.path().join(format!("{BEGIN}{name}{END}")), "half").expect("a file");
        }
        fs::write(folder.path().join("my.part"), "notes").expect("a file");
        let running = Parts::begin(folder.path()).expect("a place");
        let part = running.add().expect("a file");
        assert_eq!(files(folder.path()), 3);
        let other = Parts::begin(folder.path()).expect("a place");
        assert!(part.file.path().exists());
        drop((part, running, other));
        assert_eq!(files(folder.path()), 1, "what others wrote stays");
    }
}
