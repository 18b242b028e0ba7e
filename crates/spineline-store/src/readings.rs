//! Readings: one per observer, film and repeat; begun, written, finished, and then immutable.

use rusqlite::{Connection, Row, ToSql, params};

use crate::audit::{self, Ledger, next_id};
use crate::connection::Store;
use crate::error::StoreError;
use crate::event::Corner;
use crate::films;
use crate::names::{FilmId, Name, ReadingId, Signature, Timestamp};
use crate::state::ReadingState;
use crate::withdrawals::{self, Withdrawal, WithdrawalCause};

/// A reading without its landmarks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadingRecord {
    /// Reading.
    pub id: ReadingId,
    /// Film.
    pub film: FilmId,
    /// Who reads.
    pub observer: Name,
    /// Number of the repeat, from 1.
    pub repeat: u32,
    /// Time of the beginning.
    pub begun_at: Timestamp,
    /// Time of the end.
    pub finished_at: Option<Timestamp>,
    /// For a finished reading, the latest time of work on it: the washout counts from here.
    pub rest_from: Option<Timestamp>,
    /// The reading that it corrects, and replaces when it is finished.
    pub corrects: Option<ReadingId>,
    /// Why it no longer counts.
    pub withdrawn: Option<Withdrawal>,
}

impl ReadingRecord {
    /// Whether results and exports use it.
    #[must_use]
    pub fn counts(&self) -> bool {
        self.finished_at.is_some() && self.withdrawn.is_none()
    }

    /// Whether landmarks can be placed in it.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.finished_at.is_none() && self.withdrawn.is_none()
    }
}

impl Store {
    /// Begins a reading of a study without a plan. The observer is the author.
    ///
    /// # Errors
    /// [`StoreError::PlanGoverns`], [`StoreError::Exists`], [`StoreError::Archived`], [`StoreError::Unknown`]; [`StoreError::BadRepeat`] for
    /// repeat 0, or one that leaves a number out.
    pub fn begin_reading(
        &mut self,
        film: FilmId,
        repeat: u32,
        by: &Signature,
    ) -> Result<ReadingId, StoreError> {
        self.write(by, |ledger| {
            let study = films::film(ledger.transaction, film)?.study;
            if films::is_planned(ledger.transaction, &study)? {
                return Err(StoreError::PlanGoverns { study });
            }
            // A far number would leave no next one for *Read again*.
            let next = last_repeat(ledger, film)?.saturating_add(1);
            if !(1..=next).contains(&repeat) {
                return Err(StoreError::BadRepeat { film, repeat, next });
            }
            begin(ledger, film, repeat)
        })
    }

    /// A reading without its landmarks.
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn reading(&self, id: ReadingId) -> Result<ReadingRecord, StoreError> {
        self::reading(&self.connection, id)
    }

    /// All readings of a study, by film, observer and repeat, without blinding; for readers use [`Store::observer`].
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn readings(&self, study: &Name) -> Result<Vec<ReadingRecord>, StoreError> {
        let snapshot = self.connection.unchecked_transaction()?;
        films::study(&snapshot, study)?;
        of_study(&snapshot, study)
    }
}

/// The last repeat of the author on a film, withdrawn or not; 0 without a reading.
fn last_repeat(ledger: &Ledger<'_>, film: FilmId) -> Result<u32, StoreError> {
    let Ledger { transaction, by } = ledger;
    let condition = "WHERE film = ?1 AND observer = ?2";
    let known =
        audit::load(transaction, "readings", condition, params![film.0, by.who.as_str()], read)?;
    Ok(known.iter().map(|reading| reading.repeat).max().unwrap_or(0))
}

pub(crate) fn begin(
    ledger: &Ledger<'_>,
    film: FilmId,
    repeat: u32,
) -> Result<ReadingId, StoreError> {
    let (transaction, who) = (ledger.transaction, ledger.by.who.as_str());
    let condition = "WHERE film = ?1 AND observer = ?2 AND repeat = ?3";
    let known =
        audit::load(transaction, "readings", condition, params![film.0, who, repeat], read)?;
    if let Some(reading) = known.first() {
        return Err(StoreError::Exists { object: reading.id.to_string() });
    }
    films::open_study(transaction, &films::film(transaction, film)?.study)?;
    insert(ledger, film, repeat, None)
}

/// A new reading of the author, or a correction of another one.
pub(crate) fn insert(
    ledger: &Ledger<'_>,
    film: FilmId,
    repeat: u32,
    corrects: Option<ReadingId>,
) -> Result<ReadingId, StoreError> {
    let Ledger { transaction, by } = ledger;
    let id = next_id(transaction, "readings", "id")?;
    let corrected = corrects.map(|reading| reading.0);
    transaction.execute(
        "INSERT INTO readings VALUES (?1, ?2, ?3, ?4, ?5, NULL, NULL, ?6)",
        params![id, film.0, by.who.as_str(), repeat, by.at.unix_ms(), corrected],
    )?;
    ledger.seal(if corrects.is_some() { "correct" } else { "begin" }, "readings", &id)?;
    Ok(ReadingId(id))
}

/// Finishes a reading in this state, which replaces the one that it corrects; returns the number of its entry in the log.
pub(crate) fn finish(
    ledger: &Ledger<'_>,
    reading: ReadingId,
    state: &ReadingState,
) -> Result<u64, StoreError> {
    for (&level, landmarks) in &state.vertebrae {
        let corners = landmarks.corners.len();
        if corners < Corner::COUNT {
            return Err(StoreError::Incomplete { reading, level, corners });
        }
    }
    let corrected = self::reading(ledger.transaction, reading)?.corrects;
    if let Some(corrected) = corrected {
        not_withdrawn(ledger.transaction, corrected)?;
    }
    ledger.transaction.execute(
        "UPDATE readings SET finished_ms = ?1, rest_from_ms = max(?1, begun_ms,
         (SELECT coalesce(max(time_ms), ?1) FROM events WHERE reading = ?2)) WHERE id = ?2",
        params![ledger.by.at.unix_ms(), reading.0],
    )?;
    let sequence = ledger.seal("finish", "readings", &reading.0)?;
    if let Some(corrected) = corrected {
        withdrawals::insert(ledger, corrected, &WithdrawalCause::CorrectedBy(reading))?;
    }
    Ok(sequence)
}

pub(crate) fn reading(
    connection: &Connection,
    reading: ReadingId,
) -> Result<ReadingRecord, StoreError> {
    let mut found = records(connection, "id = ?1", &reading.0)?;
    found.pop().ok_or_else(|| StoreError::Unknown { object: reading.to_string() })
}

pub(crate) fn not_withdrawn(
    connection: &Connection,
    reading: ReadingId,
) -> Result<ReadingRecord, StoreError> {
    let record = self::reading(connection, reading)?;
    if record.withdrawn.is_some() { Err(StoreError::Withdrawn { reading }) } else { Ok(record) }
}

pub(crate) fn of_study(
    connection: &Connection,
    study: &Name,
) -> Result<Vec<ReadingRecord>, StoreError> {
    records(connection, "film IN (SELECT id FROM films WHERE study = ?1)", &study.as_str())
}

/// Readings with their withdrawals, by film, observer and repeat.
fn records(
    connection: &Connection,
    condition: &str,
    key: &dyn ToSql,
) -> Result<Vec<ReadingRecord>, StoreError> {
    let ordered = format!("WHERE {condition} ORDER BY film, observer, repeat, id");
    let mut found = audit::load(connection, "readings", &ordered, [key], read)?;
    let mut withdrawn = withdrawals::of_readings(connection, condition, key)?;
    for reading in &mut found {
        reading.withdrawn = withdrawn.remove(&reading.id);
    }
    Ok(found)
}

/// A row, without its withdrawal.
fn read(row: &Row<'_>) -> Result<ReadingRecord, StoreError> {
    let id = ReadingId(row.get("id")?);
    let damaged = || StoreError::damaged(id.to_string());
    let time = |ms: i64| Timestamp::from_unix_ms(ms).ok_or_else(damaged);
    let maybe = |ms: Option<i64>| ms.map(time).transpose();
    Ok(ReadingRecord {
        id,
        film: FilmId(row.get("film")?),
        observer: Name::new(&row.get::<_, String>("observer")?)?,
        repeat: row.get("repeat")?,
        begun_at: time(row.get("begun_ms")?)?,
        finished_at: maybe(row.get("finished_ms")?)?,
        rest_from: maybe(row.get("rest_from_ms")?)?,
        corrects: row.get::<_, Option<i64>>("corrects")?.map(ReadingId),
        withdrawn: None,
    })
}

/// Whether proposals may be shown and accepted in a reading: always without a plan.
pub(crate) fn allows_proposals(
    connection: &Connection,
    reading: ReadingId,
) -> Result<bool, StoreError> {
    let forbidden = "SELECT 1 FROM readings JOIN films ON films.id = readings.film
        JOIN plans ON plans.study = films.study WHERE readings.id = ?1 AND plans.proposals = 0
        AND plans.is_current = 1";
    Ok(!connection.prepare(forbidden)?.exists([reading.0])?)
}
