//! Restores a backup in place of a store.
//!
//! At every moment a whole store has the name: the earlier one, and then the restored one. The earlier files are copied first,
//! the store with its log; a log that belongs to another store is moved beside the copy. Only then the backup gets the name, by
//! renaming. A killed process leaves a `.part` file at most, which the next one replaces.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags};

use crate::acceptance::accept;
use crate::backup::fill;
use crate::beside::{INDEX, JOURNAL, LOG, behind_links, beside, has_content, remove};
use crate::connection::Store;
use crate::error::StoreError;
use crate::heads;
use crate::part::Part;
use crate::schema::{self, Mark};
use crate::verify::Verification;

/// What a restoration did.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Restoration {
    /// Verification of the backup. A backup with findings replaces nothing.
    pub verification: Verification,
    /// New path of the store that had the name before.
    pub replaced: Option<PathBuf>,
}

impl Store {
    /// Restores a backup in place of a store, which may be missing, damaged, or have another store's log beside it. No program may
    /// have it open. The earlier files are kept under another name.
    ///
    /// # Errors
    /// [`StoreError::Backup`]; [`StoreError::Held`]; [`StoreError::NotAStore`] where another file has the name; [`StoreError::SameFile`];
    /// [`StoreError::Full`], [`StoreError::File`] and the like. All of them leave the store as it was.
    pub fn restore(backup: &Path, store: &Path) -> Result<Restoration, StoreError> {
        restore(backup, &behind_links(store), &mut |_| {})
    }
}

/// Calls `reached` after every step.
pub(crate) fn restore(
    backup: &Path,
    store: &Path,
    reached: &mut dyn FnMut(&'static str),
) -> Result<Restoration, StoreError> {
    if behind_links(backup) == store {
        return Err(StoreError::SameFile { path: store.to_owned() });
    }
    let of_backup = |error| StoreError::Backup { error: Box::new(error) };
    let source = Store::view(backup).map_err(of_backup)?;
    let there = There::at(store)?;
    reached("the store is held");
    let part = Part::of(store)?;
    reached("the part is begun");
    let filled = fill(&source.connection, &part, Mark::Store);
    let verification = filled.map_err(|error| match error {
        StoreError::Damaged { .. } => of_backup(error),
        other => other,
    })?;
    if !verification.is_clean() {
        return Ok(Restoration { verification, replaced: None });
    }
    reached("the part is full");
    let replaced = there.keep(store, reached)?;
    heads::forget(store)?;
    reached("the heads are forgotten");
    // Some systems cannot rename an open file.
    #[cfg(not(unix))]
    drop(there);
    part.replace()?;
    reached("the backup has the name");
    #[cfg(unix)]
    drop(there);
    Ok(Restoration { verification, replaced })
}

/// The file that has the name of the restored store.
enum There {
    /// No file, or an empty one.
    Nothing,
    /// A store with its log, locked as long as this value lives.
    Sound(Connection),
    /// A damaged store, or one beside the log of another store.
    Unusable,
}

impl There {
    fn at(store: &Path) -> Result<Self, StoreError> {
        match fs::metadata(store) {
            Ok(found) if !found.is_file() => {
                return Err(StoreError::NotAStore { path: store.to_owned() });
            }
            Ok(found) if found.len() > 0 => {}
            _ => return Ok(Self::Nothing),
        }
        let connection = schema::connect(store, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        // SQLite would write a journal back before it reads anything.
        if !has_content(&beside(store, JOURNAL)) {
            hold(&connection)?;
        }
        match accept(&connection, store) {
            Ok(_) => Ok(Self::Sound(connection)),
            Err(
                StoreError::Damaged { .. }
                | StoreError::UnfittingLog { .. }
                | StoreError::NewerSchema { .. },
            ) => Ok(Self::Unusable),
            Err(other) => Err(other),
        }
    }

    /// Keeps the earlier store under a new name, with everything in its log.
    fn keep(
        &self,
        store: &Path,
        reached: &mut dyn FnMut(&'static str),
    ) -> Result<Option<PathBuf>, StoreError> {
        let failed = |source| StoreError::File { path: store.to_owned(), source };
        let kept = free_name(store);
        match self {
            Self::Nothing => {}
            Self::Sound(connection) => {
                let part = Part::of(&kept)?;
                fill(connection, &part, Mark::Backup)?;
                part.place_new()?;
                reached("the earlier store is copied");
                // Writes the log into the store, and removes it.
                schema::without_journal(connection)?;
                reached("its log is in the store");
            }
            Self::Unusable => {
                let part = Part::of(&kept)?;
                copy_bytes(store, part.path()).map_err(failed)?;
                part.place_new()?;
                reached("the damaged store is copied");
            }
        }
        let mut is_kept = !matches!(self, Self::Nothing);
        for end in [LOG, JOURNAL] {
            let log = beside(store, end);
            if has_content(&log) {
                fs::rename(&log, beside(&kept, end)).map_err(failed)?;
                is_kept = true;
                reached("a log is moved");
            } else {
                remove(&log).map_err(failed)?;
            }
        }
        remove(&beside(store, INDEX)).map_err(failed)?;
        Ok(is_kept.then_some(kept))
    }
}

/// Refuses while another connection has the store open, as far as SQLite can read it.
fn hold(connection: &Connection) -> Result<(), StoreError> {
    connection.busy_timeout(std::time::Duration::ZERO)?;
    let held = connection
        .pragma_update_and_check(None, "locking_mode", "EXCLUSIVE", |_| Ok(()))
        .and_then(|()| connection.execute_batch("BEGIN EXCLUSIVE; ROLLBACK"));
    match held.map_err(StoreError::from).and_then(|()| schema::configure(connection)) {
        Err(StoreError::Busy) => Err(StoreError::Held),
        Err(StoreError::Damaged { .. }) | Ok(()) => Ok(()),
        Err(other) => Err(other),
    }
}

/// The first free name for an earlier store.
fn free_name(store: &Path) -> PathBuf {
    let names = (1_u64..).map(|number| beside(store, &format!(".replaced-{number}")));
    let is_free = |name: &PathBuf| {
        ["", LOG, JOURNAL].iter().all(|end| fs::symlink_metadata(beside(name, end)).is_err())
    };
    names.into_iter().find(is_free).expect("there are more numbers than files")
}

fn copy_bytes(from: &Path, to: &Path) -> io::Result<()> {
    io::copy(&mut File::open(from)?, &mut fs::OpenOptions::new().write(true).open(to)?).map(drop)
}
