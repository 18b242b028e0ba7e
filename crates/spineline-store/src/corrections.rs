//! Withdrawn and corrected readings. Both stay in the store and in the log.

use rusqlite::Connection;

use crate::connection::Store;
use crate::error::{StoreError, limit};
use crate::films;
use crate::journal;
use crate::names::{ReadingId, Signature};
use crate::plan;
use crate::readings::{self, ReadingRecord};
use crate::withdrawals::{self, WithdrawalCause};

/// Maximum length of a reason in characters.
const MAX_REASON: usize = 500;

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
            withdrawals::insert(ledger, reading, &WithdrawalCause::Reason(reason.to_owned()))
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
