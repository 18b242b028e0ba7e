//! Sessions that begin or end, and entries of the log about steps that change nothing, while the disk is full: a full disk must
//! not stop anybody from signing in, reading and exporting. They stay in memory until there is room, and are lost with the
//! program.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::{Connection, OptionalExtension, Transaction, params};

use crate::audit::Ledger;
use crate::error::StoreError;
use crate::names::{Name, Signature, Timestamp};

/// Maximum number of entries in memory; further steps fail with the error of the disk.
const MAX_ENTRIES: usize = 10_000;
/// Most sessions in memory.
const MAX_SESSIONS: usize = 10_000;

/// What is in memory only, through one connection.
#[derive(Debug, Default)]
pub(crate) struct Unsaved {
    entries: Vec<Step>,
    /// Sessions that began without room, by the hash of their secret.
    pub begun: BTreeMap<String, UnsavedSession>,
    /// Hashes of the secrets of sessions that ended without room.
    pub ended: BTreeSet<String>,
}

/// A session that is not on the disk.
#[derive(Debug, Clone)]
pub(crate) struct UnsavedSession {
    pub name: Name,
    /// Key of the way of signing in.
    pub access: &'static str,
    pub begun_ms: i64,
    pub used_ms: i64,
    /// Stored form of the account's password: another one ends the session, whichever program wrote it.
    pub password: Option<String>,
}

/// A step that changes nothing, for the log.
#[derive(Debug, Clone)]
struct Step {
    who: Name,
    action: String,
    object: String,
}

impl UnsavedSession {
    /// Writes its row.
    pub fn insert(&self, connection: &Connection, secret_hash: &str) -> Result<(), StoreError> {
        connection.execute(
            "INSERT INTO sessions VALUES (?1, ?2, ?3, ?4, ?5)",
            params![secret_hash, self.name.as_str(), self.access, self.begun_ms, self.used_ms],
        )?;
        Ok(())
    }
}

/// Deletes the row of a session.
pub(crate) fn delete_session(connection: &Connection, secret_hash: &str) -> Result<(), StoreError> {
    connection.execute("DELETE FROM sessions WHERE secret_hash = ?1", [secret_hash])?;
    Ok(())
}

impl Unsaved {
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty() && self.begun.is_empty() && self.ended.is_empty()
    }

    /// Writes the kept entries. They get the time of writing, and their actions end in `_late`.
    pub fn save(&self, transaction: &Transaction<'_>, at: Timestamp) -> Result<(), StoreError> {
        for step in &self.entries {
            let by = Signature::new(step.who.clone(), at);
            let action = format!("{}_late", step.action);
            Ledger { transaction, by: &by }.mention(&action, &step.object)?;
        }
        for (hash, begun) in &self.begun {
            if begun.password == password(transaction, &begun.name)? {
                begun.insert(transaction, hash)?;
            }
        }
        for hash in &self.ended {
            delete_session(transaction, hash)?;
        }
        Ok(())
    }

    /// Keeps an entry that found no room; false where there are too many.
    pub fn log(&mut self, action: &str, object: &str, who: &Name) -> bool {
        let has_room = self.entries.len() < MAX_ENTRIES;
        if has_room {
            let (action, object) = (action.to_owned(), object.to_owned());
            self.entries.push(Step { who: who.clone(), action, object });
        }
        has_room
    }

    /// Keeps a session that found no room.
    pub fn begin(&mut self, hash: String, session: UnsavedSession) -> Result<(), StoreError> {
        if self.begun.len() >= MAX_SESSIONS {
            return Err(StoreError::Full);
        }
        self.begun.insert(hash, session);
        Ok(())
    }

    /// Ends a session whose row may be on a disk that takes no change.
    pub fn end(&mut self, hash: String) {
        self.begun.remove(&hash);
        if self.ended.len() < MAX_SESSIONS {
            self.ended.insert(hash);
        }
    }
}

/// Stored form of an account's password, as text for comparison; `None` for names without an account.
pub(crate) fn password(connection: &Connection, name: &Name) -> Result<Option<String>, StoreError> {
    let query = "SELECT password FROM accounts WHERE name = ?1";
    Ok(connection.query_row(query, [name.as_str()], |row| row.get(0)).optional()?)
}
