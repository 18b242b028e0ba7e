//! The tables of a store, and the recognition of a store file.

use std::path::Path;
use std::time::Duration;

use rusqlite::config::DbConfig;
use rusqlite::{Connection, OpenFlags, Transaction, TransactionBehavior};

use crate::audit::Ledger;
use crate::error::StoreError;
use crate::names::Signature;

/// `SpSt`, the application identifier of stores.
const STORE_ID: i32 = 0x5370_5374;
/// `SpSb`, the identifier of backups: no log beside a backup belongs to it.
const BACKUP_ID: i32 = 0x5370_5362;
/// Where a file of SQLite has its application identifier.
const ID_BYTES: std::ops::Range<usize> = 68..72;
/// A text in the definitions of every store.
pub(crate) const SIGNATURE: &[u8] = b"audit_is_never_edited";

/// The type of a file by its identifier.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    /// A store, which is in use.
    Store,
    /// A copy of a store, unchanged since.
    Backup,
}

impl Mark {
    fn id(self) -> i32 {
        match self {
            Self::Store => STORE_ID,
            Self::Backup => BACKUP_ID,
        }
    }
}

/// The definition of every table.
const SCHEMA: &str = include_str!("schema.sql");

/// The version that this program reads and writes.
const VERSION: i64 = 1;

/// Default time that a write waits for another program.
pub(crate) const BUSY_TIMEOUT: Duration = Duration::from_secs(5);

/// Opens an existing file without checks of its content. Its log stays as it is until [`allow_checkpoints`].
pub(crate) fn connect(path: &Path, flags: OpenFlags) -> Result<Connection, StoreError> {
    let connection = Connection::open_with_flags(path, flags | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
    connection.busy_timeout(BUSY_TIMEOUT)?;
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, true)?;
    Ok(connection)
}

/// The connection may write the log into the store from now on.
pub(crate) fn allow_checkpoints(connection: &Connection) -> Result<(), StoreError> {
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, false)?;
    Ok(())
}

/// Opens the main file of a store for reading, as if no log lay beside it.
pub(crate) fn connect_to_main_alone(path: &Path) -> Result<Connection, StoreError> {
    let mut uri = String::from("file:");
    if cfg!(windows) {
        uri.push('/');
    }
    for &byte in path.as_os_str().as_encoded_bytes() {
        match byte {
            b'\\' if cfg!(windows) => uri.push('/'),
            b'/' | b':' | b'.' | b'-' | b'_' => uri.push(byte.into()),
            _ if byte.is_ascii_alphanumeric() => uri.push(byte.into()),
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri.push_str("?immutable=1");
    connect(Path::new(&uri), OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI)
}

/// Settings of a connection; the file does not store them.
pub(crate) fn configure(connection: &Connection) -> Result<(), StoreError> {
    connection.pragma_update(None, "trusted_schema", false)?;
    connection.pragma_update(None, "cell_size_check", true)?;
    connection.pragma_update(None, "foreign_keys", true)?;
    connection.pragma_update(None, "synchronous", "FULL")?;
    // Without these, a disk under macOS may confirm data that are only in its cache.
    connection.pragma_update(None, "fullfsync", true)?;
    connection.pragma_update(None, "checkpoint_fullfsync", true)?;
    Ok(())
}

/// Turns an empty database into a store.
pub(crate) fn create(connection: &mut Connection, by: &Signature) -> Result<(), StoreError> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    build(&transaction)?;
    put_mark(&transaction, Mark::Store)?;
    Ledger { transaction: &transaction, by }.note("create")?;
    Ok(transaction.commit()?)
}

fn build(transaction: &Transaction<'_>) -> Result<(), StoreError> {
    transaction.execute_batch(SCHEMA)?;
    transaction.execute("INSERT INTO head VALUES (1, 0, '', ?1)", [i64::MIN])?;
    transaction.pragma_update(None, "user_version", VERSION)?;
    Ok(())
}

/// Whether a store has this table: a damaged one may lack some.
pub(crate) fn has_table(connection: &Connection, table: &str) -> Result<bool, StoreError> {
    Ok(connection.prepare("SELECT 1 FROM sqlite_schema WHERE name = ?1")?.exists([table])?)
}

/// Switches an accepted store to a write-ahead log, and makes a backup a store.
pub(crate) fn write_ahead(connection: &Connection) -> Result<(), StoreError> {
    if mark(connection)? != Some(Mark::Store) {
        without_journal(connection)?;
        put_mark(connection, Mark::Store)?;
    }
    let mode: String = connection.pragma_query_value(None, "journal_mode", |row| row.get(0))?;
    if mode != "wal" {
        without_journal(connection)?;
        connection.pragma_update_and_check(None, "journal_mode", "WAL", |_| Ok(()))?;
    }
    Ok(())
}

/// Writes the next changes without a journal on the disk, so that no crash leaves one beside a store. They change only the head of
/// the first page, which the disk writes as a whole.
pub(crate) fn without_journal(connection: &Connection) -> Result<(), StoreError> {
    connection.pragma_update_and_check(None, "journal_mode", "MEMORY", |_| Ok(()))?;
    Ok(())
}

/// The type of a file, if it is known.
pub(crate) fn mark(connection: &Connection) -> Result<Option<Mark>, StoreError> {
    let id = number(connection, "application_id")?;
    Ok([Mark::Store, Mark::Backup].into_iter().find(|mark| i64::from(mark.id()) == id))
}

/// Whether the first bytes of an SQLite file have one of these marks.
pub(crate) fn is_marked(file: &[u8]) -> bool {
    let ids = [Mark::Store, Mark::Backup].map(|mark| mark.id().to_be_bytes());
    file.get(ID_BYTES).is_some_and(|found| ids.iter().any(|id| id == found))
}

pub(crate) fn put_mark(connection: &Connection, mark: Mark) -> Result<(), StoreError> {
    connection.pragma_update(None, "application_id", mark.id())?;
    Ok(())
}

/// A whole number that SQLite keeps in the file's header.
pub(crate) fn number(connection: &Connection, pragma: &str) -> Result<i64, StoreError> {
    Ok(connection.pragma_query_value(None, pragma, |row| row.get(0))?)
}

/// Refuses a file that is not a store of this schema.
///
/// # Errors
/// [`StoreError::NotAStore`], [`StoreError::NewerSchema`], [`StoreError::Damaged`].
pub(crate) fn check(connection: &Connection, path: &Path) -> Result<(), StoreError> {
    let not_ours = || StoreError::NotAStore { path: path.to_owned() };
    mark(connection)?.ok_or_else(not_ours)?;
    match number(connection, "user_version")? {
        VERSION => Ok(()),
        found if found > VERSION => Err(StoreError::NewerSchema { found, supported: VERSION }),
        _ => Err(StoreError::damaged("its schema")),
    }
}

/// Names and definitions of everything in a database, as SQLite keeps them.
pub(crate) fn definitions(connection: &Connection) -> Result<Vec<(String, String)>, StoreError> {
    let mut query = connection.prepare(
        "SELECT type || ' ' || name, tbl_name || coalesce(sql, '') FROM sqlite_schema ORDER BY 1",
    )?;
    let rows = query.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?;
    Ok(rows.collect::<Result<_, _>>()?)
}

/// The definitions that a store should have.
pub(crate) fn expected_definitions() -> Result<Vec<(String, String)>, StoreError> {
    let mut connection = Connection::open_in_memory()?;
    let transaction = connection.transaction()?;
    build(&transaction)?;
    definitions(&transaction)
}
