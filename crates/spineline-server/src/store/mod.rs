//! One file that holds studies, their films, who read them, and every click.
//!
//! A [`Store`] is one SQLite file. Everything that is acknowledged is committed and flushed to the disk. Readings are
//! append-only journals of [`Event`]s; their state is a fold over the journal, so that undo survives a reload. Nothing is
//! overwritten: a change based on an old revision is refused **and kept** ([`StoreError::Conflict`], [`Store::conflicts_of_reading`]).
//! Every change has an entry in a hash-chained log. A row that is read is compared with its entry, so that a damaged row
//! is an error and never another reading; rows that are gone, and the log itself, are the business of [`Store::verify`].
//!
//! The bytes of films lie in the database too, once for all films that share them: one file is one thing to copy, to back up
//! and to lock, and no crash can part a film from its record.
//!
//! The store reads no clock. It keeps who may do what ([`Account`], [`StudyGrant`]) and leaves it to its callers to ask. They say who
//! does what and when ([`Signature`]); a blinded reader is given an [`ObserverView`] and nothing else.
//!
//! ```
//! use spineline_server::store::{Name, Signature, Store, Study, Timestamp};
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("clinic.spineline");
//! let noon = Timestamp::from_unix_ms(1_760_000_000_000).ok_or("no such time")?;
//! let by = Signature::new(Name::new("lead")?, noon);
//! let mut store = Store::create(&path, &by)?;
//! store.add_study(&Study { id: Name::new("S-017")?, label: None, synthetic: true }, &by)?;
//! assert!(store.verify(None)?.is_clean());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod accounts;
mod audit;
mod backup;
mod cases;
mod error;
mod export;
mod films;
mod journal;
mod names;
mod plan;
mod readings;
mod schema;
mod sessions;
mod sight;
mod standing;
mod state;
mod thumbnails;
mod verify;

#[cfg(test)]
mod full_disk;

pub use accounts::{Account, AccountChange, Credential, PasswordHash, Role, StudyGrant};
pub use audit::{AuditEntry, Head};
pub use cases::{AddedCase, CaseError, CaseRemark, NewCase};
pub use error::StoreError;
pub use export::{ExportRemark, ExportedCase};
pub use films::{AddedFilm, FilmEdit, FilmRecord, Study};
pub use journal::{Acknowledged, Corner, CrestSide, Event, LostChange};
pub use names::{FilmId, Hash, Name, ReadingId, Signature, Timestamp};
pub use plan::{BlindFilm, FilmCode, Next, ObserverView, OwnReading, PlanDesign, VisibleReadings};
pub use readings::ReadingRecord;
pub use sessions::{Access, Session, SessionLimits};
pub use sight::{LastChange, SeenReading, Sight};
pub use standing::{Stand, StandingCase, StandingFilm};
pub use state::{ReadingState, Scale, VertebraMarks};
pub use thumbnails::Thumbnails;
pub use verify::{Finding, Verification};

use std::path::Path;
use std::time::Duration;

use rusqlite::{Connection, MAIN_DB, OpenFlags, TransactionBehavior};

use audit::Ledger;
use standing::Finals;

/// How long a write waits for another program, unless told otherwise.
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);

/// A study store, through one connection. Several may be open on one file, in one program or in many.
#[derive(Debug)]
pub struct Store {
    connection: Connection,
    finals: Finals,
}

impl Store {
    /// Makes a new store in a file that does not exist yet, or is empty.
    ///
    /// # Errors
    /// [`StoreError::AlreadyExists`], [`StoreError::CannotOpen`] and whatever disks do.
    pub fn create(path: &Path, by: &Signature) -> Result<Self, StoreError> {
        let taken = || StoreError::AlreadyExists { path: path.to_owned() };
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE;
        let mut connection = schema::connect(path, flags)?;
        // What SQLite cannot read is a file of something else.
        let created = schema::settle(&connection)
            .and_then(|()| schema::create(&mut connection, by))
            .map_err(|error| match error {
                StoreError::Damaged { .. } => taken(),
                other => other,
            })?;
        if created { Ok(Self::over(connection)) } else { Err(taken()) }
    }

    /// Opens a store for reading and writing. A store of an older schema is verified, backed up as `NAME.backup-vN` and migrated.
    ///
    /// # Errors
    /// [`StoreError::NotFound`], [`StoreError::NotAStore`], [`StoreError::NewerSchema`], [`StoreError::ReadOnly`],
    /// [`StoreError::MigrationRefused`]; none of them has changed the file.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let (mut connection, found) = connect(path, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        // SQLite falls back to reading where it may not write.
        if connection.is_readonly(MAIN_DB)? {
            return Err(StoreError::ReadOnly);
        }
        schema::settle(&connection)?;
        if found < schema::CURRENT {
            schema::migrate(&mut connection, path, found)?;
        }
        schema::write_ahead(&connection)?;
        Ok(Self::over(connection))
    }

    /// Opens a store for reading only, such as a backup on a disk that cannot be written. Every change is refused as
    /// [`StoreError::ReadOnly`].
    ///
    /// # Errors
    /// As [`Store::open`], and [`StoreError::OlderSchema`].
    pub fn view(path: &Path) -> Result<Self, StoreError> {
        let (connection, found) = connect(path, OpenFlags::SQLITE_OPEN_READ_ONLY)?;
        if found < schema::CURRENT {
            return Err(StoreError::OlderSchema { found, supported: schema::CURRENT });
        }
        Ok(Self::over(connection))
    }

    fn over(connection: Connection) -> Self {
        Self { connection, finals: Finals::default() }
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

    /// The end of the audit log: a number of entries and a hash, worth keeping outside of the store.
    ///
    /// # Errors
    /// [`StoreError::Damaged`].
    pub fn head(&self) -> Result<Head, StoreError> {
        Ok(audit::head(&self.connection)?.0)
    }

    /// The audit log, oldest first. [`Store::verify`] says whether it can be believed.
    ///
    /// # Errors
    /// [`StoreError::Damaged`].
    pub fn audit_log(&self) -> Result<Vec<AuditEntry>, StoreError> {
        let mut query = self.connection.prepare("SELECT * FROM audit ORDER BY sequence")?;
        let entries = query.query_map([], |row| AuditEntry::read(row).map(|(entry, _)| entry))?;
        Ok(entries.collect::<Result<_, _>>()?)
    }

    /// One change and its entries in the log: all of it, flushed, or nothing.
    fn write<T>(
        &mut self,
        by: &Signature,
        change: impl FnOnce(&Ledger<'_>) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let transaction =
            self.connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let ledger = Ledger { transaction: &transaction, by };
        ledger.notice_clock()?;
        let value = change(&ledger)?;
        transaction.commit()?;
        Ok(value)
    }
}

fn connect(path: &Path, flags: OpenFlags) -> Result<(Connection, i64), StoreError> {
    match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => {}
        Ok(_) => return Err(StoreError::NotAStore { path: path.to_owned() }),
        Err(_) => return Err(StoreError::NotFound { path: path.to_owned() }),
    }
    let connection = schema::connect(path, flags)?;
    let found = schema::schema_of(&connection, path)?;
    Ok((connection, found))
}
