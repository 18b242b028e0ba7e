//! Withdrawals and corrections of readings. Both stay in the store and in the log.

use std::collections::BTreeMap;

use rusqlite::{Connection, ToSql, params};

use crate::audit::{self, Ledger};
use crate::connection::Store;
use crate::error::{StoreError, limit};
use crate::films;
use crate::journal;
use crate::names::{Name, ReadingId, Signature, Timestamp};
use crate::plan;
use crate::readings::{self, ReadingRecord};

/// Maximum length of a reason in characters.
const MAX_REASON: usize = 500;

/// Why a reading no longer counts, and who decided it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Withdrawal {
    /// Who.
    pub who: Name,
    /// When.
    pub at: Timestamp,
    /// Why.
    pub cause: WithdrawalCause,
}

/// Why a reading no longer counts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum WithdrawalCause {
    /// The reason of a person.
    Reason(String),
    /// A finished correction replaces it.
    CorrectedBy(ReadingId),
}

impl Store {
    /// Withdraws a reading, finished or not: it gets no more landmarks, and results and exports do not use it. Callers check who may.
    ///
    /// # Errors
    /// [`StoreError::PlanRuns`] until all planned readings are finished; [`StoreError::Withdrawn`], [`StoreError::NoReason`],
    /// [`StoreError::TooLarge`], [`StoreError::Archived`], [`StoreError::Unknown`].
    pub fn withdraw_reading(
        &mut self,
        reading: ReadingId,
        reason: &str,
        by: &Signature,
    ) -> Result<(), StoreError> {
        let reason = reason.trim();
        limit("the reason (in characters)", reason.chars().count(), MAX_REASON)?;
        if reason.is_empty() {
            return Err(StoreError::NoReason { reading });
        }
        self.write(by, |ledger| {
            let record = not_withdrawn(ledger.transaction, reading)?;
            let study = films::film(ledger.transaction, record.film)?.study;
            films::open_study(ledger.transaction, &study)?;
            plan::need_open(ledger.transaction, &study)?;
            insert(ledger, reading, &WithdrawalCause::Reason(reason.to_owned()))
        })
    }

    /// Begins a correction of an own finished reading: a reading of the same observer and repeat with the same events. When it is
    /// finished, the corrected reading is withdrawn.
    ///
    /// # Errors
    /// [`StoreError::PlanGoverns`] for a planned study, because the correction would not be blinded; [`StoreError::Exists`] where a
    /// correction is open; [`StoreError::NotYours`], [`StoreError::NotFinished`], [`StoreError::Withdrawn`],
    /// [`StoreError::Archived`], [`StoreError::Unknown`].
    pub fn correct_reading(
        &mut self,
        reading: ReadingId,
        by: &Signature,
    ) -> Result<ReadingId, StoreError> {
        self.write(by, |ledger| {
            let transaction = ledger.transaction;
            let record = not_withdrawn(transaction, reading)?;
            if record.observer != by.who {
                return Err(StoreError::NotYours { reading });
            }
            if record.finished_at.is_none() {
                return Err(StoreError::NotFinished { reading });
            }
            let study = films::film(transaction, record.film)?.study;
            films::open_study(transaction, &study)?;
            if films::is_planned(transaction, &study)? {
                return Err(StoreError::PlanGoverns { study });
            }
            let all = readings::of_study(transaction, &study)?;
            let is_open = |one: &&ReadingRecord| one.corrects == Some(reading) && one.is_open();
            if let Some(open) = all.iter().find(is_open) {
                return Err(StoreError::Exists { object: open.id.to_string() });
            }
            let correction = readings::insert(ledger, record.film, record.repeat, Some(reading))?;
            let events = journal::events(transaction, reading)?;
            if !events.is_empty() {
                journal::append(ledger, correction, Vec::new(), &events)?;
            }
            Ok(correction)
        })
    }
}

fn not_withdrawn(connection: &Connection, reading: ReadingId) -> Result<ReadingRecord, StoreError> {
    let record = readings::reading(connection, reading)?;
    if record.withdrawn.is_some() { Err(StoreError::Withdrawn { reading }) } else { Ok(record) }
}

/// Withdraws a reading.
pub(crate) fn insert(
    ledger: &Ledger<'_>,
    reading: ReadingId,
    cause: &WithdrawalCause,
) -> Result<(), StoreError> {
    let (reason, corrected_by) = match cause {
        WithdrawalCause::Reason(reason) => (Some(reason), None),
        WithdrawalCause::CorrectedBy(correction) => (None, Some(correction.0)),
    };
    ledger.transaction.execute(
        "INSERT INTO withdrawals VALUES (?1, ?2, ?3, ?4, ?5)",
        params![reading.0, ledger.by.who.as_str(), ledger.by.at.unix_ms(), reason, corrected_by],
    )?;
    let action = if corrected_by.is_some() { "replace" } else { "withdraw" };
    ledger.seal(action, "withdrawals", &reading.0).map(drop)
}

/// The withdrawals of the readings that meet a condition.
pub(crate) fn of_readings(
    connection: &Connection,
    condition: &str,
    key: &dyn ToSql,
) -> Result<BTreeMap<ReadingId, Withdrawal>, StoreError> {
    let condition = format!("WHERE reading IN (SELECT id FROM readings WHERE {condition})");
    let found = audit::load(connection, "withdrawals", &condition, [key], |row| {
        let reading = ReadingId(row.get("reading")?);
        let damaged = || StoreError::damaged(format!("withdrawal/{}", reading.0));
        let reason: Option<String> = row.get("reason")?;
        let corrected_by: Option<i64> = row.get("corrected_by")?;
        let corrected_by = corrected_by.map(|id| WithdrawalCause::CorrectedBy(ReadingId(id)));
        let withdrawal = Withdrawal {
            who: Name::new(&row.get::<_, String>("who")?)?,
            at: Timestamp::from_unix_ms(row.get("time_ms")?).ok_or_else(damaged)?,
            cause: reason.map(WithdrawalCause::Reason).or(corrected_by).ok_or_else(damaged)?,
        };
        Ok((reading, withdrawal))
    });
    Ok(found?.into_iter().collect())
}
