//! Sessions. They are in the store so that they survive a restart of the server; they are not part of the audit log.

use rusqlite::{Connection, OptionalExtension, params};

use crate::connection::Store;
use crate::error::StoreError;
use crate::names::{Hash, Name, Timestamp};
use crate::unsaved::{self, UnsavedSession};

/// Minimum interval between writes of a session's last use, to save disk writes.
const TOUCH_MS: i64 = 60_000;

/// Largest step by which a clock is set back in daily use. A session that is farther in the future was begun or used while the clock was wrong.
const CLOCK_STEP_MS: i64 = 10_000;

spineline::named! {
    /// Way of signing in.
    pub enum Access {
        /// By the token of the terminal.
        Token = "token",
        /// By an account and its password.
        Accounts = "accounts",
    }
}

/// A session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Session {
    /// Observer or account.
    pub name: Name,
    /// Way of signing in.
    pub access: Access,
}

/// When sessions end by themselves. One whose beginning or last use lies in the future is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SessionLimits {
    /// After this long without any request, in milliseconds.
    pub idle_ms: i64,
    /// After this long in any case, in milliseconds.
    pub whole_ms: i64,
}

impl Store {
    /// Begins a session with a secret that only its cookie contains, and deletes ended sessions. On a full disk the session is
    /// in memory.
    ///
    /// # Errors
    /// Errors of writing to the store, except of a full disk.
    pub fn begin_session(
        &mut self,
        secret: &str,
        session: &Session,
        now: Timestamp,
        limits: SessionLimits,
    ) -> Result<(), StoreError> {
        let (now_ms, secret_hash) = (now.unix_ms(), hash(secret));
        let (name, access) = (session.name.clone(), session.access.key());
        let password = unsaved::password(&self.connection, &name)?;
        let begun = UnsavedSession { name, access, begun_ms: now_ms, used_ms: now_ms, password };
        match begin(&mut self.connection, &secret_hash, &begun, limits) {
            Err(error) if error.is_no_room() => self.unsaved.begin(secret_hash, begun),
            begun => begun,
        }
    }

    /// The session of a secret, if it has not ended; updates its last use.
    pub fn session(
        &mut self,
        secret: &str,
        now: Timestamp,
        limits: SessionLimits,
    ) -> Result<Option<Session>, StoreError> {
        let Some((session, used_ms)) = self.session_and_use(secret, now, limits)? else {
            return Ok(None);
        };
        let now_ms = now.unix_ms();
        if now_ms.saturating_sub(used_ms) >= TOUCH_MS {
            if let Some(unsaved) = self.unsaved.begun.get_mut(&hash(secret)) {
                unsaved.used_ms = now_ms;
                return Ok(Some(session));
            }
            let touch = "UPDATE sessions SET used_ms = ?2 WHERE secret_hash = ?1";
            // On a full or read-only disk the session ends early, but reading must still work.
            let _ = self.connection.execute(touch, params![hash(secret), now_ms]);
        }
        Ok(Some(session))
    }

    /// Like [`Store::session`], but without updating its last use.
    pub fn session_unused(
        &self,
        secret: &str,
        now: Timestamp,
        limits: SessionLimits,
    ) -> Result<Option<Session>, StoreError> {
        Ok(self.session_and_use(secret, now, limits)?.map(|(session, _)| session))
    }

    /// A session that has not ended, and when it was last used.
    fn session_and_use(
        &self,
        secret: &str,
        now: Timestamp,
        limits: SessionLimits,
    ) -> Result<Option<(Session, i64)>, StoreError> {
        let (secret_hash, now_ms) = (hash(secret), now.unix_ms());
        if self.unsaved.ended.contains(&secret_hash) {
            return Ok(None);
        }
        let found = match self.unsaved.begun.get(&secret_hash) {
            Some(begun) if begun.password == unsaved::password(&self.connection, &begun.name)? => {
                let (name, access) = (begun.name.to_string(), begun.access.to_owned());
                Some((name, access, begun.begun_ms, begun.used_ms))
            }
            Some(_) => None,
            None => {
                let query =
                    "SELECT name, access, begun_ms, used_ms FROM sessions WHERE secret_hash = ?1";
                let read = |row: &rusqlite::Row<'_>| {
                    Ok((row.get(0)?, row.get::<_, String>(1)?, row.get(2)?, row.get(3)?))
                };
                self.connection.query_row(query, [&secret_hash], read).optional()?
            }
        };
        let Some((name, access, begun_ms, used_ms)) = found else { return Ok(None) };
        let (name, begun_ms, used_ms): (String, i64, i64) = (name, begun_ms, used_ms);
        if is_over(begun_ms, used_ms, now_ms, limits) {
            return Ok(None);
        }
        let access = access.parse().map_err(|_| StoreError::damaged("session"))?;
        Ok(Some((Session { name: Name::new(&name)?, access }, used_ms)))
    }

    /// Ends a session; on a full disk, only while the program runs.
    ///
    /// # Errors
    /// Errors of writing to the store, except of a full disk.
    pub fn end_session(&mut self, secret: &str) -> Result<(), StoreError> {
        let secret_hash = hash(secret);
        match unsaved::delete_session(&self.connection, &secret_hash) {
            Ok(()) => {
                self.unsaved.begun.remove(&secret_hash);
                Ok(())
            }
            Err(error) if error.is_no_room() => {
                self.unsaved.end(secret_hash);
                Ok(())
            }
            Err(error) => Err(error),
        }
    }
}

fn is_over(begun_ms: i64, used_ms: i64, now_ms: i64, limits: SessionLimits) -> bool {
    begun_ms.max(used_ms) > now_ms.saturating_add(CLOCK_STEP_MS)
        || now_ms.saturating_sub(used_ms) >= limits.idle_ms
        || now_ms.saturating_sub(begun_ms) >= limits.whole_ms
}

/// Writes a session, and deletes those that have ended.
fn begin(
    connection: &mut Connection,
    secret_hash: &str,
    begun: &UnsavedSession,
    limits: SessionLimits,
) -> Result<(), StoreError> {
    let now_ms = begun.begun_ms;
    let transaction = connection.transaction()?;
    transaction.execute(
        "DELETE FROM sessions WHERE used_ms <= ?1 OR begun_ms <= ?2 OR max(begun_ms, used_ms) > ?3",
        [
            now_ms.saturating_sub(limits.idle_ms),
            now_ms.saturating_sub(limits.whole_ms),
            now_ms.saturating_add(CLOCK_STEP_MS),
        ],
    )?;
    begun.insert(&transaction, secret_hash)?;
    Ok(transaction.commit()?)
}

/// Ends all sessions of an account.
pub(crate) fn end_all(connection: &Connection, name: &Name) -> Result<(), StoreError> {
    connection.execute("DELETE FROM sessions WHERE name = ?1", [name.as_str()])?;
    Ok(())
}

fn hash(secret: &str) -> String {
    Hash::of(secret.as_bytes()).to_string()
}
