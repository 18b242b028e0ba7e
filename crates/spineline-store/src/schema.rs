//! The tables of a store, and the recognition of a store file.
//!
//! The schema is version 4. Version 1 was that of development builds, and its stores are refused. `schema_3.sql` leads from version 2
//! to 3 and `schema_4.sql` to 4: a new store runs all scripts, and [`Store::open`](crate::Store::open) runs those that an older store lacks, in
//! one transaction. They only add tables and indices. [`Store::view`](crate::Store::view) reads an older store as it is. A script that changes rows
//! would need a copy of the store and new log entries for them.

use std::path::Path;
use std::time::Duration;

use rusqlite::config::DbConfig;
use rusqlite::{Connection, OpenFlags, Transaction, TransactionBehavior};

use crate::audit::Ledger;
use crate::error::StoreError;
use crate::names::Signature;

/// `SpSt`, the application identifier of store files.
const APPLICATION_ID: i64 = 0x5370_5374;

/// The definition of every table of version 2.
const SCHEMA: &str = include_str!("schema.sql");

/// What every later version adds, from version 3.
const ADDED: [&str; 2] = [include_str!("schema_3.sql"), include_str!("schema_4.sql")];

/// The version that this program writes.
const VERSION: i64 = OLDEST + ADDED.len() as i64;

/// The oldest version that it reads.
const OLDEST: i64 = 2;

/// Default time that a write waits for another program.
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);

/// Opens an existing file without checks of its content.
pub(crate) fn connect(path: &Path, flags: OpenFlags) -> Result<Connection, StoreError> {
    let connection = Connection::open_with_flags(path, flags | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
    connection.busy_timeout(BUSY_TIMEOUT)?;
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
    Ok(connection)
}

/// Settings of a connection, which SQLite does not keep in the file.
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

/// Turns an empty database into a store, or does nothing.
///
/// Returns false where the database was not empty.
pub(crate) fn create(connection: &mut Connection, by: &Signature) -> Result<bool, StoreError> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let objects: i64 =
        transaction.query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))?;
    if objects > 0 || number(&transaction, "application_id")? != 0 {
        return Ok(false);
    }
    build(&transaction, VERSION)?;
    transaction.pragma_update(None, "application_id", APPLICATION_ID)?;
    Ledger { transaction: &transaction, by }.note("create")?;
    transaction.commit()?;
    write_ahead(connection)?;
    Ok(true)
}

fn build(transaction: &Transaction<'_>, version: i64) -> Result<(), StoreError> {
    transaction.execute_batch(SCHEMA)?;
    transaction.execute("INSERT INTO head VALUES (1, 0, '', ?1)", [i64::MIN])?;
    transaction.pragma_update(None, "user_version", OLDEST)?;
    add(transaction, OLDEST, version)
}

/// Leads a store from one version to a later one.
fn add(transaction: &Transaction<'_>, from: i64, to: i64) -> Result<(), StoreError> {
    for (version, script) in (OLDEST + 1..=to).zip(ADDED) {
        if version > from {
            transaction.execute_batch(script)?;
            transaction.pragma_update(None, "user_version", version)?;
        }
    }
    Ok(())
}

/// Brings a store of an older version, which [`check`] accepts, to this one; no effect on others.
///
/// # Errors
/// [`StoreError::Full`], [`StoreError::Busy`] and the like, which change nothing.
pub(crate) fn upgrade(connection: &mut Connection) -> Result<(), StoreError> {
    if number(connection, "user_version")? == VERSION {
        return Ok(());
    }
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    // Another program may have done it meanwhile.
    let found = number(&transaction, "user_version")?;
    add(&transaction, found, VERSION)?;
    Ok(transaction.commit()?)
}

/// Whether a store has this table: an older one lacks some while it is only viewed.
pub(crate) fn has_table(connection: &Connection, table: &str) -> Result<bool, StoreError> {
    Ok(connection.prepare("SELECT 1 FROM sqlite_schema WHERE name = ?1")?.exists([table])?)
}

pub(crate) fn write_ahead(connection: &Connection) -> Result<(), StoreError> {
    connection.pragma_update_and_check(None, "journal_mode", "WAL", |_| Ok(()))?;
    Ok(())
}

/// A whole number that SQLite keeps in the file's header.
pub(crate) fn number(connection: &Connection, pragma: &str) -> Result<i64, StoreError> {
    Ok(connection.pragma_query_value(None, pragma, |row| row.get(0))?)
}

/// Refuses a file that is not a store of this schema.
///
/// # Errors
/// [`StoreError::NotAStore`], [`StoreError::NewerSchema`], [`StoreError::OlderSchema`].
pub(crate) fn check(connection: &Connection, path: &Path) -> Result<(), StoreError> {
    let not_ours = || StoreError::NotAStore { path: path.to_owned() };
    match number(connection, "application_id") {
        Ok(APPLICATION_ID) => {}
        Ok(_) | Err(StoreError::Damaged { .. }) => return Err(not_ours()),
        Err(other) => return Err(other),
    }
    match number(connection, "user_version")? {
        OLDEST..=VERSION => Ok(()),
        found if found > VERSION => Err(StoreError::NewerSchema { found, supported: VERSION }),
        found if found > 0 => Err(StoreError::OlderSchema { found, supported: VERSION }),
        _ => Err(not_ours()),
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

/// The definitions that a store of this version should have.
pub(crate) fn expected_definitions(version: i64) -> Result<Vec<(String, String)>, StoreError> {
    let mut connection = Connection::open_in_memory()?;
    let transaction = connection.transaction()?;
    build(&transaction, version)?;
    definitions(&transaction)
}
