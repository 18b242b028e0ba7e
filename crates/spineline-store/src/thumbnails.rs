//! Thumbnails of films, stored so that no film is decoded for a list.

use rusqlite::{OptionalExtension, params};

use crate::connection::Store;
use crate::error::StoreError;
use crate::names::Hash;

/// A film's thumbnails as picture files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Thumbnails {
    /// Not inverted.
    pub plain: Vec<u8>,
    /// With inverted grey levels.
    pub inverted: Vec<u8>,
}

impl Store {
    /// The thumbnails of a film, if stored.
    pub fn thumbnails(&self, content: &Hash) -> Result<Option<Thumbnails>, StoreError> {
        let query = "SELECT plain, inverted FROM thumbnails WHERE content = ?1";
        let kept = self.connection.query_row(query, [content.as_str()], |row| {
            Ok(Thumbnails { plain: row.get(0)?, inverted: row.get(1)? })
        });
        Ok(kept.optional()?)
    }

    /// Stores the thumbnails of a film. They are derived from its bytes, so they are not part of the audit log.
    ///
    /// # Errors
    /// [`StoreError::Unknown`] for bytes of no film; [`StoreError::Busy`], [`StoreError::ReadOnly`].
    pub fn keep_thumbnails(
        &mut self,
        content: &Hash,
        thumbnails: &Thumbnails,
    ) -> Result<(), StoreError> {
        let statement = "INSERT INTO thumbnails SELECT hash, ?2, ?3 FROM contents WHERE hash = ?1
            ON CONFLICT (content) DO UPDATE SET plain = excluded.plain, inverted = excluded.inverted";
        let Thumbnails { plain, inverted } = thumbnails;
        match self.connection.execute(statement, params![content.as_str(), plain, inverted])? {
            0 => Err(StoreError::Unknown { object: format!("content/{content}") }),
            _ => Ok(()),
        }
    }
}
