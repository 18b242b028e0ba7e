//! A store through one connection: made, opened, changed.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use rusqlite::{Connection, MAIN_DB, OpenFlags, TransactionBehavior};

use crate::acceptance::{accept, compare_end, contains};
use crate::audit::{self, AuditEntry, Head, Ledger};
use crate::beside::{HEADS, LOG, behind_links, beside, has_content, remove};
use crate::error::StoreError;
use crate::heads::{self, HeadFile, Heads};
use crate::names::{ReadingId, Signature};
use crate::part::{Part, check_free};
use crate::schema;
use crate::state::ReadingState;
use crate::unsaved::Unsaved;
use crate::verify::{Finding, Verification, verify};

/// A study store, through one connection. Several may be open on one file, in one program or in many.
#[derive(Debug)]
pub struct Store {
    pub(crate) connection: Connection,
    /// States of finished readings, which never change.
    pub(crate) finals: RefCell<BTreeMap<ReadingId, ReadingState>>,
    pub(crate) unsaved: Unsaved,
    /// The file, behind links.
    pub(crate) path: PathBuf,
    /// What only a store that is written has.
    writer: Option<Writer>,
    busy_timeout: Duration,
}

#[derive(Debug)]
struct Writer {
    heads: HeadFile,
    /// The last change that was acknowledged, where the log does not contain it.
    lost: Option<Head>,
    /// Length and time of SQLite's log when it was last looked at.
    log: Option<(u64, SystemTime)>,
}

/// Action of the entry whose author was the first to write after the store went back.
const WENT_BACK: &str = "store_went_back";

impl Store {
    /// Makes a new store in a file that does not exist yet, or is empty.
    ///
    /// # Errors
    /// [`StoreError::NoFolder`]; [`StoreError::AlreadyExists`]; [`StoreError::UnfittingLog`] where the log of another store lies beside the file;
    /// [`StoreError::CannotOpen`] and errors of the file system.
    pub fn create(path: &Path, by: &Signature) -> Result<Self, StoreError> {
        let file = behind_links(path);
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
        if folder.is_some_and(|folder| !folder.is_dir()) {
            return Err(StoreError::NoFolder { path: path.to_owned() });
        }
        check_free(&file)?;
        let part = Part::of(&file).map_err(read_only)?;
        let mut connection = schema::connect(part.path(), OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        schema::configure(&connection)?;
        schema::without_journal(&connection)?;
        schema::create(&mut connection, by)?;
        connection.close().map_err(|(_, error)| error)?;
        part.place_new()?;
        Self::open(path)
    }

    /// Removes a store that was made in vain, and the heads beside it.
    ///
    /// # Errors
    /// [`StoreError::File`].
    pub fn discard(self) -> Result<(), StoreError> {
        let path = self.path.clone();
        // SQLite removes its log with the last connection.
        drop(self);
        heads::forget(&path)?;
        remove(&path).map_err(|source| StoreError::File { path, source })
    }

    /// Opens a store for reading and writing.
    ///
    /// # Errors
    /// [`StoreError::NotFound`], [`StoreError::NotAStore`], [`StoreError::NewerSchema`], [`StoreError::ReadOnly`];
    /// [`StoreError::UnfittingLog`] for the log of another store, or a damaged one, beside it; [`StoreError::Damaged`] where its end
    /// differs from its log. No file is changed then.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let Opened { connection, file, main } = connect(path, OpenFlags::SQLITE_OPEN_READ_WRITE)?;
        // SQLite opens for reading where it may not write.
        if connection.is_readonly(MAIN_DB)? {
            return Err(StoreError::ReadOnly);
        }
        compare_end(&connection, main.as_ref())?;
        // An unreadable file of heads is a finding of the verification.
        let kept = Heads::read(&file).unwrap_or_default();
        let (last, in_main) = kept.map_or_else(Default::default, |kept| (kept.last, kept.in_main));
        let lost = (!contains(&connection, &last)?).then(|| last.clone());
        let last = if lost.is_some() { last } else { audit::head(&connection)?.0 };
        let heads = Heads { last, in_main: main.unwrap_or(in_main) };
        // First, because a folder that cannot be written refuses it.
        let heads = HeadFile::open(&file, heads).map_err(read_only)?;
        schema::configure(&connection)?;
        schema::write_ahead(&connection)?;
        schema::allow_checkpoints(&connection)?;
        let writer = Writer { heads, lost, log: None };
        Ok(Self::over(connection, file, Some(writer)))
    }

    /// Opens a store for reading only, such as a backup on a disk that cannot be written. Every change is refused as
    /// [`StoreError::ReadOnly`].
    ///
    /// # Errors
    /// As [`Store::open`], but for the end of the store, which [`Store::verify`] looks at.
    pub fn view(path: &Path) -> Result<Self, StoreError> {
        let opened = connect(path, OpenFlags::SQLITE_OPEN_READ_ONLY)?;
        Ok(Self::over(opened.connection, opened.file, None))
    }

    fn over(connection: Connection, path: PathBuf, writer: Option<Writer>) -> Self {
        let (finals, unsaved) = (RefCell::default(), Unsaved::default());
        let busy_timeout = schema::BUSY_TIMEOUT;
        Self { connection, finals, unsaved, path, writer, busy_timeout }
    }

    /// The last change that was acknowledged here, where the log does not contain it: the store went back, because its log was lost or
    /// an earlier copy replaced it. The next change writes this into the audit log.
    #[must_use]
    pub fn lost_head(&self) -> Option<&Head> {
        self.writer.as_ref()?.lost.as_ref()
    }

    /// Writes SQLite's log into the store if it has not changed since the last call. Call it every few seconds: a copy of the
    /// main file alone then lacks the changes of a few seconds at most.
    ///
    /// # Errors
    /// [`StoreError::Full`], [`StoreError::Disk`] and the like; the changes stay in the log.
    pub fn rest(&mut self) -> Result<(), StoreError> {
        let log = fs::metadata(beside(&self.path, LOG));
        let now = log.ok().and_then(|log| Some((log.len(), log.modified().ok()?)));
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let is_at_rest = std::mem::replace(&mut writer.log, now) == now;
        if is_at_rest && now.is_some_and(|(bytes, _)| bytes > 0) {
            self.checkpoint()
        } else {
            Ok(())
        }
    }

    /// Writes SQLite's log into the store and empties it, unless a connection reads from it.
    fn checkpoint(&mut self) -> Result<(), StoreError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let (head, _) = audit::head(&self.connection)?;
        // Do not wait for readers.
        self.connection.busy_timeout(Duration::ZERO)?;
        let query = "PRAGMA wal_checkpoint(TRUNCATE)";
        let is_busy = self.connection.query_row(query, [], |row| row.get::<_, bool>(0));
        self.connection.busy_timeout(self.busy_timeout)?;
        if !is_busy? {
            let last = writer.lost.as_ref().unwrap_or(&head).clone();
            writer.heads.keep(Heads { last, in_main: head });
        }
        Ok(())
    }

    /// How long a write waits while another program writes, before it fails as [`StoreError::Busy`]: 5 s by
    /// default, one day at most.
    ///
    /// # Errors
    /// [`StoreError::Database`], if SQLite refuses.
    pub fn set_busy_timeout(&mut self, timeout: Duration) -> Result<(), StoreError> {
        let longest = Duration::from_secs(24 * 60 * 60);
        self.busy_timeout = timeout.min(longest);
        Ok(self.connection.busy_timeout(self.busy_timeout)?)
    }

    /// The head of the audit log (number of entries and hash), to be kept outside of the store.
    pub fn head(&self) -> Result<Head, StoreError> {
        Ok(audit::head(&self.connection)?.0)
    }

    /// The audit log, oldest first. [`Store::verify`] checks it.
    pub fn audit_log(&self) -> Result<Vec<AuditEntry>, StoreError> {
        let mut query = self.connection.prepare("SELECT * FROM audit ORDER BY sequence")?;
        let entries = query.query_map([], |row| AuditEntry::read(row).map(|(entry, _)| entry))?;
        Ok(entries.collect::<Result<_, _>>()?)
    }

    /// Checks everything: the file, its references, the log, every row against the log, every film against its hash.
    ///
    /// The log must contain the head that is kept beside the store. With an external head, this
    /// method also detects a log that was rewritten as a whole. **Without one, a person who can write the
    /// file can compute a new log, and this cannot be detected.**
    ///
    /// # Errors
    /// Damage is a finding. Errors are failures of reading, such as [`StoreError::Busy`].
    pub fn verify(&self, known: Option<&Head>) -> Result<Verification, StoreError> {
        // First, because writes of other programs in between make the store newer.
        let kept = Heads::read(&self.path);
        let mut verification = verify(&self.connection, known)?;
        match kept {
            Ok(Some(kept)) => {
                let acknowledged = kept.last.entries;
                if !contains(&self.connection, &kept.last).unwrap_or(false) {
                    verification.findings.push(Finding::WentBack { acknowledged });
                }
            }
            Ok(None) => {}
            Err(_) => verification.findings.push(Finding::Unreadable {
                part: "the file beside the store that ends in `-head`",
            }),
        }
        Ok(verification)
    }

    /// Commits one change with its log entries and flushes it, or rolls it back.
    pub(crate) fn write<T>(
        &mut self,
        by: &Signature,
        change: impl FnOnce(&Ledger<'_>) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let transaction =
            self.connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let by = &by.of_writing();
        let ledger = Ledger { transaction: &transaction, by };
        ledger.notice_clock()?;
        self.unsaved.save(&transaction, by.at)?;
        let writer = self.writer.as_mut();
        if writer.as_ref().is_some_and(|writer| writer.lost.is_some()) {
            ledger.note(WENT_BACK)?;
        }
        let value = change(&ledger)?;
        let (head, _) = audit::head(&transaction)?;
        transaction.commit()?;
        self.unsaved = Unsaved::default();
        if let Some(writer) = writer {
            writer.lost = None;
            writer.heads.acknowledged(head);
        }
        Ok(value)
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        // Changes that are not written into the store now stay in its log.
        let _ = self.checkpoint();
    }
}

/// A folder in which no file can be made.
fn read_only(error: StoreError) -> StoreError {
    use std::io::ErrorKind::{PermissionDenied, ReadOnlyFilesystem};
    match error {
        StoreError::File { source, .. }
            if matches!(source.kind(), PermissionDenied | ReadOnlyFilesystem) =>
        {
            StoreError::ReadOnly
        }
        other => other,
    }
}

/// A store that was accepted.
struct Opened {
    connection: Connection,
    /// Its file, behind links.
    file: PathBuf,
    /// The head that the main file holds alone, unless it cannot be read without the log.
    main: Option<Head>,
}

fn connect(path: &Path, flags: OpenFlags) -> Result<Opened, StoreError> {
    let file = behind_links(path);
    let is_begun = [HEADS, LOG].iter().any(|end| has_content(&beside(&file, end)));
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_file() && metadata.len() > 0 => {}
        // SQLite would remove the log beside an empty file.
        Ok(metadata) if metadata.is_file() && is_begun => {
            return Err(StoreError::damaged("its file, which is empty"));
        }
        Ok(_) => return Err(StoreError::NotAStore { path: path.to_owned() }),
        Err(_) => return Err(StoreError::NotFound { path: path.to_owned() }),
    }
    let connection = schema::connect(&file, flags)?;
    let main = accept(&connection, &file)?;
    Ok(Opened { connection, file, main })
}
