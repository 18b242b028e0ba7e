//! Acceptance: whether a file is a store, whether the log beside it is its log, and whether it ends as its audit log says.
//!
//! SQLite takes any log of the right name for the store's, and writes it into the store. So all of this is checked before anything is
//! written, with a connection that reads the main file and ignores the log.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use rusqlite::{Connection, OptionalExtension};

use crate::audit::{self, AuditEntry, Head, TABLES};
use crate::beside::{HEADS, JOURNAL, LOG, beside, has_content};
use crate::error::StoreError;
use crate::heads::Heads;
use crate::log_file::LogContent;
use crate::names::Hash;
use crate::schema::{self, Mark};
use crate::verify::verify;

/// Opening for writing checks the chain of this number of entries at the end of the log. A file mixed from two versions has a gap
/// where the newer one begins, and SQLite begins a new log after some hundred changes.
const COMPARED_ENTRIES: u64 = 1_000;

/// Accepts a store, with the log beside it, for reading. Nothing is changed. Returns the head that the main file holds alone, unless
/// it cannot be read without the log.
///
/// # Errors
/// [`StoreError::NotAStore`], [`StoreError::NewerSchema`], [`StoreError::Damaged`],
/// [`StoreError::UnfittingLog`].
pub(crate) fn accept(connection: &Connection, path: &Path) -> Result<Option<Head>, StoreError> {
    let unfitting = |end| StoreError::UnfittingLog { log: beside(path, end) };
    if has_content(&beside(path, JOURNAL)) {
        return Err(unfitting(JOURNAL));
    }
    let log = beside(path, LOG);
    let content = LogContent::of(&log);
    let content = content.map_err(|source| StoreError::File { path: log.clone(), source })?;
    if content == LogContent::Torn {
        return Err(unfitting(LOG));
    }
    // The order matters: changes of other programs in between make the later ones newer.
    let heads = Heads::read(path).unwrap_or_default();
    let main = MainFile::read(path);
    if content == LogContent::Nothing {
        return match (schema::check(connection, path), main) {
            // The main file says best which part of it is wrong.
            (
                Ok(()) | Err(StoreError::Damaged { .. } | StoreError::NotAStore { .. }),
                Err(wrong),
            ) => Err(wrong),
            (checked, main) => checked.and(main).map(|main| Some(main.head)),
        };
    }
    let main = match main {
        // After an interrupted checkpoint, the file is complete only with its log.
        Err(StoreError::Damaged { .. }) => None,
        other => Some(other?),
    };
    match fits(connection, path, main.as_ref(), heads.as_ref()) {
        Ok(true) => Ok(main.map(|main| main.head)),
        Ok(false) | Err(StoreError::Damaged { .. } | StoreError::NotAStore { .. }) => {
            Err(unfitting(LOG))
        }
        Err(other) => Err(other),
    }
}

/// Whether the main file with its log continues the main file alone and the known heads.
fn fits(
    connection: &Connection,
    path: &Path,
    main: Option<&MainFile>,
    heads: Option<&Heads>,
) -> Result<bool, StoreError> {
    schema::check(connection, path)?;
    let Some(main) = main else {
        return Ok(verify(connection, heads.map(|heads| &heads.last))?.is_clean());
    };
    let snapshot = connection.unchecked_transaction()?;
    let is_older = heads.is_some_and(|heads| main.head.entries < heads.in_main.entries);
    if main.mark == Mark::Backup || is_older || !continues(&snapshot, &main.head)? {
        return Ok(false);
    }
    heads.map_or(Ok(true), |heads| contains(&snapshot, &heads.last))
}

/// The main file of a store, without the log beside it.
struct MainFile {
    mark: Mark,
    head: Head,
}

impl MainFile {
    /// # Errors
    /// [`StoreError::NotAStore`], [`StoreError::Damaged`].
    fn read(path: &Path) -> Result<Self, StoreError> {
        let read = || {
            let alone = schema::connect_to_main_alone(path)?;
            let mark = schema::mark(&alone)?.ok_or_else(|| not_a_store(path))?;
            Ok(Self { mark, head: audit::head(&alone)?.0 })
        };
        read().map_err(|error| match error {
            StoreError::Damaged { .. } | StoreError::NotAStore { .. } if !is_ours(path) => {
                not_a_store(path)
            }
            StoreError::NotAStore { .. } => StoreError::damaged("its first page"),
            // A table that SQLite does not find.
            StoreError::Database { .. } => StoreError::damaged("its tables"),
            other => other,
        })
    }
}

fn not_a_store(path: &Path) -> StoreError {
    StoreError::NotAStore { path: path.to_owned() }
}

/// Number of bytes that are searched: the definitions of a store are in its first pages.
const LOOKED_AT_BYTES: u64 = 256 << 10;

/// Whether a file that SQLite cannot read, or that has another mark, was a store: it or a file beside it shows this.
fn is_ours(path: &Path) -> bool {
    let mut start = Vec::new();
    let read = File::open(path).and_then(|file| file.take(LOOKED_AT_BYTES).read_to_end(&mut start));
    let holds = |text: &[u8]| start.windows(text.len()).any(|window| window == text);
    read.is_ok()
        && (schema::is_marked(&start)
            || holds(schema::SIGNATURE)
            || has_content(&beside(path, HEADS)))
}

/// Whether the log contains a head.
pub(crate) fn contains(connection: &Connection, head: &Head) -> Result<bool, StoreError> {
    Ok(head.entries == 0
        || hash_of(connection, head.entries)?.as_deref() == Some(head.hash.as_str()))
}

fn hash_of(connection: &Connection, entry: u64) -> Result<Option<String>, StoreError> {
    let query = "SELECT hash FROM audit NOT INDEXED WHERE sequence = ?1";
    let entry = i64::try_from(entry).map_err(|_| StoreError::damaged("head"))?;
    Ok(connection.query_row(query, [entry], |row| row.get(0)).optional()?)
}

/// Whether the log has every entry from a head to its own end, each with its hash.
fn continues(connection: &Connection, from: &Head) -> Result<bool, StoreError> {
    if !contains(connection, from)? {
        return Ok(false);
    }
    let (mut previous, mut last) = (from.hash.as_str().to_owned(), from.entries);
    let query = "SELECT * FROM audit NOT INDEXED WHERE sequence > ?1 ORDER BY sequence";
    let mut query = connection.prepare(query)?;
    let mut entries = query.query([i64::try_from(last).unwrap_or(i64::MAX)])?;
    while let Some(row) = entries.next()? {
        let (entry, hash) = AuditEntry::read(row)?;
        last += 1;
        if i64::try_from(last) != Ok(entry.sequence) || entry.hash(&previous).as_str() != hash {
            return Ok(false);
        }
        previous = hash;
    }
    let (head, _) = audit::head(connection)?;
    Ok(head.entries == last && head.hash.as_str() == previous)
}

/// Compares the end of a store with the end of its audit log: the head, the last entries, and the rows of the last one and of all
/// that came after a head.
pub(crate) fn compare_end(connection: &Connection, after: Option<&Head>) -> Result<(), StoreError> {
    let snapshot = connection.unchecked_transaction()?;
    let at_end = || StoreError::damaged("the end of its log");
    let (head, _) = audit::head(&snapshot)?;
    let start = head.entries.saturating_sub(COMPARED_ENTRIES);
    let from = match start {
        0 => Head::default(),
        _ => Head { entries: start, hash: Hash(hash_of(&snapshot, start)?.ok_or_else(at_end)?) },
    };
    if !continues(&snapshot, &from)? {
        return Err(at_end());
    }
    let query =
        "SELECT object, digest FROM audit WHERE sequence > ?1 AND digest <> '' ORDER BY sequence";
    let mut query = snapshot.prepare(query)?;
    let before_last = head.entries.saturating_sub(1);
    let first = after.map_or(before_last, |after| before_last.min(after.entries));
    let entries = query.query_map([i64::try_from(first).unwrap_or(i64::MAX)], |row| {
        Ok((row.get::<_, String>(0)?, row.get::<_, String>(1)?))
    })?;
    for (object, digest) in entries.collect::<Result<BTreeMap<_, _>, _>>()? {
        let Some((word, key)) = object.split_once('/') else { return Err(at_end()) };
        // The bytes of a film are long, and checked whenever they are read.
        if word == "content" {
            continue;
        }
        let (table, _, column) = TABLES.iter().find(|table| table.1 == word).ok_or_else(at_end)?;
        let condition = format!("WHERE {column} = ?1");
        let rows = audit::load(&snapshot, table, &condition, [key], |_| Ok(()))?;
        if rows.is_empty() || audit::last_digest(&snapshot, &object)?.as_ref() != Some(&digest) {
            return Err(StoreError::damaged(object));
        }
    }
    Ok(())
}
