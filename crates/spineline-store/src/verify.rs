//! Verification of a store: every row against the log, the log's hash chain, and SQLite's check of the file.

use std::collections::BTreeMap;

use rusqlite::Connection;

use crate::audit::{self, AuditEntry, Head, TABLES};
use crate::error::StoreError;
use crate::names::Hash;
use crate::schema;

/// A detected change or damage. It never quotes stored values.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Finding {
    /// SQLite's own check of pages, indices and constraints.
    #[error("the file itself is damaged: {message}")]
    Integrity {
        /// SQLite's message, which names tables and pages.
        message: String,
    },
    /// A reference to a missing row.
    #[error("a row of `{table}` refers to a missing row")]
    ForeignKey {
        /// Table of the reference.
        table: String,
    },
    /// A part that cannot be read at all.
    #[error("{part} cannot be read")]
    Unreadable {
        /// Which part.
        part: &'static str,
    },
    /// A table, index or trigger that is not the one of this schema.
    #[error("the definition of {name} differs from the schema")]
    Definition {
        /// Kind and name.
        name: String,
    },
    /// A missing entry of the log.
    #[error("entry {sequence} of the log is missing")]
    EntryMissing {
        /// Its sequence number.
        sequence: i64,
    },
    /// An entry whose hash does not match it and the entry before: edited, swapped or moved.
    #[error("entry {sequence} of the log was edited, exchanged or moved")]
    EntryChanged {
        /// Its sequence number.
        sequence: i64,
    },
    /// The log is shorter than it was, or longer than it may be.
    #[error("the number of log entries is {found} instead of {expected}")]
    Length {
        /// Expected number of entries.
        expected: u64,
        /// Number of entries found.
        found: u64,
    },
    /// The end of the log differs from its head.
    #[error("the end of the log differs from its head")]
    HeadChanged,
    /// The log does not contain the external head: it was rewritten.
    #[error("the log does not contain the given head: the log was rewritten")]
    Rewritten,
    /// The log lacks the last change that was acknowledged: it was lost, or an earlier copy is in the store's place.
    #[error(
        "the store went back: its log does not contain entry {acknowledged}, which was acknowledged (see the file beside it that ends in `-head`)"
    )]
    WentBack {
        /// Number of entries up to that change.
        acknowledged: u64,
    },
    /// A row of the log is missing.
    #[error("{object} is missing")]
    RowMissing {
        /// Such as `event/17`.
        object: String,
    },
    /// A row differs from its last entry.
    #[error("{object} differs from its entry in the log")]
    RowChanged {
        /// Such as `event/17`.
        object: String,
    },
    /// A row without an entry.
    #[error("{object} is in no entry of the log")]
    RowUnknown {
        /// Such as `event/17`.
        object: String,
    },
    /// The bytes of a film do not match its hash.
    #[error("the bytes of a film do not match its hash {content}")]
    ContentChanged {
        /// The hash.
        content: Hash,
    },
}

/// Result of a verification.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verification {
    /// The head of the log, to be kept outside of the store.
    pub head: Option<Head>,
    /// All findings; empty for an undamaged store.
    pub findings: Vec<Finding>,
}

impl Verification {
    /// Whether the verification has no findings.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.findings.is_empty()
    }
}

type Check = fn(&Connection, &mut Vec<Finding>) -> Result<(), StoreError>;

pub(crate) fn verify(
    connection: &Connection,
    known: Option<&Head>,
) -> Result<Verification, StoreError> {
    // One snapshot for all parts, independent of concurrent writes.
    let snapshot = connection.unchecked_transaction()?;
    let checks: [(&'static str, Check); 5] = [
        ("file", integrity),
        ("definitions", definitions),
        ("references", foreign_keys),
        ("contents", contents),
        ("rows", rows),
    ];
    let mut findings = Vec::new();
    for (part, check) in checks {
        let outcome = check(&snapshot, &mut findings);
        unreadable(outcome, part, &mut findings)?;
    }
    let outcome = chain(&snapshot, known, &mut findings);
    unreadable(outcome, "log", &mut findings)?;
    let head = audit::head(&snapshot).ok().map(|(head, _)| head);
    Ok(Verification { head, findings })
}

/// Damage that stops a check is a finding; anything else is an error.
fn unreadable(
    outcome: Result<(), StoreError>,
    part: &'static str,
    findings: &mut Vec<Finding>,
) -> Result<(), StoreError> {
    match outcome {
        Err(StoreError::Damaged { .. } | StoreError::Database { .. } | StoreError::Disk { .. }) => {
            findings.push(Finding::Unreadable { part });
            Ok(())
        }
        other => other,
    }
}

fn integrity(connection: &Connection, findings: &mut Vec<Finding>) -> Result<(), StoreError> {
    let mut query = connection.prepare("PRAGMA integrity_check(20)")?;
    let mut rows = query.query([])?;
    while let Some(row) = rows.next()? {
        let message: String = row.get(0)?;
        if message != "ok" {
            findings.push(Finding::Integrity { message });
        }
    }
    Ok(())
}

fn definitions(connection: &Connection, findings: &mut Vec<Finding>) -> Result<(), StoreError> {
    let expected = schema::expected_definitions()?;
    let mut expected = expected.into_iter().collect::<BTreeMap<_, _>>();
    for (name, sql) in schema::definitions(connection)? {
        if expected.remove(&name) != Some(sql) {
            findings.push(Finding::Definition { name });
        }
    }
    findings.extend(expected.into_keys().map(|name| Finding::Definition { name }));
    Ok(())
}

fn foreign_keys(connection: &Connection, findings: &mut Vec<Finding>) -> Result<(), StoreError> {
    let mut query = connection.prepare("PRAGMA foreign_key_check")?;
    let tables = query.query_map([], |row| row.get(0))?;
    for table in tables {
        findings.push(Finding::ForeignKey { table: table? });
    }
    Ok(())
}

fn contents(connection: &Connection, findings: &mut Vec<Finding>) -> Result<(), StoreError> {
    let mut query = connection.prepare("SELECT hash, bytes FROM contents ORDER BY hash")?;
    let mut rows = query.query([])?;
    while let Some(row) = rows.next()? {
        let content = Hash(row.get(0)?);
        let bytes = row.get_ref(1)?.as_blob().map_err(|_| StoreError::damaged("contents"))?;
        if Hash::of(bytes) != content {
            findings.push(Finding::ContentChanged { content });
        }
    }
    Ok(())
}

/// Every row against the last entry about it.
fn rows(connection: &Connection, findings: &mut Vec<Finding>) -> Result<(), StoreError> {
    let mut sealed = BTreeMap::new();
    let mut query = connection.prepare("SELECT object, digest FROM audit ORDER BY sequence")?;
    let mut entries = query.query([])?;
    while let Some(row) = entries.next()? {
        let (object, digest): (String, String) = (row.get(0)?, row.get(1)?);
        if !digest.is_empty() {
            sealed.insert(object, digest);
        }
    }
    for (table, word, column) in TABLES {
        // Each row of a dropped table is reported as missing.
        if !schema::has_table(connection, table)? {
            continue;
        }
        let mut query =
            connection.prepare(&format!("SELECT {column}, * FROM {table} NOT INDEXED"))?;
        let mut rows = query.query([])?;
        while let Some(row) = rows.next()? {
            let object = audit::object_of(word, row)?;
            let digest = audit::digest(row)?;
            match sealed.remove(&object) {
                Some(expected) if expected == digest.as_str() => {}
                Some(_) => findings.push(Finding::RowChanged { object }),
                None => findings.push(Finding::RowUnknown { object }),
            }
        }
    }
    findings.extend(sealed.into_keys().map(|object| Finding::RowMissing { object }));
    Ok(())
}

/// Checks the log's chain, its head and an external head.
fn chain(
    connection: &Connection,
    known: Option<&Head>,
    findings: &mut Vec<Finding>,
) -> Result<(), StoreError> {
    let mut query = connection.prepare("SELECT * FROM audit NOT INDEXED ORDER BY sequence")?;
    let mut entries = query.query([])?;
    let (mut previous, mut found, mut expected, mut last_ms) = (String::new(), 0, 1, i64::MIN);
    let mut contains_known = known.is_none_or(|known| known.entries == 0);
    while let Some(row) = entries.next()? {
        let (entry, hash) = AuditEntry::read(row)?;
        // A wide gap is reported by its first entry only.
        if entry.sequence != expected {
            findings.push(Finding::EntryMissing { sequence: expected });
        }
        if entry.hash(&previous).as_str() != hash {
            findings.push(Finding::EntryChanged { sequence: entry.sequence });
        }
        contains_known |= known.is_some_and(|known| {
            i64::try_from(known.entries) == Ok(entry.sequence) && known.hash.as_str() == hash
        });
        expected = entry.sequence.saturating_add(1);
        last_ms = entry.time_ms;
        previous = hash;
        found += 1;
    }
    let (head, head_last_ms) = audit::head(connection)?;
    if head.entries != found {
        findings.push(Finding::Length { expected: head.entries, found });
    }
    if head.hash.as_str() != previous || head_last_ms != last_ms {
        findings.push(Finding::HeadChanged);
    }
    if !contains_known {
        findings.push(Finding::Rewritten);
    }
    Ok(())
}
