//! What finds no room on the disk and must not stop anybody from signing in, reading and exporting: sessions that begin or end,
//! and entries of the log about steps that change nothing. It is in memory until there is room, and lost with the program.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::{Connection, OptionalExtension, Transaction};

use crate::audit::{Ledger, WHOLE_STORE};
use crate::connection::Store;
use crate::error::StoreError;
use crate::names::{Name, Signature, Timestamp};
use crate::sessions::{self, Session};

/// Most entries in memory; further steps are refused as the disk refuses them.
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
    pub session: Session,
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

impl Unsaved {
    fn is_empty(&self) -> bool {
        self.entries.is_empty() && self.begun.is_empty() && self.ended.is_empty()
    }

    /// Writes what found no room. Entries get the time at which there is some, and actions that end in `_late`.
    pub fn save(&self, transaction: &Transaction<'_>, at: Timestamp) -> Result<(), StoreError> {
        for step in &self.entries {
            let by = Signature::new(step.who.clone(), at);
            let action = format!("{}_late", step.action);
            Ledger { transaction, by: &by }.mention(&action, &step.object)?;
        }
        for (hash, begun) in &self.begun {
            if begun.password == password(transaction, &begun.session.name)? {
                sessions::insert(
                    transaction,
                    hash,
                    &begun.session,
                    [begun.begun_ms, begun.used_ms],
                )?;
            }
        }
        for hash in &self.ended {
            sessions::delete(transaction, hash)?;
        }
        Ok(())
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

impl Store {
    /// Writes into the log who did what to an object that the step does not change. Where the disk is full, the entry is written
    /// before the next change that finds room.
    pub(crate) fn log_step(
        &mut self,
        action: &str,
        object: &str,
        by: &Signature,
    ) -> Result<(), StoreError> {
        let logged = self.write(by, |ledger| ledger.mention(action, object));
        match logged {
            Err(error) if error.is_no_room() && self.unsaved.entries.len() < MAX_ENTRIES => {
                let (action, object) = (action.to_owned(), object.to_owned());
                self.unsaved.entries.push(Step { who: by.who.clone(), action, object });
                Ok(())
            }
            logged => logged,
        }
    }

    /// Writes into the log that somebody signed in; the object is `session/NAME`.
    ///
    /// # Errors
    /// Errors of writing, except those of a full disk.
    pub fn log_sign_in(&mut self, by: &Signature) -> Result<(), StoreError> {
        self.log_step("sign_in", &format!("session/{}", by.who), by)
    }

    /// Writes into the log that an attempt to sign in was refused; the object is `session/NAME` for an account of that name, and
    /// the store for others: what is typed as a name may be a password. `unlogged` earlier ones have no entries of their own.
    ///
    /// # Errors
    /// Errors of writing, except those of a full disk.
    pub fn log_refused_sign_in(
        &mut self,
        account: Option<&Name>,
        unlogged: u64,
        by: &Signature,
    ) -> Result<(), StoreError> {
        if unlogged > 0 {
            self.log_step(&format!("{unlogged}_sign_ins_refused"), WHOLE_STORE, by)?;
        }
        let object =
            account.map_or_else(|| WHOLE_STORE.to_owned(), |name| format!("session/{name}"));
        self.log_step("sign_in_refused", &object, by)
    }

    /// Writes what found no room before, if there is some now.
    ///
    /// # Errors
    /// Errors of writing.
    pub fn save_unsaved(&mut self, by: &Signature) -> Result<(), StoreError> {
        if self.unsaved.is_empty() {
            return Ok(());
        }
        self.write(by, |_| Ok(()))
    }
}
