//! Every click, kept; and the clicks that lost a race, kept too.

use rusqlite::{Connection, params};
use serde::{Deserialize, Serialize};
use spineline_files::LevelKey;
use utoipa::ToSchema;

use super::audit::{self, Ledger};
use super::films::limit;
use super::names::{FilmId, Name, ReadingId, Signature, Timestamp};
use super::readings::{self, ReadingRecord};
use super::state::ReadingState;
use super::{Store, StoreError};

/// Longest note, in characters.
const LONGEST_NOTE: usize = 4_000;
/// Most events in one step; a whole film has fewer than a hundred.
const MOST_EVENTS: usize = 500;

/// A corner of a vertebral body, by endplate and by the patient's side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Corner {
    /// Superior endplate, patient's left.
    SuperiorLeft,
    /// Superior endplate, patient's right.
    SuperiorRight,
    /// Inferior endplate, patient's left.
    InferiorLeft,
    /// Inferior endplate, patient's right.
    InferiorRight,
}

impl Corner {
    /// All four.
    pub const ALL: [Self; 4] =
        [Self::SuperiorLeft, Self::SuperiorRight, Self::InferiorLeft, Self::InferiorRight];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::SuperiorLeft => "superior_left",
            Self::SuperiorRight => "superior_right",
            Self::InferiorLeft => "inferior_left",
            Self::InferiorRight => "inferior_right",
        }
    }
}

/// The patient's side of an iliac crest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CrestSide {
    /// The patient's left.
    Left,
    /// The patient's right.
    Right,
}

/// One thing that a reader did, as JSON with a `kind`. Places are in pixels of the film, column and row, sub-pixel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Event {
    /// A corner set, wherever it was before.
    PlaceCorner {
        /// Vertebra.
        #[schema(value_type = String)]
        level: LevelKey,
        /// Which corner.
        corner: Corner,
        /// Column.
        column_px: f64,
        /// Row.
        row_px: f64,
    },
    /// A placed corner moved.
    MoveCorner {
        /// Vertebra.
        #[schema(value_type = String)]
        level: LevelKey,
        /// Which corner.
        corner: Corner,
        /// Column.
        column_px: f64,
        /// Row.
        row_px: f64,
    },
    /// An axis turned by hand, or given back to the corners.
    SetAxis {
        /// Vertebra.
        #[schema(value_type = String)]
        level: LevelKey,
        /// Against the image's vertical, positive clockwise as seen; none to follow the corners.
        axis_deg: Option<f64>,
    },
    /// A vertebra taken off the film.
    RemoveVertebra {
        /// Vertebra.
        #[schema(value_type = String)]
        level: LevelKey,
    },
    /// The superior tip of an iliac crest.
    PlaceIliacCrest {
        /// The patient's side.
        side: CrestSide,
        /// Column.
        column_px: f64,
        /// Row.
        row_px: f64,
    },
    /// The scale tool: a line of known length.
    Scale {
        /// One end.
        from_px: [f64; 2],
        /// The other end.
        to_px: [f64; 2],
        /// Length.
        length_mm: f64,
    },
    /// Dark and bright exchanged for this reading, or not.
    Invert {
        /// Whether they are.
        inverted: bool,
    },
    /// The last edit taken back; notes are not edits.
    Undo,
    /// What was taken back last, done again.
    Redo,
    /// Free text, which leaves the store in the reading's state only.
    Note {
        /// Text.
        text: String,
    },
}

/// A change that is committed and flushed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Acknowledged {
    /// Number of its entry in the audit log: the order of all changes.
    pub sequence: u64,
    /// Revision of the reading or film after it.
    pub revision: u64,
}

/// A change that was based on an old revision, kept beside the one that won.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LostChange {
    /// Number.
    pub id: i64,
    /// Who.
    pub who: Name,
    /// When.
    pub at: Timestamp,
    /// Revision that they saw.
    pub base_revision: u64,
    /// Revision that there was.
    pub found_revision: u64,
    /// The [`Event`], edit or finish, as JSON.
    pub change: String,
}

impl Store {
    /// Adds an event to a reading, if it still is at the expected revision. What is acknowledged is on the disk.
    ///
    /// # Errors
    /// As [`Store::record_all`].
    pub fn record(
        &mut self,
        reading: ReadingId,
        event: &Event,
        expected_revision: u64,
        by: &Signature,
    ) -> Result<Acknowledged, StoreError> {
        self.record_all(reading, std::slice::from_ref(event), expected_revision, by)
    }

    /// Adds events to a reading, all of them or none, if it still is at the expected revision.
    ///
    /// Whoever sends the same events for the same revision once more has missed the acknowledgement, and is given it
    /// again: nothing is recorded twice.
    ///
    /// # Errors
    /// [`StoreError::Conflict`], and then every event is among [`Store::conflicts_of_reading`]; [`StoreError::NotYours`],
    /// [`StoreError::Finished`], [`StoreError::BadEvent`], [`StoreError::TooLarge`], [`StoreError::Unknown`];
    /// [`StoreError::NoEvent`] for no events.
    pub fn record_all(
        &mut self,
        reading: ReadingId,
        events: &[Event],
        expected_revision: u64,
        by: &Signature,
    ) -> Result<Acknowledged, StoreError> {
        check(events)?;
        self.write(by, |ledger| {
            let (record, known) = own(ledger, reading)?;
            let found = known.len() as u64;
            if found != expected_revision {
                if let Some(before) = known_before(&known, events, expected_revision) {
                    return acknowledge(ledger.transaction, reading, before).map(Ok);
                }
                let lost: Vec<String> = events.iter().map(json).collect();
                return keep_lost(ledger, reading.to_string(), expected_revision, found, &lost)
                    .map(Err);
            }
            if record.finished_at.is_some() {
                return Err(StoreError::Finished { reading });
            }
            append(ledger, reading, known, events).map(Ok)
        })?
    }

    /// A reading after all its events, for the one who leads the study; readers look through [`Store::observer`].
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn reading_state(&self, reading: ReadingId) -> Result<ReadingState, StoreError> {
        let snapshot = self.connection.unchecked_transaction()?;
        let record = readings::reading(&snapshot, reading)?;
        self.finals.state(&snapshot, &record)
    }

    /// The changes of a reading that lost a race, oldest first.
    ///
    /// # Errors
    /// [`StoreError::Damaged`].
    pub fn conflicts_of_reading(&self, reading: ReadingId) -> Result<Vec<LostChange>, StoreError> {
        lost_changes(&self.connection, &reading.to_string())
    }

    /// The edits of a film that lost a race, oldest first.
    ///
    /// # Errors
    /// [`StoreError::Damaged`].
    pub fn conflicts_of_film(&self, film: FilmId) -> Result<Vec<LostChange>, StoreError> {
        lost_changes(&self.connection, &film.to_string())
    }
}

/// The reading that someone wants to finish, if it is theirs, at the revision that they saw, and not finished.
/// The inner error is a conflict, which has been kept.
pub(super) fn current(
    ledger: &Ledger<'_>,
    reading: ReadingId,
    expected: u64,
    change: &str,
) -> Result<Result<(ReadingRecord, ReadingState), StoreError>, StoreError> {
    let (record, events) = own(ledger, reading)?;
    let state = ReadingState::replay(&events, record.finished_at.is_some());
    if state.revision != expected {
        let (object, change) = (reading.to_string(), [change.to_owned()]);
        return keep_lost(ledger, object, expected, state.revision, &change).map(Err);
    }
    if state.finished {
        return Err(StoreError::Finished { reading });
    }
    Ok(Ok((record, state)))
}

/// A reading of whoever signs, and its events.
fn own(ledger: &Ledger<'_>, reading: ReadingId) -> Result<(ReadingRecord, Vec<Event>), StoreError> {
    let record = readings::reading(ledger.transaction, reading)?;
    if record.observer != ledger.by.who {
        return Err(StoreError::NotYours { reading });
    }
    let events = events(ledger.transaction, reading)?;
    Ok((record, events))
}

/// Checks what needs no reading to be checked.
pub(super) fn check(events: &[Event]) -> Result<(), StoreError> {
    if events.is_empty() {
        return Err(StoreError::NoEvent);
    }
    limit("one step (in events)", events.len(), MOST_EVENTS)?;
    for event in events {
        if let Event::Note { text } = event {
            limit("the note (in characters)", text.chars().count(), LONGEST_NOTE)?;
        }
    }
    Ok(())
}

/// The revision after these events, where a reading has them at that place already.
fn known_before(known: &[Event], events: &[Event], expected: u64) -> Option<u64> {
    let start = usize::try_from(expected).ok()?;
    let end = start.checked_add(events.len())?;
    (known.get(start..end)? == events).then_some(end as u64)
}

/// The acknowledgement of the event that made a revision.
fn acknowledge(
    connection: &Connection,
    reading: ReadingId,
    revision: u64,
) -> Result<Acknowledged, StoreError> {
    let query = "SELECT max(audit.sequence) FROM audit JOIN events
                 ON audit.object = 'event/' || events.sequence
                 WHERE events.reading = ?1 AND events.revision = ?2";
    let sequence: i64 =
        connection.query_row(query, params![reading.0, signed(revision)?], |row| row.get(0))?;
    Ok(Acknowledged { sequence: sequence.unsigned_abs(), revision })
}

/// Adds events that were checked for themselves to a reading with these events.
pub(super) fn append(
    ledger: &Ledger<'_>,
    reading: ReadingId,
    mut known: Vec<Event>,
    events: &[Event],
) -> Result<Acknowledged, StoreError> {
    let mut last = Err(StoreError::NoEvent);
    for event in events {
        let state = ReadingState::replay(&known, false);
        if let Some(reason) = state.objection(event) {
            return Err(StoreError::BadEvent { reading, reason });
        }
        let revision = state.revision + 1;
        let number = next_id(ledger.transaction, "events", "sequence")?;
        ledger.transaction.execute(
            "INSERT INTO events VALUES (?1, ?2, ?3, ?4, ?5)",
            params![number, reading.0, signed(revision)?, ledger.by.at.unix_ms(), json(event)],
        )?;
        let sequence = ledger.seal("record", "events", &number)?;
        known.push(event.clone());
        last = Ok(Acknowledged { sequence, revision });
    }
    last
}

fn json(event: &Event) -> String {
    serde_json::to_string(event).expect("string keys only")
}

/// Keeps changes that lost; returns the error that says so and names the first.
pub(super) fn keep_lost(
    ledger: &Ledger<'_>,
    object: String,
    expected: u64,
    found: u64,
    changes: &[String],
) -> Result<StoreError, StoreError> {
    let conflict = next_id(ledger.transaction, "conflicts", "id")?;
    let by = ledger.by;
    for (id, change) in (conflict..).zip(changes) {
        ledger.transaction.execute(
            "INSERT INTO conflicts VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
            params![
                id,
                object,
                by.who.as_str(),
                by.at.unix_ms(),
                // A caller may name any revision.
                i64::try_from(expected).unwrap_or(i64::MAX),
                signed(found)?,
                change
            ],
        )?;
        ledger.seal("keep_conflict", "conflicts", &id)?;
    }
    Ok(StoreError::Conflict { object, expected, found, conflict })
}

pub(super) fn state(
    connection: &Connection,
    record: &ReadingRecord,
) -> Result<ReadingState, StoreError> {
    Ok(ReadingState::replay(&events(connection, record.id)?, record.finished_at.is_some()))
}

/// The events of a reading.
pub(super) fn events(
    connection: &Connection,
    reading: ReadingId,
) -> Result<Vec<Event>, StoreError> {
    let condition = "WHERE reading = ?1 ORDER BY revision";
    let mut next = 1;
    audit::load(connection, "events", condition, [reading.0], |row| {
        let (sequence, revision, json): (i64, i64, String) =
            (row.get("sequence")?, row.get("revision")?, row.get("event")?);
        let event = serde_json::from_str(&json).ok().filter(|_| revision == next);
        next += 1;
        event.ok_or_else(|| StoreError::damaged(format!("event/{sequence}")))
    })
}

fn lost_changes(connection: &Connection, object: &str) -> Result<Vec<LostChange>, StoreError> {
    audit::load(connection, "conflicts", "WHERE object = ?1 ORDER BY id", [object], |row| {
        let id: i64 = row.get("id")?;
        let at = Timestamp::from_unix_ms(row.get("time_ms")?);
        Ok(LostChange {
            id,
            who: Name::new(&row.get::<_, String>("actor")?)?,
            at: at.ok_or_else(|| StoreError::damaged(format!("conflict/{id}")))?,
            base_revision: row.get::<_, i64>("base_revision")?.unsigned_abs(),
            found_revision: row.get::<_, i64>("found_revision")?.unsigned_abs(),
            change: row.get("change")?,
        })
    })
}

/// The number of a new row. Rows are never deleted, so that numbers are never used twice.
pub(super) fn next_id(
    connection: &Connection,
    table: &str,
    column: &str,
) -> Result<i64, StoreError> {
    let query = format!("SELECT coalesce(max({column}), 0) FROM {table}");
    let last: i64 = connection.query_row(&query, [], |row| row.get(0))?;
    last.checked_add(1).ok_or_else(|| StoreError::damaged(table))
}

fn signed(revision: u64) -> Result<i64, StoreError> {
    i64::try_from(revision).map_err(|_| StoreError::damaged("events"))
}
