//! Release of readings that a wrong clock dated into the future: their washout would end years from now.

use crate::connection::Store;
use crate::error::StoreError;
use crate::names::{Name, Signature};
use crate::{films, plan, readings};

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
            let (transaction, now) = (ledger.transaction, ledger.by.at);
            films::open_study(transaction, study)?;
            let plan = plan::plan_of(transaction, study)?.ok_or_else(|| plan::no_plan(study))?;
            let mut ahead = 0;
            for reading in readings::of_study(transaction, study)? {
                if let Some(rest_from) = reading.rest_from.filter(|&rest_from| now < rest_from)
                    && !plan::is_released(transaction, plan.id, reading.id, rest_from)?
                {
                    ahead += 1;
                }
            }
            if ahead == 0 {
                return Err(StoreError::NothingAhead { study: study.clone() });
            }
            ledger.seal(plan::RELEASE, "plans", &plan.id)?;
            Ok(ahead)
        })
    }
}
