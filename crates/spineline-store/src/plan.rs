//! Plans of blinded readings: order, interval, and what a blinded reader may see.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use rand::RngExt;
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rusqlite::{Connection, Row, params};
use sha2::{Digest, Sha256};

use crate::audit::{self, next_id};
use crate::connection::Store;
use crate::error::StoreError;
use crate::films;
use crate::journal;
use crate::names::{FilmId, Hash, Name, ReadingId, Signature, Timestamp};
use crate::readings::{self, ReadingRecord};
use crate::state::ReadingState;

/// Maximum number of readings in one plan.
const MAX_SLOTS: usize = 100_000;

/// Number, interval and order of readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlanDesign {
    /// Readings per film and observer.
    pub repeats: u32,
    /// Days of 24 hours between two readings of a film by one observer.
    pub washout_days: u32,
    /// Seed of the order and of the codes; the same seed gives the same plan of the same study.
    pub seed: u64,
    /// Whether readers see vertebrae that the program proposes, and may accept them. Readers who do share its model, so that
    /// their agreement is better than that of clicks.
    pub proposals: bool,
}

/// The name of a film in one reading of one observer. It does not reveal study, posture, repeat or other readings.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct FilmCode(String);

impl FilmCode {
    /// A code from an observer; [`Store::begin_planned`] checks whether it exists.
    #[must_use]
    pub fn new(text: &str) -> Self {
        Self(text.to_owned())
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for FilmCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

/// The data of a film that a blinded reader may see.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlindFilm {
    /// Its code, for this reading only.
    pub code: FilmCode,
    /// Hash of its bytes, equal for every reading of the film: do not send it to the reader.
    pub content: Hash,
}

/// The next reading of an observer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Next {
    /// Begin this film.
    Begin(BlindFilm),
    /// Continue this film.
    Continue(BlindFilm, ReadingId),
    /// No reading before that day.
    Wait(Timestamp),
    /// No more readings.
    Done,
}

/// An own reading, as a blinded observer sees it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnReading {
    /// Reading.
    pub id: ReadingId,
    /// Code of its film.
    pub code: FilmCode,
    /// Time of the end.
    pub finished_at: Option<Timestamp>,
}

/// The readings that an observer may see.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum VisibleReadings {
    /// The own readings, while the plan is incomplete.
    Blinded(Vec<OwnReading>),
    /// All readings, if the plan is complete or there is none.
    Open(Vec<ReadingRecord>),
}

/// A place in an observer's order.
#[derive(Debug, Clone)]
pub(crate) struct Slot {
    pub code: FilmCode,
    film: FilmId,
    repeat: u32,
    observer: Name,
}

impl Store {
    /// Plans the readings of a study: every observer reads every film once, in an order of their own, then every film
    /// again, and so on. The order within a round is strict, so that waiting does not make it less random.
    ///
    /// Returns the number of readings.
    ///
    /// # Errors
    /// [`StoreError::BadPlan`], [`StoreError::Exists`] where the study has a plan, [`StoreError::Unknown`].
    pub fn reading_plan(
        &mut self,
        study: &Name,
        observers: &[Name],
        design: PlanDesign,
        by: &Signature,
    ) -> Result<usize, StoreError> {
        let observers: BTreeSet<&Name> = observers.iter().collect();
        self.write(by, |ledger| {
            let transaction = ledger.transaction;
            films::study(transaction, study)?;
            if films::is_planned(transaction, study)? {
                return Err(StoreError::Exists { object: format!("the plan of study/{study}") });
            }
            let films = films::films(transaction, study)?;
            let slots = check(films.len(), observers.len(), design.repeats)?;
            if !readings::of_study(transaction, study)?.is_empty() {
                return Err(StoreError::BadPlan { needs: "a study without readings" });
            }
            let plan = next_id(transaction, "plans", "id")?;
            let seed = design.seed.to_string();
            transaction.execute(
                "INSERT INTO plans VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
                params![
                    plan,
                    study.as_str(),
                    design.repeats,
                    design.washout_days,
                    seed,
                    design.proposals
                ],
            )?;
            ledger.seal("plan", "plans", &plan)?;
            let films: Vec<FilmId> = films.iter().map(|film| film.id).collect();
            let mut codes = taken_codes(transaction)?;
            for &observer in &observers {
                let order = order_of(study, observer, &films, design, &mut codes);
                for (place, slot) in (1_i64..).zip(order) {
                    let code = slot.code.as_str();
                    transaction.execute(
                        "INSERT INTO slots VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
                        params![code, plan, observer.as_str(), place, slot.film.0, slot.repeat],
                    )?;
                    ledger.seal("plan", "slots", &code)?;
                }
            }
            Ok(slots)
        })
    }

    /// Whether a study's readings are planned.
    ///
    /// # Errors
    /// [`StoreError::Database`].
    pub fn has_plan(&self, study: &Name) -> Result<bool, StoreError> {
        films::is_planned(&self.connection, study)
    }

    /// The observers of a study's plan, in the order of their codes; none without a plan.
    ///
    /// # Errors
    /// [`StoreError::Database`].
    pub fn planned_observers(&self, study: &Name) -> Result<Vec<Name>, StoreError> {
        let slots = slots_of(&self.connection, study, None)?;
        let mut observers: Vec<Name> = slots.into_iter().map(|slot| slot.observer).collect();
        observers.dedup();
        Ok(observers)
    }

    /// Begins the planned reading of a code. The observer is the author.
    ///
    /// # Errors
    /// [`StoreError::OutOfTurn`] for any code but the observer's next; [`StoreError::Washout`]; [`StoreError::Exists`]
    /// where it was begun before.
    pub fn begin_planned(
        &mut self,
        code: &FilmCode,
        by: &Signature,
    ) -> Result<ReadingId, StoreError> {
        self.write(by, |ledger| {
            let transaction = ledger.transaction;
            let slot = own_slot(transaction, code, &by.who)?;
            let study = films::film(transaction, slot.film)?.study;
            match next(transaction, &study, &by.who, by.at)? {
                Next::Begin(film) if film.code == *code => {
                    readings::begin(ledger, slot.film, slot.repeat)
                }
                Next::Continue(film, reading) if film.code == *code => {
                    Err(StoreError::Exists { object: reading.to_string() })
                }
                Next::Wait(until) => Err(StoreError::Washout { until }),
                _ => Err(StoreError::OutOfTurn),
            }
        })
    }

    /// The store as one observer may see it.
    #[must_use]
    pub fn observer<'a>(&'a self, who: &'a Name) -> ObserverView<'a> {
        ObserverView { store: self, who }
    }
}

/// The store as one observer may see it: only codes and own readings while a plan is incomplete.
#[derive(Debug, Clone, Copy)]
pub struct ObserverView<'a> {
    pub(crate) store: &'a Store,
    pub(crate) who: &'a Name,
}

impl ObserverView<'_> {
    /// The study of one of this observer's codes, for checks of permissions; it must not be sent to the reader.
    ///
    /// # Errors
    /// [`StoreError::OutOfTurn`] for a code that is not theirs.
    pub fn study_of(&self, code: &FilmCode) -> Result<Name, StoreError> {
        let slot = own_slot(&self.store.connection, code, self.who)?;
        Ok(films::film(&self.store.connection, slot.film)?.study)
    }

    /// The next reading of this observer at the given time.
    ///
    /// # Errors
    /// [`StoreError::Unknown`] for a study without a plan.
    pub fn next_film_for(&self, study: &Name, now: Timestamp) -> Result<Next, StoreError> {
        let snapshot = self.store.connection.unchecked_transaction()?;
        next(&snapshot, study, self.who, now)
    }

    /// The readings that this observer may see.
    ///
    /// # Errors
    /// [`StoreError::Unknown`].
    pub fn readings(&self, study: &Name) -> Result<VisibleReadings, StoreError> {
        let snapshot = self.store.connection.unchecked_transaction()?;
        films::study(&snapshot, study)?;
        let readings = readings::of_study(&snapshot, study)?;
        if is_open(&snapshot, study)? {
            return Ok(VisibleReadings::Open(readings));
        }
        let own = slots_of(&snapshot, study, Some(self.who))?.into_iter().filter_map(|slot| {
            let reading = readings.iter().find(|reading| slot.is(reading))?;
            let (id, finished_at) = (reading.id, reading.finished_at);
            Some(OwnReading { id, code: slot.code, finished_at })
        });
        Ok(VisibleReadings::Blinded(own.collect()))
    }

    /// A reading after all its events: an own one, or any where [`ObserverView::readings`] is open.
    ///
    /// # Errors
    /// [`StoreError::NotYours`], [`StoreError::Unknown`].
    pub fn reading_state(&self, reading: ReadingId) -> Result<ReadingState, StoreError> {
        let snapshot = self.store.connection.unchecked_transaction()?;
        let record = readings::reading(&snapshot, reading)?;
        let study = films::film(&snapshot, record.film)?.study;
        if record.observer != *self.who && !is_open(&snapshot, &study)? {
            return Err(StoreError::NotYours { reading });
        }
        journal::state(&snapshot, &record)
    }
}

impl Slot {
    pub fn is(&self, reading: &ReadingRecord) -> bool {
        (self.film, self.repeat, &self.observer)
            == (reading.film, reading.repeat, &reading.observer)
    }
}

fn check(films: usize, observers: usize, repeats: u32) -> Result<usize, StoreError> {
    let rounds = usize::try_from(repeats).unwrap_or(usize::MAX);
    match films.saturating_mul(observers).saturating_mul(rounds) {
        0 => Err(StoreError::BadPlan { needs: "at least one film, one observer and one repeat" }),
        slots if slots > MAX_SLOTS => {
            Err(StoreError::BadPlan { needs: "at most 100 000 readings" })
        }
        slots => Ok(slots),
    }
}

/// An observer's order, from a random stream of their own: other observers do not change it.
fn order_of(
    study: &Name,
    observer: &Name,
    films: &[FilmId],
    design: PlanDesign,
    codes: &mut BTreeSet<String>,
) -> Vec<Slot> {
    // No name contains a line feed.
    let stream = format!("{study}\n{observer}\n{}", design.seed);
    let mut random = ChaCha12Rng::from_seed(Sha256::digest(stream).into());
    let mut order = Vec::new();
    for repeat in 1..=design.repeats {
        let mut round = films.to_vec();
        for last in (1..round.len()).rev() {
            round.swap(last, random.random_range(0..=last));
        }
        for film in round {
            let code = draw_code(&mut random, codes);
            order.push(Slot { code, film, repeat, observer: observer.clone() });
        }
    }
    order
}

/// Six unambiguous letters and digits that no slot of the store has.
fn draw_code(random: &mut ChaCha12Rng, taken: &mut BTreeSet<String>) -> FilmCode {
    const LETTERS: [u8; 32] = *b"23456789ABCDEFGHJKLMNPQRSTUVWXYZ";
    loop {
        let draw = |_| char::from(LETTERS[random.random_range(0..LETTERS.len())]);
        let code: String = (0..6).map(draw).collect();
        if taken.insert(code.clone()) {
            return FilmCode(code);
        }
    }
}

fn taken_codes(connection: &Connection) -> Result<BTreeSet<String>, StoreError> {
    let mut query = connection.prepare("SELECT code FROM slots")?;
    let codes = query.query_map([], |row| row.get(0))?;
    Ok(codes.collect::<Result<_, _>>()?)
}

fn own_slot(connection: &Connection, code: &FilmCode, who: &Name) -> Result<Slot, StoreError> {
    let condition = "WHERE code = ?1 AND observer = ?2";
    let own = params![code.as_str(), who.as_str()];
    let mut slots = audit::load(connection, "slots", condition, own, slot)?;
    slots.pop().ok_or(StoreError::OutOfTurn)
}

/// The order of one observer, or of all.
pub(crate) fn slots_of(
    connection: &Connection,
    study: &Name,
    observer: Option<&Name>,
) -> Result<Vec<Slot>, StoreError> {
    let condition = "WHERE plan = (SELECT id FROM plans WHERE study = ?1)
                     AND (?2 IS NULL OR observer = ?2) ORDER BY observer, place";
    let parameters = params![study.as_str(), observer.map(Name::as_str)];
    audit::load(connection, "slots", condition, parameters, slot)
}

fn slot(row: &Row<'_>) -> Result<Slot, StoreError> {
    Ok(Slot {
        code: FilmCode(row.get("code")?),
        film: FilmId(row.get("film")?),
        repeat: row.get("repeat")?,
        observer: Name::new(&row.get::<_, String>("observer")?)?,
    })
}

/// Whether there is no blinding: no plan, or all its readings are finished.
pub(crate) fn is_open(connection: &Connection, study: &Name) -> Result<bool, StoreError> {
    let readings = readings::of_study(connection, study)?;
    let finished: BTreeSet<_> = readings
        .iter()
        .filter(|reading| reading.finished_at.is_some())
        .map(|reading| (reading.film, reading.repeat, &reading.observer))
        .collect();
    let slots = slots_of(connection, study, None)?;
    Ok(slots.iter().all(|slot| finished.contains(&(slot.film, slot.repeat, &slot.observer))))
}

fn next(
    connection: &Connection,
    study: &Name,
    who: &Name,
    now: Timestamp,
) -> Result<Next, StoreError> {
    let washouts = audit::load(connection, "plans", "WHERE study = ?1", [study.as_str()], |row| {
        Ok(row.get::<_, u32>("washout_days")?)
    })?;
    let no_plan = || StoreError::Unknown { object: format!("plan of study/{study}") };
    let &washout_days = washouts.first().ok_or_else(no_plan)?;
    let readings = readings::of_study(connection, study)?;
    let own: BTreeMap<_, _> = readings
        .iter()
        .filter(|reading| reading.observer == *who)
        .map(|reading| ((reading.film, reading.repeat), reading))
        .collect();
    for slot in slots_of(connection, study, Some(who))? {
        let reading = own.get(&(slot.film, slot.repeat));
        if reading.is_some_and(|reading| reading.finished_at.is_some()) {
            continue;
        }
        let content = films::film(connection, slot.film)?.content;
        let film = BlindFilm { code: slot.code, content };
        if let Some(reading) = reading {
            return Ok(Next::Continue(film, reading.id));
        }
        let before = own.get(&(slot.film, slot.repeat.saturating_sub(1)));
        let released =
            before.and_then(|reading| reading.rest_from).map(|t| t.plus_days(washout_days));
        return Ok(match released {
            Some(until) if now < until => Next::Wait(until),
            _ => Next::Begin(film),
        });
    }
    Ok(Next::Done)
}
