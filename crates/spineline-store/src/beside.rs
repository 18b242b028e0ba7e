//! The files beside a store: SQLite's log, its index and its journal, and the heads that this program keeps there.

use std::ffi::OsString;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// SQLite's write-ahead log.
pub(crate) const LOG: &str = "-wal";
/// The index of that log, which SQLite builds again where it is missing.
pub(crate) const INDEX: &str = "-shm";
/// SQLite's rollback journal. A store never has one: SQLite would write it back into the store.
pub(crate) const JOURNAL: &str = "-journal";
/// The heads of the audit log that are kept outside of the store.
pub(crate) const HEADS: &str = "-head";

pub(crate) fn beside(store: &Path, end: &str) -> PathBuf {
    let mut name = OsString::from(store);
    name.push(end);
    PathBuf::from(name)
}

/// The store behind symbolic links, beside which SQLite keeps its files.
pub(crate) fn behind_links(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// Whether a file is there and holds something.
pub(crate) fn has_content(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| found.len() > 0)
}

/// Removes a file that may be missing.
pub(crate) fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
