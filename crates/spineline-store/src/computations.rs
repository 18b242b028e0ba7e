//! Results of long computations on a study, kept so that they are not computed again.

use rusqlite::{OptionalExtension, params};

use crate::conflicts::signed;
use crate::connection::Store;
use crate::error::StoreError;
use crate::names::{Hash, Name};

/// A finished computation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeptComputation {
    /// Steps that were asked for.
    pub asked: u64,
    /// Its result, as text.
    pub found: String,
    digest: String,
}

impl KeptComputation {
    /// A computation from these inputs.
    #[must_use]
    pub fn new(inputs: &str, asked: u64, found: String) -> Self {
        let digest = digest(inputs, asked, &found);
        Self { asked, found, digest }
    }

    /// Whether it was computed from these inputs and is unchanged.
    #[must_use]
    pub fn is_of(&self, inputs: &str) -> bool {
        self.digest == digest(inputs, self.asked, &self.found)
    }
}

fn digest(inputs: &str, asked: u64, found: &str) -> String {
    Hash::of(format!("{}\n{asked}\n{found}", Hash::of(inputs.as_bytes())).as_bytes()).to_string()
}

impl Store {
    /// The last kept computation of a kind.
    pub fn computation(
        &self,
        study: &Name,
        kind: &str,
    ) -> Result<Option<KeptComputation>, StoreError> {
        let query = "SELECT asked, found, digest FROM computations WHERE study = ?1 AND kind = ?2";
        let kept = self.connection.query_row(query, params![study.as_str(), kind], |row| {
            Ok(KeptComputation {
                asked: row.get::<_, i64>(0)?.unsigned_abs(),
                found: row.get(1)?,
                digest: row.get(2)?,
            })
        });
        Ok(kept.optional()?)
    }

    /// Keeps a computation in place of an earlier one of its kind. It can be computed again, so it is not part of the audit log.
    ///
    /// # Errors
    /// [`StoreError::Unknown`] for the study; [`StoreError::Busy`], [`StoreError::ReadOnly`].
    pub fn keep_computation(
        &mut self,
        study: &Name,
        kind: &str,
        kept: &KeptComputation,
    ) -> Result<(), StoreError> {
        self.study(study)?;
        self.connection.execute(
            "INSERT INTO computations VALUES (?1, ?2, ?3, ?4, ?5) ON CONFLICT (study, kind) DO UPDATE
            SET asked = excluded.asked, digest = excluded.digest, found = excluded.found",
            params![study.as_str(), kind, signed(kept.asked)?, kept.digest, kept.found],
        )?;
        Ok(())
    }
}
