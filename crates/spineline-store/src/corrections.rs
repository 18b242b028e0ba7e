//! Withdrawn and corrected readings. Both stay in the store and in the log.

use rusqlite::Connection;

use crate::connection::Store;
use crate::error::{StoreError, limit};
use crate::films;
use crate::journal;
use crate::names::{Name, ReadingId, Signature};
use crate::plan;
use crate::readings;
use crate::withdrawals::{self, WithdrawalCause};

/// Maximum length of a reason in characters.
const MAX_REASON: usize = 500;

impl Store {
    /// Withdraws a reading, finished or not: it gets no more landmarks, and results and exports do not use it. Its open correction,
    /// which would bring it back, is withdrawn too, and is returned. Callers check who may.
    ///
    /// # Errors
    /// [`StoreError::PlanRuns`] until all planned readings are finished; [`StoreError::Withdrawn`], [`StoreError::NoReason`],
    /// [`StoreError::TooLarge`], [`StoreError::Archived`], [`StoreError::Unknown`].
    pub fn withdraw_reading(
        &mut self,
        reading: ReadingId,
        reason: &str,
        by: &Signature,
    ) -> Result<Option<ReadingId>, StoreError> {
        let reason = reason.trim();
        limit("the reason (in characters)", reason.chars().count(), MAX_REASON)?;
        if reason.is_empty() {
            return Err(StoreError::NoReason { reading });
        }
        self.write(by, |ledger| {
            let transaction = ledger.transaction;
            let record = readings::not_withdrawn(transaction, reading)?;
            let study = films::film(transaction, record.film)?.study;
            films::open_study(transaction, &study)?;
            plan::need_open(transaction, &study)?;
            let correction = open_correction(transaction, &study, reading)?;
            let cause = WithdrawalCause::Reason(reason.to_owned());
            for withdrawn in std::iter::once(reading).chain(correction) {
                withdrawals::insert(ledger, withdrawn, &cause)?;
            }
            Ok(correction)
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
            let record = readings::not_withdrawn(transaction, reading)?;
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
            if let Some(open) = open_correction(transaction, &study, reading)? {
                return Err(StoreError::Exists { object: open.to_string() });
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

/// The correction of a reading that is neither finished nor withdrawn.
fn open_correction(
    connection: &Connection,
    study: &Name,
    reading: ReadingId,
) -> Result<Option<ReadingId>, StoreError> {
    let all = readings::of_study(connection, study)?;
    let open = all.iter().find(|one| one.corrects == Some(reading) && one.is_open());
    Ok(open.map(|one| one.id))
}
