//! Withdrawals of readings. Both stay in the store and in the log.

use std::collections::BTreeMap;

use rusqlite::{Connection, ToSql, params};

use crate::audit::{self, Ledger};
use crate::error::StoreError;
use crate::names::{Name, ReadingId, Timestamp};

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
