//! Changes of a study's record.

use rusqlite::params;
use serde::{Deserialize, Serialize};
use spineline_files::to_line;
use utoipa::ToSchema;

use crate::conflicts::{Acknowledged, LostChange, keep_lost, lost_changes};
use crate::connection::Store;
use crate::error::StoreError;
use crate::films;
use crate::names::{Name, Signature};

/// A change of a study's record.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
#[schema(as = StudyEditName)]
pub enum StudyEdit {
    /// Give it another label. The identifier stays: the log and the files of the films have it.
    Label {
        /// The label; null for none.
        label: Option<String>,
    },
    /// Archive it, or restore it.
    Archived {
        /// Whether it is archived.
        archived: bool,
    },
}

impl StudyEdit {
    fn action(&self) -> &'static str {
        match self {
            Self::Label { .. } => "rename",
            Self::Archived { archived: true } => "archive",
            Self::Archived { archived: false } => "unarchive",
        }
    }
}

impl Store {
    /// Changes a study's record, if it has the expected revision.
    ///
    /// # Errors
    /// [`StoreError::Conflict`], and then the edit is among [`Store::conflicts_of_study`]; [`StoreError::Archived`] for an archived
    /// study, unless the edit restores it; [`StoreError::NotArchived`] where it restores another one; [`StoreError::TooLarge`] for a
    /// long label; [`StoreError::BadLabel`]; [`StoreError::Unknown`].
    pub fn edit_study(
        &mut self,
        study: &Name,
        edit: &StudyEdit,
        expected_revision: u64,
        by: &Signature,
    ) -> Result<Acknowledged, StoreError> {
        self.write(by, |ledger| {
            let mut now = films::study(ledger.transaction, study)?;
            if now.revision != expected_revision {
                let (object, change) = (format!("study/{study}"), [to_line(edit)]);
                return keep_lost(ledger, object, expected_revision, now.revision, &change)
                    .map(Err);
            }
            match edit {
                StudyEdit::Archived { archived: false } if now.archived => now.archived = false,
                StudyEdit::Archived { archived: false } => {
                    return Err(StoreError::NotArchived { study: now.id });
                }
                _ if now.archived => return Err(StoreError::Archived { study: now.id }),
                StudyEdit::Archived { archived: true } => now.archived = true,
                StudyEdit::Label { label } => {
                    now.label = films::checked_label(label.as_deref())?.map(str::to_owned);
                }
            }
            ledger.transaction.execute(
                "UPDATE studies SET label = ?1, archived = ?2, revision = revision + 1 WHERE id = ?3",
                params![now.label, now.archived, study.as_str()],
            )?;
            let sequence = ledger.seal(edit.action(), "studies", &study.as_str())?;
            Ok(Ok(Acknowledged { sequence, revision: now.revision + 1 }))
        })?
    }

    /// The refused edits of a study, oldest first.
    pub fn conflicts_of_study(&self, study: &Name) -> Result<Vec<LostChange>, StoreError> {
        lost_changes(&self.connection, &format!("study/{study}"), 0)
    }
}
