//! Visibility of a study for an observer, and its last change.

use rusqlite::{OptionalExtension, params};

use crate::audit::EXPORT;
use crate::connection::Store;
use crate::error::StoreError;
use crate::event::Event;
use crate::films::{self, FilmRecord, Study};
use crate::journal;
use crate::names::{Name, ReadingId, Timestamp};
use crate::plan::{self, FilmCode, ObserverView};
use crate::readings::{self, ReadingRecord};
use crate::state::ReadingState;

/// Visibility of a study for an observer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// Everything: the study has no plan, or all its readings are finished.
    Open,
    /// The plan is incomplete and has readings of this observer: codes, and the own reading that is not finished.
    Reader,
    /// The plan is incomplete and has no readings by this observer: only films are visible.
    Apart,
}

/// A reading as its observer may see it, or anybody after the plan is complete.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenReading {
    /// The reading.
    pub record: ReadingRecord,
    /// Its film.
    pub film: FilmRecord,
    /// Its study.
    pub study: Study,
    /// The film's code, where the reading is blinded: then nothing else of film and study may be shown.
    pub code: Option<FilmCode>,
    /// Whether proposals may be shown and accepted.
    pub proposals: bool,
    events: Vec<Event>,
}

/// An own reading that is finished while its plan goes on. Its landmarks and its picture would reveal a film that is read again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClosedReading {
    /// Its study, for checks of permissions.
    pub study: Name,
    /// Its last revision.
    pub revision: u64,
}

impl SeenReading {
    /// The reading after all its events and these.
    ///
    /// # Errors
    /// [`StoreError::BadEvent`].
    pub fn state(&self, pending: &[Event]) -> Result<ReadingState, StoreError> {
        journal::replayed(&self.record, self.film.view, self.events.clone(), pending)
    }
}

impl ObserverView<'_> {
    /// Visibility of a study for this observer.
    pub fn visibility(&self, study: &Name) -> Result<Visibility, StoreError> {
        let snapshot = self.store.connection.unchecked_transaction()?;
        if plan::is_open(&snapshot, study)? {
            return Ok(Visibility::Open);
        }
        let own = plan::slots_of(&snapshot, study, Some(self.who))?;
        Ok(if own.is_empty() { Visibility::Apart } else { Visibility::Reader })
    }

    /// A reading: an own one that is not finished, or any where the study is open.
    ///
    /// # Errors
    /// [`StoreError::NotYours`], [`StoreError::Unknown`]; [`StoreError::Finished`] for a [`ClosedReading`].
    pub fn reading(&self, reading: ReadingId) -> Result<SeenReading, StoreError> {
        let snapshot = self.store.connection.unchecked_transaction()?;
        let record = readings::reading(&snapshot, reading)?;
        let film = films::film(&snapshot, record.film)?;
        let study = films::study(&snapshot, &film.study)?;
        let mut code = None;
        if !plan::is_open(&snapshot, &film.study)? {
            if record.observer != *self.who {
                return Err(StoreError::NotYours { reading });
            }
            let slots = plan::slots_of(&snapshot, &film.study, Some(self.who))?;
            let slot = slots.into_iter().find(|slot| slot.is(&record));
            code = Some(slot.ok_or(StoreError::NotYours { reading })?.code);
            if record.finished_at.is_some() {
                return Err(StoreError::Finished { reading });
            }
        }
        let events = journal::events(&snapshot, reading)?;
        let proposals = readings::allows_proposals(&snapshot, reading)?;
        Ok(SeenReading { record, film, study, code, proposals, events })
    }

    /// What remains visible after an own reading is finished while its plan continues; `None` for other readings.
    ///
    /// # Errors
    /// [`StoreError::Unknown`].
    pub fn closed(&self, reading: ReadingId) -> Result<Option<ClosedReading>, StoreError> {
        let snapshot = self.store.connection.unchecked_transaction()?;
        let record = readings::reading(&snapshot, reading)?;
        let study = films::film(&snapshot, record.film)?.study;
        if record.finished_at.is_none()
            || record.observer != *self.who
            || plan::is_open(&snapshot, &study)?
        {
            return Ok(None);
        }
        let revision = journal::events(&snapshot, reading)?.len() as u64;
        Ok(Some(ClosedReading { study, revision }))
    }

    /// The last change of a study that this observer may know of. Blinded observers know changes of the plan and of their readings only.
    ///
    /// # Errors
    /// [`StoreError::Unknown`].
    pub fn last_change(&self, study: &Name) -> Result<LastChange, StoreError> {
        match self.visibility(study)? {
            Visibility::Reader => self.store.last_entry(study, Some(self.who), BLINDED_OBJECTS),
            Visibility::Open | Visibility::Apart => self.store.last_change(study),
        }
    }
}

/// The last entry of the log about a study or its parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct LastChange {
    /// Its number.
    pub sequence: i64,
    /// Its time.
    pub at: Timestamp,
}

/// Objects of a study whose changes may change its results.
const RESULT_OBJECTS: &str = "SELECT 'study/' || ?1
    UNION ALL SELECT 'options/' || ?1
    UNION ALL SELECT 'film/' || id FROM own_films
    UNION ALL SELECT 'reading/' || id FROM own_readings
    UNION ALL SELECT 'withdrawal/' || id FROM own_readings";
/// The other objects of a study: its plan, the last click of every reading, and lost changes.
const OTHER_OBJECTS: &str = "SELECT 'plan/' || id FROM plans WHERE study = ?1
    UNION ALL SELECT 'event/' || (SELECT sequence FROM events
        WHERE reading = own_readings.id ORDER BY revision DESC LIMIT 1) FROM own_readings
    UNION ALL SELECT 'conflict/' || (SELECT max(id) FROM conflicts
        WHERE object IN ('options/' || ?1, 'study/' || ?1))
    UNION ALL SELECT 'conflict/' || (SELECT max(id) FROM conflicts
        WHERE object = 'film/' || own_films.id) FROM own_films
    UNION ALL SELECT 'conflict/' || (SELECT max(id) FROM conflicts
        WHERE object = 'reading/' || own_readings.id) FROM own_readings";
/// Objects whose changes a blinded observer may see, with only the observer's readings.
const BLINDED_OBJECTS: &str = "SELECT 'plan/' || id FROM plans WHERE study = ?1
    UNION ALL SELECT 'reading/' || id FROM own_readings
    UNION ALL SELECT 'event/' || (SELECT sequence FROM events
        WHERE reading = own_readings.id ORDER BY revision DESC LIMIT 1) FROM own_readings";

impl Store {
    /// When a study, its films, readings, plan or lost changes changed last; needs a few look-ups, independent of the
    /// length of journals.
    ///
    /// # Errors
    /// [`StoreError::Unknown`].
    pub fn last_change(&self, study: &Name) -> Result<LastChange, StoreError> {
        self.last_entry(study, None, &format!("{RESULT_OBJECTS} UNION ALL {OTHER_OBJECTS}"))
    }

    /// When a study, its model options, a film of it, or the beginning or end of a reading changed last. Events of open readings do not change
    /// results.
    ///
    /// # Errors
    /// [`StoreError::Unknown`].
    pub fn last_result_change(&self, study: &Name) -> Result<LastChange, StoreError> {
        self.last_entry(study, None, RESULT_OBJECTS)
    }

    /// The last entry about objects, with the readings of all observers or of one.
    fn last_entry(
        &self,
        study: &Name,
        observer: Option<&Name>,
        objects: &str,
    ) -> Result<LastChange, StoreError> {
        let query = format!(
            "WITH own_films AS (SELECT id FROM films WHERE study = ?1),
            own_readings AS (SELECT id FROM readings WHERE film IN (SELECT id FROM own_films)
                AND (?2 IS NULL OR observer = ?2)),
            objects (object) AS ({objects})
            SELECT sequence, time_ms FROM audit WHERE sequence = (
                SELECT max((SELECT max(sequence) FROM audit
                    WHERE audit.object = objects.object AND substr(action, 1, length('{EXPORT}')) <> '{EXPORT}'))
                FROM objects WHERE object IS NOT NULL)"
        );
        let mut statement = self.connection.prepare(&query)?;
        let found: Option<(i64, i64)> = statement
            .query_row(params![study.as_str(), observer.map(Name::as_str)], |row| {
                Ok((row.get(0)?, row.get(1)?))
            })
            .optional()?;
        let unknown = || StoreError::Unknown { object: format!("study/{study}") };
        let (sequence, time_ms) = found.ok_or_else(unknown)?;
        let at = Timestamp::from_unix_ms(time_ms);
        let at = at.ok_or_else(|| StoreError::damaged(format!("study/{study}")))?;
        Ok(LastChange { sequence, at })
    }
}
