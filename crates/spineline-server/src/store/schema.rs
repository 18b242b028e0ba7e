//! Schemas and the way from each to the next.
//!
//! A new store takes the same steps as an old one, so that there is one definition of every table.

use std::path::Path;

use rusqlite::config::DbConfig;
use rusqlite::{Connection, OpenFlags, Transaction, TransactionBehavior};

use super::StoreError;
use super::audit::{self, Ledger};
use super::names::{Name, Signature, Timestamp};
use super::{backup, verify};

/// `SpSt`, which marks the file as ours.
pub(super) const APPLICATION_ID: i64 = 0x5370_5374;

/// Step *n*, from 1, leads from schema *n* - 1 to schema *n*; an empty file has schema 0.
const STEPS: [&str; 4] = [
    include_str!("schema/v1.sql"),
    include_str!("schema/v2.sql"),
    include_str!("schema/v3.sql"),
    include_str!("schema/v4.sql"),
];

/// The newest schema, which this program writes.
pub(super) const CURRENT: i64 = STEPS.len() as i64;

/// Opens a file that is there, without looking at what it holds.
pub(super) fn connect(path: &Path, flags: OpenFlags) -> Result<Connection, StoreError> {
    let connection = Connection::open_with_flags(path, flags | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
    connection.busy_timeout(super::BUSY_TIMEOUT)?;
    connection.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
    Ok(connection)
}

/// Settings of a connection, which SQLite does not keep in the file.
pub(super) fn settle(connection: &Connection) -> Result<(), StoreError> {
    connection.pragma_update(None, "trusted_schema", false)?;
    connection.pragma_update(None, "cell_size_check", true)?;
    connection.pragma_update(None, "foreign_keys", true)?;
    connection.pragma_update(None, "synchronous", "FULL")?;
    // Without these, an Apple disk may confirm what only its cache holds.
    connection.pragma_update(None, "fullfsync", true)?;
    connection.pragma_update(None, "checkpoint_fullfsync", true)?;
    Ok(())
}

/// Turns an empty database into a store, or does nothing.
///
/// Returns false where the database was not empty.
pub(super) fn create(connection: &mut Connection, by: &Signature) -> Result<bool, StoreError> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let objects: i64 =
        transaction.query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))?;
    if objects > 0 || number(&transaction, "application_id")? != 0 {
        return Ok(false);
    }
    build(&transaction, CURRENT)?;
    transaction.pragma_update(None, "application_id", APPLICATION_ID)?;
    Ledger { transaction: &transaction, by }.note("create")?;
    transaction.commit()?;
    write_ahead(connection)?;
    Ok(true)
}

fn build(transaction: &Transaction<'_>, schema: i64) -> Result<(), StoreError> {
    for (step, sql) in (1..=schema).zip(STEPS) {
        transaction.execute_batch(sql)?;
        if step == 1 {
            transaction.execute("INSERT INTO head VALUES (1, 0, '', ?1)", [i64::MIN])?;
        }
    }
    transaction.pragma_update(None, "user_version", schema)?;
    Ok(())
}

pub(super) fn write_ahead(connection: &Connection) -> Result<(), StoreError> {
    connection.pragma_update_and_check(None, "journal_mode", "WAL", |_| Ok(()))?;
    Ok(())
}

/// A whole number that SQLite keeps in the file's header.
pub(super) fn number(connection: &Connection, pragma: &str) -> Result<i64, StoreError> {
    Ok(connection.pragma_query_value(None, pragma, |row| row.get(0))?)
}

/// The schema of a store.
///
/// # Errors
/// [`StoreError::NotAStore`], [`StoreError::NewerSchema`].
pub(super) fn schema_of(connection: &Connection, path: &Path) -> Result<i64, StoreError> {
    let not_ours = || StoreError::NotAStore { path: path.to_owned() };
    match number(connection, "application_id") {
        Ok(APPLICATION_ID) => {}
        Ok(_) | Err(StoreError::Damaged { .. }) => return Err(not_ours()),
        Err(other) => return Err(other),
    }
    match number(connection, "user_version")? {
        found if found > CURRENT => Err(StoreError::NewerSchema { found, supported: CURRENT }),
        found if found < 1 => Err(not_ours()),
        found => Ok(found),
    }
}

/// Brings an old store to the current schema, after a verified backup. All steps are one transaction.
///
/// The migration is dated like the last entry of the log, since the store has no clock.
pub(super) fn migrate(
    connection: &mut Connection,
    path: &Path,
    found: i64,
) -> Result<(), StoreError> {
    let findings = verify::verify(connection, None)?.findings.len();
    if findings > 0 {
        return Err(StoreError::MigrationRefused { schema: found, findings });
    }
    backup::before_migration(connection, path, found)?;
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    // Another program may have come first.
    let schema = schema_of(&transaction, path)?;
    for (step, sql) in (1..).zip(STEPS) {
        if step > schema {
            transaction.execute_batch(sql)?;
        }
    }
    if schema < CURRENT {
        let (_, last_ms) = audit::head(&transaction)?;
        let at = Timestamp::from_unix_ms(last_ms).ok_or_else(|| StoreError::damaged("head"))?;
        let by = Signature::new(Name::new("spineline")?, at);
        let ledger = Ledger { transaction: &transaction, by: &by };
        ledger.note(&format!("migrate_{schema}_to_{CURRENT}"))?;
        ledger.seal_all("migrate")?;
        transaction.pragma_update(None, "user_version", CURRENT)?;
    }
    transaction.commit()?;
    Ok(())
}

/// Names and definitions of everything in a database of some schema, as SQLite keeps them.
pub(super) fn definitions(connection: &Connection) -> Result<Vec<(String, String)>, StoreError> {
    let mut query = connection.prepare(
        "SELECT type || ' ' || name, tbl_name || coalesce(sql, '') FROM sqlite_schema ORDER BY 1",
    )?;
    let rows = query.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?;
    Ok(rows.collect::<Result<_, _>>()?)
}

/// The definitions that a store of some schema should have.
pub(super) fn expected_definitions(schema: i64) -> Result<Vec<(String, String)>, StoreError> {
    let mut connection = Connection::open_in_memory()?;
    let transaction = connection.transaction()?;
    build(&transaction, schema)?;
    definitions(&transaction)
}
