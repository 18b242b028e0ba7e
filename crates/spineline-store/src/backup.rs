//! Complete, flushed and verified copies of a store, which never replace a file.

use std::path::Path;

use rusqlite::backup::{Backup, StepResult};
use rusqlite::{Connection, OpenFlags};

use crate::connection::Store;
use crate::error::StoreError;
use crate::part::{Part, check_free};
use crate::schema::{self, Mark};
use crate::verify::{Verification, verify};

impl Store {
    /// Copies the store, as it is at this moment, into a new file, flushes it to the disk and verifies the copy.
    ///
    /// A damaged store is copied too; the caller checks the result of the verification. A process that is killed here leaves a
    /// `.part` file, which the next copy of this name replaces.
    ///
    /// # Errors
    /// [`StoreError::AlreadyExists`]; [`StoreError::Full`], [`StoreError::File`] and the like, which leave no file.
    pub fn backup_to(&self, path: &Path) -> Result<Verification, StoreError> {
        check_free(path)?;
        let part = Part::of(path)?;
        let verification = fill(&self.connection, &part, Mark::Backup)?;
        part.place_new()?;
        Ok(verification)
    }
}

/// Fills a part with a copy, as one file alone, which can be read from a read-only disk too.
pub(crate) fn fill(
    source: &Connection,
    part: &Part,
    mark: Mark,
) -> Result<Verification, StoreError> {
    let mut copy = schema::connect(part.path(), OpenFlags::SQLITE_OPEN_READ_WRITE)?;
    schema::configure(&copy)?;
    {
        let backup = Backup::new(source, &mut copy)?;
        // All pages in one step are one snapshot.
        if backup.step(-1)? != StepResult::Done {
            return Err(StoreError::Busy);
        }
    }
    copy.pragma_update_and_check(None, "journal_mode", "DELETE", |_| Ok(()))?;
    schema::put_mark(&copy, mark)?;
    let verification = verify(&copy, None)?;
    copy.close().map_err(|(_, error)| error)?;
    Ok(verification)
}
