//! A store through one connection: made, opened, changed.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

use rusqlite::{Connection, MAIN_DB, OpenFlags, TransactionBehavior};

use crate::audit::{self, AuditEntry, Head, Ledger};
use crate::error::StoreError;
use crate::names::{ReadingId, Signature};
use crate::privacy;
use crate::schema;
use crate::state::ReadingState;
use crate::unsaved::Unsaved;

/// A study store, through one connection. Several may be open on one file, in one program or in many.
#[derive(Debug)]
pub struct Store {
    pub(crate) connection: Connection,
    /// States of finished readings, which never change.
    pub(crate) finals: RefCell<BTreeMap<ReadingId, ReadingState>>,
    pub(crate) unsaved: Unsaved,
}

impl Store {
    /// Makes a new store in a file that does not exist yet, or is empty.
    ///
    /// # Errors
    /// [`StoreError::AlreadyExists`], [`StoreError::CannotOpen`] and errors of the file system.
    pub fn create(path: &Path, by: &Signature) -> Result<Self, StoreError> {
        let taken = || StoreError::AlreadyExists { path: path.to_owned() };
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE;
        let is_ours = privacy::reserve(path);
        let made = schema::connect(path, flags).and_then(|mut connection| {
            schema::configure(&connection)?;
            let is_made = schema::create(&mut connection, by)?;
            Ok((connection, is_made))
        });
        match made {
            Ok((connection, true)) => Ok(Self::over(connection)),
            // A file that SQLite cannot read is not a store.
            Ok((_, false)) | Err(StoreError::Damaged { .. }) => Err(taken()),
            Err(error) => {
                if is_ours {
                    // The first error is reported; a failed clean-up must not hide it.
                    let _ = fs::remove_file(path);
                }
                Err(error)
            }
        }
    }

    /// Opens a store for reading and writing. One of an older schema gets the tables that it lacks.
    ///
    /// # Errors
    /// [`StoreError::NotFound`], [`StoreError::NotAStore`], [`StoreError::NewerSchema`], [`StoreError::ReadOnly`];
    /// none of them has changed the file.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let mut connection = connect(path, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        // SQLite opens for reading where it may not write.
        if connection.is_readonly(MAIN_DB)? {
            return Err(StoreError::ReadOnly);
        }
        schema::configure(&connection)?;
        schema::write_ahead(&connection)?;
        schema::upgrade(&mut connection)?;
        Ok(Self::over(connection))
    }

    /// Opens a store for reading only, such as a backup on a disk that cannot be written. Every change is refused as
    /// [`StoreError::ReadOnly`].
    ///
    /// # Errors
    /// As [`Store::open`].
    pub fn view(path: &Path) -> Result<Self, StoreError> {
        let connection = connect(path, OpenFlags::SQLITE_OPEN_READ_ONLY)?;
        Ok(Self::over(connection))
    }

    fn over(connection: Connection) -> Self {
        Self { connection, finals: RefCell::default(), unsaved: Unsaved::default() }
    }

    /// How long a write waits while another program writes, before it gives up as [`StoreError::Busy`]: 5 s at
    /// first, and a day at most.
    ///
    /// # Errors
    /// [`StoreError::Database`], if SQLite refuses.
    pub fn set_busy_timeout(&self, timeout: Duration) -> Result<(), StoreError> {
        let longest = Duration::from_secs(24 * 60 * 60);
        Ok(self.connection.busy_timeout(timeout.min(longest))?)
    }

    /// The head of the audit log (number of entries and hash), to be kept outside of the store.
    ///
    /// # Errors
    /// [`StoreError::Damaged`].
    pub fn head(&self) -> Result<Head, StoreError> {
        Ok(audit::head(&self.connection)?.0)
    }

    /// The audit log, oldest first. [`Store::verify`] checks it.
    ///
    /// # Errors
    /// [`StoreError::Damaged`].
    pub fn audit_log(&self) -> Result<Vec<AuditEntry>, StoreError> {
        let mut query = self.connection.prepare("SELECT * FROM audit ORDER BY sequence")?;
        let entries = query.query_map([], |row| AuditEntry::read(row).map(|(entry, _)| entry))?;
        Ok(entries.collect::<Result<_, _>>()?)
    }

    /// Commits one change with its log entries and flushes it, or rolls it back.
    pub(crate) fn write<T>(
        &mut self,
        by: &Signature,
        change: impl FnOnce(&Ledger<'_>) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let transaction =
            self.connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let ledger = Ledger { transaction: &transaction, by };
        ledger.notice_clock()?;
        self.unsaved.save(&transaction, by.at)?;
        let value = change(&ledger)?;
        transaction.commit()?;
        self.unsaved = Unsaved::default();
        Ok(value)
    }
}

fn connect(path: &Path, flags: OpenFlags) -> Result<Connection, StoreError> {
    match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => {}
        Ok(_) => return Err(StoreError::NotAStore { path: path.to_owned() }),
        Err(_) => return Err(StoreError::NotFound { path: path.to_owned() }),
    }
    let connection = schema::connect(path, flags)?;
    schema::check(&connection, path)?;
    Ok(connection)
}
