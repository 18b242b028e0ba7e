//! The audit log: one hash-chained entry for every change, written in the transaction of the change.
//!
//! An entry's hash is SHA-256 over the hash of the entry before it (64 hexadecimal digits; empty for the first) followed
//! by the entry as compact JSON, `{"sequence":1,"time_ms":0,"actor":"A","action":"begin","object":"reading/1",
//! "digest":"…"}`. The digest is SHA-256 of the changed row after the change: a JSON array of its key and then of all its
//! columns in their order, with bytes as the hash of the bytes. So the log records each change and the present content of
//! every row, which [`Store::verify`](crate::Store::verify) checks.

use rusqlite::types::ValueRef;
use rusqlite::{Connection, OptionalExtension, Params, Row, Statement, Transaction, params};
use serde::Serialize;
use serde_json::Value;
use spineline_files::is_sha256;

use crate::error::StoreError;
use crate::names::{Hash, Signature};

/// Tables whose rows the log covers, each with the word that its objects begin with and its key.
pub(crate) const TABLES: [(&str, &str, &str); 12] = [
    ("contents", "content", "hash"),
    ("studies", "study", "id"),
    ("films", "film", "id"),
    ("readings", "reading", "id"),
    ("withdrawals", "withdrawal", "reading"),
    ("events", "event", "sequence"),
    ("plans", "plan", "id"),
    ("slots", "slot", "code"),
    ("conflicts", "conflict", "id"),
    ("accounts", "account", "name"),
    ("grants", "grant", "id"),
    ("options", "options", "study"),
];

/// Object of an entry without a row.
pub(crate) const WHOLE_STORE: &str = "store";

/// Length of the log and hash of its last entry. A copy outside of the store reveals even a log that was rewritten as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Head {
    /// Number of entries.
    pub entries: u64,
    /// Hash of the last one.
    pub hash: Hash,
}

impl Default for Head {
    /// The head of a log without entries.
    fn default() -> Self {
        Self { entries: 0, hash: Hash(String::new()) }
    }
}

impl Head {
    /// Parses a stored head: a number and 64 hexadecimal digits.
    #[must_use]
    pub fn parse(entries: &str, hash: &str) -> Option<Self> {
        let entries = entries.parse().ok()?;
        is_sha256(hash).then(|| Self { entries, hash: Hash(hash.to_ascii_lowercase()) })
    }
}

impl std::fmt::Display for Head {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.entries, self.hash)
    }
}

/// One entry, in the order of its JSON keys.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AuditEntry {
    /// Place in the log, from 1.
    pub sequence: i64,
    /// Time of the caller's clock in milliseconds since 1970-01-01 UTC.
    pub time_ms: i64,
    /// Who.
    pub actor: String,
    /// Action.
    pub action: String,
    /// Object, such as `film/3`; `store` for the whole store.
    pub object: String,
    /// SHA-256 of the object's row after it; empty for the store as a whole.
    pub digest: String,
}

impl AuditEntry {
    pub(crate) fn read(row: &Row<'_>) -> rusqlite::Result<(Self, String)> {
        let entry = Self {
            sequence: row.get(0)?,
            time_ms: row.get(1)?,
            actor: row.get(2)?,
            action: row.get(3)?,
            object: row.get(4)?,
            digest: row.get(5)?,
        };
        Ok((entry, row.get(6)?))
    }

    pub(crate) fn hash(&self, previous: &str) -> Hash {
        let json = serde_json::to_string(self).expect("strings and integers only");
        Hash::of(format!("{previous}{json}").as_bytes())
    }
}

pub(crate) fn digest(row: &Row<'_>) -> Result<Hash, StoreError> {
    let columns = row.as_ref().column_count();
    let cells = (0..columns).map(|column| {
        Ok(match row.get_ref(column)? {
            ValueRef::Null => Value::Null,
            ValueRef::Integer(integer) => integer.into(),
            ValueRef::Real(_) => return Err(StoreError::Damaged { object: None }),
            ValueRef::Text(text) => {
                std::str::from_utf8(text).map_err(|_| StoreError::Damaged { object: None })?.into()
            }
            ValueRef::Blob(bytes) => Hash::of(bytes).0.into(),
        })
    });
    let cells = cells.collect::<Result<Vec<_>, StoreError>>()?;
    Ok(Hash::of(Value::from(cells).to_string().as_bytes()))
}

/// Start of the actions that export a study to a file and do not change it.
pub(crate) const EXPORT: &str = "export_";

/// The digest of the last entry on an object.
const LAST_DIGEST: &str =
    "SELECT digest FROM audit WHERE object = ?1 ORDER BY sequence DESC LIMIT 1";

/// The digest in the last entry on an object.
pub(crate) fn last_digest(
    connection: &Connection,
    object: &str,
) -> Result<Option<String>, StoreError> {
    sealed(&mut connection.prepare(LAST_DIGEST)?, object)
}

/// The digest in the last entry on an object, by the statement [`LAST_DIGEST`].
fn sealed(statement: &mut Statement<'_>, object: &str) -> Result<Option<String>, StoreError> {
    Ok(statement.query_row([object], |row| row.get(0)).optional()?)
}

/// The end of the log, and the time of its last entry.
pub(crate) fn head(connection: &Connection) -> Result<(Head, i64), StoreError> {
    let (entries, hash, last_ms): (i64, String, i64) =
        connection.query_row("SELECT entries, hash, last_ms FROM head", [], |row| {
            Ok((row.get(0)?, row.get(1)?, row.get(2)?))
        })?;
    Ok((Head { entries: entries.unsigned_abs(), hash: Hash(hash) }, last_ms))
}

/// A running change: its transaction and its author.
pub(crate) struct Ledger<'a> {
    pub transaction: &'a Transaction<'a>,
    pub by: &'a Signature,
}

impl Ledger<'_> {
    /// Records a clock that went back since the last change. The order is by sequence and is not affected.
    pub fn notice_clock(&self) -> Result<(), StoreError> {
        let (_, last_ms) = head(self.transaction)?;
        if self.by.at.unix_ms() < last_ms {
            self.append("clock_went_back", WHOLE_STORE, "")?;
        }
        Ok(())
    }

    /// Records an entry on the whole store.
    pub fn note(&self, action: &str) -> Result<(), StoreError> {
        self.append(action, WHOLE_STORE, "").map(drop)
    }

    /// Records a step that does not change its object. The entry repeats the digest of the last one, so it does not approve
    /// a row that was changed without the log.
    pub fn mention(&self, action: &str, object: &str) -> Result<(), StoreError> {
        let sealed = last_digest(self.transaction, object)?;
        self.append(action, object, &sealed.unwrap_or_default()).map(drop)
    }

    /// Records the current state of a row; returns the entry's sequence number.
    pub fn seal(
        &self,
        action: &str,
        table: &str,
        key: &dyn rusqlite::ToSql,
    ) -> Result<u64, StoreError> {
        let &(_, word, column) = table_named(table);
        let query = format!("SELECT {column}, * FROM {table} WHERE {column} = ?1");
        let mut statement = self.transaction.prepare(&query)?;
        let mut rows = statement.query([key])?;
        let row = rows.next()?.ok_or(StoreError::Damaged { object: None })?;
        self.append(action, &object_of(word, row)?, digest(row)?.as_str())
    }

    fn append(&self, action: &str, object: &str, digest: &str) -> Result<u64, StoreError> {
        let (head, _) = head(self.transaction)?;
        let sequence = head.entries + 1;
        let entry = AuditEntry {
            sequence: i64::try_from(sequence).map_err(|_| StoreError::damaged("head"))?,
            time_ms: self.by.at.unix_ms(),
            actor: self.by.who.to_string(),
            action: action.to_owned(),
            object: object.to_owned(),
            digest: digest.to_owned(),
        };
        let hash = entry.hash(head.hash.as_str());
        let AuditEntry { sequence: number, time_ms, actor, action, object, digest } = entry;
        self.transaction.execute(
            "INSERT INTO audit VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
            params![number, time_ms, actor, action, object, digest, hash.as_str()],
        )?;
        self.transaction.execute(
            "UPDATE head SET entries = ?1, hash = ?2, last_ms = ?3",
            params![number, hash.as_str(), time_ms],
        )?;
        Ok(sequence)
    }
}

/// The object of a row whose key was put before its columns.
pub(crate) fn object_of(word: &str, row: &Row<'_>) -> Result<String, StoreError> {
    match row.get_ref(0)? {
        ValueRef::Integer(key) => Ok(format!("{word}/{key}")),
        ValueRef::Text(key) => Ok(format!("{word}/{}", String::from_utf8_lossy(key))),
        _ => Err(StoreError::damaged(word)),
    }
}

/// Rows of a table, each checked against its last entry in the log; a difference is an error.
pub(crate) fn load<T>(
    connection: &Connection,
    table: &str,
    condition: &str,
    parameters: impl Params,
    mut read: impl FnMut(&Row<'_>) -> Result<T, StoreError>,
) -> Result<Vec<T>, StoreError> {
    let &(_, word, column) = table_named(table);
    let query = format!("SELECT {column}, * FROM {table} {condition}");
    let mut last = connection.prepare(LAST_DIGEST)?;
    let mut statement = connection.prepare(&query)?;
    let mut rows = statement.query(parameters)?;
    let mut loaded = Vec::new();
    while let Some(row) = rows.next()? {
        let object = object_of(word, row)?;
        let digest = digest(row)?;
        if sealed(&mut last, &object)?.as_deref() != Some(digest.as_str()) {
            return Err(StoreError::damaged(object));
        }
        loaded.push(read(row)?);
    }
    Ok(loaded)
}

/// The number of a new row. Rows are never deleted, so that numbers are never used twice.
pub(crate) fn next_id(
    connection: &Connection,
    table: &str,
    column: &str,
) -> Result<i64, StoreError> {
    let query = format!("SELECT coalesce(max({column}), 0) FROM {table}");
    let last: i64 = connection.query_row(&query, [], |row| row.get(0))?;
    last.checked_add(1).ok_or_else(|| StoreError::damaged(table))
}

fn table_named(table: &str) -> &'static (&'static str, &'static str, &'static str) {
    TABLES.iter().find(|known| known.0 == table).expect("a table of the store")
}
