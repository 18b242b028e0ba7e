//! The journal of a reading: records events, and finishes readings.

use rusqlite::{Connection, params};
use spineline::anatomy::FilmView;

use crate::audit::{self, Ledger, next_id};
use crate::conflicts::{Acknowledged, keep_lost, signed};
use crate::connection::Store;
use crate::error::{StoreError, limit};
use crate::event::Event;
use crate::films;
use crate::names::{ReadingId, Signature};
use crate::plan;
use crate::readings::{self, ReadingRecord};
use crate::state::ReadingState;

/// Maximum length of a note in characters.
const MAX_NOTE: usize = 4_000;
/// Maximum number of events in one step; a whole film has fewer than a hundred.
const MAX_EVENTS: usize = 500;

impl Store {
    /// Adds an event to a reading, if it has the expected revision. An acknowledged event is on the disk.
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

    /// Adds all events to a reading, or none, if it has the expected revision.
    /// A repeated request with the same events and revision gets the same acknowledgement and records no event.
    ///
    /// # Errors
    /// [`StoreError::Conflict`], and then every event is among [`Store::conflicts_of_reading`]; [`StoreError::NotYours`],
    /// [`StoreError::Finished`], [`StoreError::Withdrawn`], [`StoreError::Archived`], [`StoreError::BadEvent`],
    /// [`StoreError::TooLarge`], [`StoreError::Unknown`]; [`StoreError::NoEvent`] for no events.
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

    /// Finishes a reading, which is then immutable. A correction replaces the reading that it corrects.
    ///
    /// # Errors
    /// [`StoreError::Incomplete`] where a vertebra lacks a corner; [`StoreError::Conflict`], [`StoreError::NotYours`],
    /// [`StoreError::Finished`], [`StoreError::Withdrawn`], [`StoreError::Archived`], [`StoreError::Unknown`].
    pub fn finish_reading(
        &mut self,
        reading: ReadingId,
        expected_revision: u64,
        by: &Signature,
    ) -> Result<Acknowledged, StoreError> {
        const FINISH: &str = r#"{"kind":"finish"}"#;
        self.write(by, |ledger| {
            let (record, events) = own(ledger, reading)?;
            let state = ReadingState::replay(&events, record.finished_at.is_some());
            if state.revision != expected_revision {
                let (object, change) = (reading.to_string(), [FINISH.to_owned()]);
                return keep_lost(ledger, object, expected_revision, state.revision, &change)
                    .map(Err);
            }
            if state.finished {
                return Err(StoreError::Finished { reading });
            }
            let sequence = readings::finish(ledger, reading, &state)?;
            plan::reveal_order(ledger, &films::film(ledger.transaction, record.film)?.study)?;
            Ok(Ok(Acknowledged { sequence, revision: state.revision }))
        })?
    }

    /// A reading after all its events, without blinding; for readers use [`Store::observer`].
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn reading_state(&self, reading: ReadingId) -> Result<ReadingState, StoreError> {
        let snapshot = self.connection.unchecked_transaction()?;
        let record = readings::reading(&snapshot, reading)?;
        self.state_of(&snapshot, &record)
    }

    /// The state of a reading. A finished one never changes, and was verified when it was first read.
    pub(crate) fn state_of(
        &self,
        connection: &Connection,
        reading: &ReadingRecord,
    ) -> Result<ReadingState, StoreError> {
        if reading.finished_at.is_none() {
            return state(connection, reading);
        }
        if let Some(known) = self.finals.borrow().get(&reading.id) {
            return Ok(known.clone());
        }
        let state = state(connection, reading)?;
        self.finals.borrow_mut().insert(reading.id, state.clone());
        Ok(state)
    }
}

/// A reading of the author in a study that can be changed, and its events.
fn own(ledger: &Ledger<'_>, reading: ReadingId) -> Result<(ReadingRecord, Vec<Event>), StoreError> {
    let record = readings::reading(ledger.transaction, reading)?;
    if record.observer != ledger.by.who {
        return Err(StoreError::NotYours { reading });
    }
    let film = films::film(ledger.transaction, record.film)?;
    films::open_study(ledger.transaction, &film.study)?;
    if record.withdrawn.is_some() {
        return Err(StoreError::Withdrawn { reading });
    }
    let events = events(ledger.transaction, reading)?;
    Ok((record, events))
}

/// Checks that do not need the reading.
fn check(events: &[Event]) -> Result<(), StoreError> {
    if events.is_empty() {
        return Err(StoreError::NoEvent);
    }
    limit("one step (in events)", events.len(), MAX_EVENTS)?;
    for event in events {
        if let Event::Note { text } = event {
            limit("the note (in characters)", text.chars().count(), MAX_NOTE)?;
        }
    }
    Ok(())
}

/// The revision after these events, if the reading already has them there.
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

/// Adds checked events to a reading with the given events.
pub(crate) fn append(
    ledger: &Ledger<'_>,
    reading: ReadingId,
    mut known: Vec<Event>,
    events: &[Event],
) -> Result<Acknowledged, StoreError> {
    let mut last = Err(StoreError::NoEvent);
    if events.iter().any(Event::needs_proposals)
        && !readings::allows_proposals(ledger.transaction, reading)?
    {
        let reason = "the plan of these readings allows no proposals: place every corner";
        return Err(StoreError::BadEvent { reading, reason });
    }
    let film = readings::reading(ledger.transaction, reading)?.film;
    let view = films::film(ledger.transaction, film)?.view;
    for event in events {
        let state = ReadingState::replay(&known, false);
        if let Some(reason) = state.objection(event, view) {
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

pub(crate) fn state(
    connection: &Connection,
    record: &ReadingRecord,
) -> Result<ReadingState, StoreError> {
    Ok(ReadingState::replay(&events(connection, record.id)?, record.finished_at.is_some()))
}

pub(crate) fn events(
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

/// A reading of a film after its events and the given unrecorded ones.
pub(crate) fn replayed(
    record: &ReadingRecord,
    view: FilmView,
    mut events: Vec<Event>,
    pending: &[Event],
) -> Result<ReadingState, StoreError> {
    let finished = record.finished_at.is_some();
    for event in pending {
        let state = ReadingState::replay(&events, finished);
        if let Some(reason) = state.objection(event, view) {
            return Err(StoreError::BadEvent { reading: record.id, reason });
        }
        events.push(event.clone());
    }
    Ok(ReadingState::replay(&events, finished))
}
