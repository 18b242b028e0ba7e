//! Acknowledged changes, and refused changes, which are kept too.

use rusqlite::{Connection, params};

use crate::audit::{self, Ledger, next_id};
use crate::connection::Store;
use crate::error::StoreError;
use crate::names::{FilmId, Name, ReadingId, Timestamp};

/// A change that is committed and flushed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Acknowledged {
    /// Number of its entry in the audit log: the order of all changes.
    pub sequence: u64,
    /// Revision of the reading, film, study or options after it.
    pub revision: u64,
}

/// A change that was based on an old revision: kept, not applied.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LostChange {
    /// Number.
    pub id: i64,
    /// Who.
    pub who: Name,
    /// When.
    pub at: Timestamp,
    /// Revision on which the change was based.
    pub base_revision: u64,
    /// Current revision at that time.
    pub found_revision: u64,
    /// The [`Event`](crate::Event), edit, finish or model options, as JSON.
    pub change: String,
}

impl Store {
    /// The refused changes of a reading from this number on, oldest first; zero for all.
    pub fn conflicts_of_reading(
        &self,
        reading: ReadingId,
        first: i64,
    ) -> Result<Vec<LostChange>, StoreError> {
        lost_changes(&self.connection, &reading.to_string(), first)
    }

    /// The refused edits of a film, oldest first.
    pub fn conflicts_of_film(&self, film: FilmId) -> Result<Vec<LostChange>, StoreError> {
        lost_changes(&self.connection, &film.to_string(), 0)
    }
}

/// Stores refused changes; returns the error that names the first.
pub(crate) fn keep_lost(
    ledger: &Ledger<'_>,
    object: String,
    expected: u64,
    found: u64,
    changes: &[String],
) -> Result<StoreError, StoreError> {
    let conflict = next_id(ledger.transaction, "conflicts", "id")?;
    let by = ledger.by;
    for (id, change) in (conflict..).zip(changes) {
        ledger.transaction.execute(
            "INSERT INTO conflicts VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
            params![
                id,
                object,
                by.who.as_str(),
                by.at.unix_ms(),
                // A caller may name any revision.
                i64::try_from(expected).unwrap_or(i64::MAX),
                signed(found)?,
                change
            ],
        )?;
        ledger.seal("keep_conflict", "conflicts", &id)?;
    }
    Ok(StoreError::Conflict { object, expected, found, conflict })
}

pub(crate) fn lost_changes(
    connection: &Connection,
    object: &str,
    first: i64,
) -> Result<Vec<LostChange>, StoreError> {
    let condition = "WHERE object = ?1 AND id >= ?2 ORDER BY id";
    audit::load(connection, "conflicts", condition, params![object, first], |row| {
        let id: i64 = row.get("id")?;
        let at = Timestamp::from_unix_ms(row.get("time_ms")?);
        Ok(LostChange {
            id,
            who: Name::new(&row.get::<_, String>("actor")?)?,
            at: at.ok_or_else(|| StoreError::damaged(format!("conflict/{id}")))?,
            base_revision: row.get::<_, i64>("base_revision")?.unsigned_abs(),
            found_revision: row.get::<_, i64>("found_revision")?.unsigned_abs(),
            change: row.get("change")?,
        })
    })
}

/// A revision as the database holds it.
pub(crate) fn signed(revision: u64) -> Result<i64, StoreError> {
    i64::try_from(revision).map_err(|_| StoreError::damaged("events"))
}
