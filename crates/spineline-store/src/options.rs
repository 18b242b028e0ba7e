//! Model options of a study.

use rusqlite::{Connection, params};
use spineline_files::method_text::ChosenOptions;

use crate::audit;
use crate::conflicts::{Acknowledged, LostChange, keep_lost, lost_changes, signed};
use crate::connection::Store;
use crate::error::StoreError;
use crate::films;
use crate::names::{Name, Signature};

/// The options with which a study is analysed.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct StudyOptions {
    /// What differs from the defaults.
    pub chosen: ChosenOptions,
    /// Number of changes.
    pub revision: u64,
}

impl Store {
    /// The model options of a study.
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn study_options(&self, study: &Name) -> Result<StudyOptions, StoreError> {
        films::study(&self.connection, study)?;
        of_study(&self.connection, study)
    }

    /// Changes the model options of a study, if they have the expected revision; none resets them.
    ///
    /// # Errors
    /// [`StoreError::Conflict`], and then the change is among [`Store::conflicts_of_options`]; [`StoreError::Archived`],
    /// [`StoreError::Unknown`].
    pub fn set_study_options(
        &mut self,
        study: &Name,
        chosen: &ChosenOptions,
        expected_revision: u64,
        by: &Signature,
    ) -> Result<Acknowledged, StoreError> {
        self.write(by, |ledger| {
            films::open_study(ledger.transaction, study)?;
            let now = of_study(ledger.transaction, study)?;
            let json = serde_json::to_string(chosen).expect("names and values are texts");
            if now.revision != expected_revision {
                return keep_lost(ledger, object(study), expected_revision, now.revision, &[json])
                    .map(Err);
            }
            let revision = now.revision + 1;
            ledger.transaction.execute(
                "INSERT INTO options VALUES (?1, ?2, ?3) ON CONFLICT (study)
                DO UPDATE SET chosen = excluded.chosen, revision = excluded.revision",
                params![study.as_str(), json, signed(revision)?],
            )?;
            let action = if chosen.all().is_empty() { "reset" } else { "edit" };
            let sequence = ledger.seal(action, "options", &study.as_str())?;
            Ok(Ok(Acknowledged { sequence, revision }))
        })?
    }

    /// The refused changes of a study's model options, oldest first. Each has all options that were wanted.
    pub fn conflicts_of_options(&self, study: &Name) -> Result<Vec<LostChange>, StoreError> {
        lost_changes(&self.connection, &object(study), 0)
    }
}

/// The name of a study's options among refused changes.
fn object(study: &Name) -> String {
    format!("options/{study}")
}

/// The options of a study that exists.
pub(crate) fn of_study(connection: &Connection, study: &Name) -> Result<StudyOptions, StoreError> {
    let rows = audit::load(connection, "options", "WHERE study = ?1", [study.as_str()], |row| {
        let chosen = serde_json::from_str(&row.get::<_, String>("chosen")?);
        Ok(StudyOptions {
            chosen: chosen.map_err(|_| StoreError::damaged(object(study)))?,
            revision: row.get::<_, i64>("revision")?.unsigned_abs(),
        })
    })?;
    Ok(rows.into_iter().next().unwrap_or_default())
}
