//! Release of readings that a clock which was ahead has dated into the future: their washout would end years from now.

use rusqlite::{Connection, params};

use crate::connection::Store;
use crate::error::StoreError;
use crate::names::{Name, ReadingId, Signature, Timestamp};
use crate::{films, plan, readings};

/// Action of the entry in the log, on the plan.
const RELEASE: &str = "release";

impl Store {
    /// Ends the washout of all finished readings of a plan whose time lies ahead of the author's clock. An entry `release` of the log has
    /// author and time. Readings with a time in the past, and those that are finished later, keep their washout.
    ///
    /// Returns the number of readings.
    ///
    /// # Errors
    /// [`StoreError::NothingAhead`] where no reading waits for such a time; [`StoreError::Unknown`] for a study without a plan.
    pub fn release_washout(&mut self, study: &Name, by: &Signature) -> Result<usize, StoreError> {
        self.write(by, |ledger| {
            let transaction = ledger.transaction;
            films::study(transaction, study)?;
            let plan = plan::plan_of(transaction, study)?.ok_or_else(|| plan::no_plan(study))?;
            let mut ahead = 0;
            for reading in readings::of_study(transaction, study)? {
                if let Some(rest_from) = reading.rest_from.filter(|&rest_from| by.at < rest_from)
                    && !is_released(transaction, plan.id, reading.id, rest_from)?
                {
                    ahead += 1;
                }
            }
            if ahead == 0 {
                return Err(StoreError::NothingAhead { study: study.clone() });
            }
            ledger.seal(RELEASE, "plans", &plan.id)?;
            Ok(ahead)
        })
    }
}

/// Whether a release followed a finished reading while the clock was behind the time from which the washout counts.
pub(crate) fn is_released(
    connection: &Connection,
    plan: i64,
    reading: ReadingId,
    rest_from: Timestamp,
) -> Result<bool, StoreError> {
    let release =
        "SELECT 1 FROM audit WHERE object = 'plan/' || ?1 AND action = ?2 AND time_ms < ?3
        AND sequence > (SELECT max(sequence) FROM audit WHERE object = ?4)";
    let parameters = params![plan, RELEASE, rest_from.unix_ms(), reading.to_string()];
    Ok(connection.prepare(release)?.exists(parameters)?)
}
