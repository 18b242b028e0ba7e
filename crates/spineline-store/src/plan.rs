//! Plans of blinded readings: order, interval, and what a blinded reader may see.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use rusqlite::{Connection, Row, params};

use crate::audit::{self, Ledger, next_id};
use crate::connection::Store;
use crate::error::StoreError;
use crate::films;
use crate::names::{self, FilmId, Hash, Name, ReadingId, Signature, Timestamp};
use crate::plan_design::{OpenPlan, PlanDesign};
use crate::readings::{self, ReadingRecord};

/// Action of the log entry that ends the washout of readings dated by a clock that was ahead.
pub(crate) const RELEASE: &str = "release";

/// Maximum number of readings in one plan.
const MAX_SLOTS: usize = 100_000;
/// Longest washout of a plan, in days.
const MAX_WASHOUT_DAYS: u32 = 3650;

/// Fills bytes with random numbers of the operating system: the source of codes and of secrets outside of tests.
///
/// # Panics
/// If the system's random numbers fail.
pub fn system_random(bytes: &mut [u8]) {
    getrandom::fill(bytes).expect("the system has random numbers");
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

pub(crate) struct Plan {
    pub id: i64,
    design: PlanDesign,
    secret: String,
}

pub(crate) fn plan_of(connection: &Connection, study: &Name) -> Result<Option<Plan>, StoreError> {
    let condition = "WHERE study = ?1 AND is_current = 1";
    let plans = audit::load(connection, "plans", condition, [study.as_str()], |row| {
        let design = PlanDesign {
            repeats: row.get("repeats")?,
            washout_days: row.get("washout_days")?,
            proposals: row.get("proposals")?,
        };
        Ok(Plan { id: row.get("id")?, design, secret: row.get("secret")? })
    })?;
    Ok(plans.into_iter().next())
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
    /// Plans the readings of a study: every observer reads every film once, in a separate order, then every film
    /// again, and so on. Each round is complete before the next one begins, so that waiting does not make the order
    /// less random.
    ///
    /// The codes are drawn from `random`, and so is the secret from which the order follows. The hash of the plan in the log covers the secret
    /// from the beginning, and the log shows the secret when the last reading is finished: an entry `reveal_SECRET`. A round of an observer is
    /// sorted by the SHA-256 of the texts `SECRET STUDY OBSERVER REPEAT FILM`, where `FILM` is the number of the film in the store.
    ///
    /// Returns the number of readings.
    ///
    /// # Errors
    /// [`StoreError::BadPlan`], [`StoreError::NameTwice`] for an observer, [`StoreError::Exists`] where the study has a plan,
    /// [`StoreError::Archived`], [`StoreError::Unknown`].
    pub fn reading_plan(
        &mut self,
        study: &Name,
        observers: &[Name],
        design: PlanDesign,
        random: &mut dyn FnMut(&mut [u8]),
        by: &Signature,
    ) -> Result<usize, StoreError> {
        self.write(by, |ledger| {
            films::open_study(ledger.transaction, study)?;
            if films::is_planned(ledger.transaction, study)? {
                return Err(StoreError::Exists { object: format!("the plan of study/{study}") });
            }
            insert(ledger, study, observers, design, random)
        })
    }

    /// Replaces a plan that has no readings yet. Its codes become invalid.
    ///
    /// # Errors
    /// [`StoreError::BadPlan`], also where a reading was begun; [`StoreError::NameTwice`] for an observer; [`StoreError::PlanReplaced`]
    /// where another plan replaced it before; [`StoreError::Archived`]; [`StoreError::Unknown`] for a study without a plan.
    pub fn change_plan(
        &mut self,
        study: &Name,
        plan: i64,
        observers: &[Name],
        design: PlanDesign,
        random: &mut dyn FnMut(&mut [u8]),
        by: &Signature,
    ) -> Result<usize, StoreError> {
        self.write(by, |ledger| {
            films::open_study(ledger.transaction, study)?;
            let now = plan_of(ledger.transaction, study)?.ok_or_else(|| no_plan(study))?;
            if now.id != plan {
                return Err(StoreError::PlanReplaced { study: study.clone() });
            }
            ledger.transaction.execute("UPDATE plans SET is_current = 0 WHERE id = ?1", [plan])?;
            ledger.seal("replace", "plans", &plan)?;
            insert(ledger, study, observers, design, random)
        })
    }

    /// The plan of a study, if it can be changed.
    pub fn open_plan(&self, study: &Name) -> Result<Option<OpenPlan>, StoreError> {
        let snapshot = self.connection.unchecked_transaction()?;
        let begun = !readings::of_study(&snapshot, study)?.is_empty();
        let plan = plan_of(&snapshot, study)?.filter(|_| !begun);
        let Some(Plan { id, design, .. }) = plan else { return Ok(None) };
        Ok(Some(OpenPlan { id, observers: observers_of(&snapshot, study)?, design }))
    }

    /// Whether a study's readings are planned.
    pub fn has_plan(&self, study: &Name) -> Result<bool, StoreError> {
        films::is_planned(&self.connection, study)
    }

    /// The observers of a study's plan, in the order of their codes; none without a plan.
    pub fn planned_observers(&self, study: &Name) -> Result<Vec<Name>, StoreError> {
        observers_of(&self.connection, study)
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
            match next(transaction, &study, &by.who, ledger.by.at)? {
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
}

impl Slot {
    pub fn is(&self, reading: &ReadingRecord) -> bool {
        (self.film, self.repeat, &self.observer)
            == (reading.film, reading.repeat, &reading.observer)
    }
}

fn observers_of(connection: &Connection, study: &Name) -> Result<Vec<Name>, StoreError> {
    let slots = slots_of(connection, study, None)?;
    let mut observers: Vec<Name> = slots.into_iter().map(|slot| slot.observer).collect();
    observers.dedup();
    Ok(observers)
}

/// A new plan of a study; returns the number of its readings.
fn insert(
    ledger: &Ledger<'_>,
    study: &Name,
    observers: &[Name],
    design: PlanDesign,
    random: &mut dyn FnMut(&mut [u8]),
) -> Result<usize, StoreError> {
    let transaction = ledger.transaction;
    if let Some(name) = names::repeated(observers) {
        return Err(StoreError::NameTwice { name: name.clone() });
    }
    let observers: BTreeSet<&Name> = observers.iter().collect();
    let films = films::films(transaction, study)?;
    let slots = check(films.len(), observers.len(), design)?;
    if !readings::of_study(transaction, study)?.is_empty() {
        return Err(StoreError::BadPlan {
            needs: "a study without readings",
            remedy: "make a new study of these films",
        });
    }
    let plan = next_id(transaction, "plans", "id")?;
    // 256 random bits in hexadecimal digits.
    let mut bytes = [0; 32];
    random(&mut bytes);
    let secret: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    let PlanDesign { repeats, washout_days, proposals } = design;
    transaction.execute(
        "INSERT INTO plans VALUES (?1, ?2, ?3, ?4, ?5, ?6, 1)",
        params![plan, study.as_str(), repeats, washout_days, secret, proposals],
    )?;
    ledger.seal("plan", "plans", &plan)?;
    let films: Vec<FilmId> = films.iter().map(|film| film.id).collect();
    let mut codes = taken_codes(transaction)?;
    for &observer in &observers {
        let rounds = (1..=repeats).flat_map(|repeat| {
            let order = round(&secret, study, observer, repeat, &films);
            order.into_iter().map(move |film| (film, repeat))
        });
        for (place, (film, repeat)) in (1_i64..).zip(rounds) {
            let code = draw_code(random, &mut codes);
            transaction.execute(
                "INSERT INTO slots VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
                params![code, plan, observer.as_str(), place, film.0, repeat],
            )?;
            ledger.seal("plan", "slots", &code)?;
        }
    }
    Ok(slots)
}

fn check(films: usize, observers: usize, design: PlanDesign) -> Result<usize, StoreError> {
    if design.washout_days > MAX_WASHOUT_DAYS {
        return Err(StoreError::BadPlan {
            needs: "a washout of at most 3650 days",
            remedy: "give fewer days, such as 14",
        });
    }
    let rounds = usize::try_from(design.repeats).unwrap_or(usize::MAX);
    match films.saturating_mul(observers).saturating_mul(rounds) {
        0 => Err(StoreError::BadPlan {
            needs: "at least one film, one observer and one repeat",
            remedy: "give films first, then observers and repeats",
        }),
        slots if slots > MAX_SLOTS => Err(StoreError::BadPlan {
            needs: "at most 100 000 readings",
            remedy: "plan fewer observers or repeats",
        }),
        slots => Ok(slots),
    }
}

/// The films of one round in an observer's order; see [`Store::reading_plan`].
fn round(
    secret: &str,
    study: &Name,
    observer: &Name,
    repeat: u32,
    films: &[FilmId],
) -> Vec<FilmId> {
    let mut order = films.to_vec();
    order.sort_by_cached_key(|film| {
        Hash::of(format!("{secret} {study} {observer} {repeat} {}", film.0).as_bytes())
    });
    order
}

/// Six unambiguous letters and digits that no slot of the store has.
fn draw_code(random: &mut dyn FnMut(&mut [u8]), taken: &mut BTreeSet<String>) -> String {
    const LETTERS: [u8; 32] = *b"23456789ABCDEFGHJKLMNPQRSTUVWXYZ";
    loop {
        let mut bytes = [0; 6];
        random(&mut bytes);
        let code: String =
            bytes.iter().map(|byte| char::from(LETTERS[usize::from(byte % 32)])).collect();
        if taken.insert(code.clone()) {
            return code;
        }
    }
}

/// Writes the secret of a study's plan into the log if all its readings are finished now.
pub(crate) fn reveal_order(ledger: &Ledger<'_>, study: &Name) -> Result<(), StoreError> {
    let connection = ledger.transaction;
    if let Some(plan) = plan_of(connection, study)?
        && is_open(connection, study)?
    {
        ledger.seal(&format!("reveal_{}", plan.secret), "plans", &plan.id)?;
    }
    Ok(())
}

fn taken_codes(connection: &Connection) -> Result<BTreeSet<String>, StoreError> {
    let mut query = connection.prepare("SELECT code FROM slots")?;
    let codes = query.query_map([], |row| row.get(0))?;
    Ok(codes.collect::<Result<_, _>>()?)
}

fn own_slot(connection: &Connection, code: &FilmCode, who: &Name) -> Result<Slot, StoreError> {
    let condition = "WHERE code = ?1 AND observer = ?2
                     AND plan IN (SELECT id FROM plans WHERE is_current = 1)";
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
    let condition = "WHERE plan = (SELECT id FROM plans WHERE study = ?1 AND is_current = 1)
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

/// Whether the study is not blinded: it has no plan, or all its readings are finished.
pub(crate) fn is_open(connection: &Connection, study: &Name) -> Result<bool, StoreError> {
    if !films::is_planned(connection, study)? {
        return Ok(true);
    }
    let readings = readings::of_study(connection, study)?;
    let finished: BTreeSet<_> = readings
        .iter()
        .filter(|reading| reading.finished_at.is_some())
        .map(|reading| (reading.film, reading.repeat, &reading.observer))
        .collect();
    let slots = slots_of(connection, study, None)?;
    Ok(slots.iter().all(|slot| finished.contains(&(slot.film, slot.repeat, &slot.observer))))
}

/// Refuses a change of a study that is blinded.
///
/// # Errors
/// [`StoreError::PlanRuns`].
pub(crate) fn need_open(connection: &Connection, study: &Name) -> Result<(), StoreError> {
    if is_open(connection, study)? {
        Ok(())
    } else {
        Err(StoreError::PlanRuns { study: study.clone() })
    }
}

pub(crate) fn no_plan(study: &Name) -> StoreError {
    StoreError::Unknown { object: format!("plan of study/{study}") }
}

fn next(
    connection: &Connection,
    study: &Name,
    who: &Name,
    now: Timestamp,
) -> Result<Next, StoreError> {
    let plan = plan_of(connection, study)?;
    let plan = plan.ok_or_else(|| no_plan(study))?;
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
        let rest = before.and_then(|reading| Some((reading.id, reading.rest_from?)));
        let Some((before, rest_from)) = rest else { return Ok(Next::Begin(film)) };
        // The exact time would reveal which earlier reading was of this film.
        let until = rest_from.plus_days(plan.design.washout_days).midnight_after();
        let waits = now < until && !is_released(connection, plan.id, before, rest_from)?;
        return Ok(if waits { Next::Wait(until) } else { Next::Begin(film) });
    }
    Ok(Next::Done)
}

/// Whether a release followed a finished reading while the clock was behind the start of the washout.
pub(crate) fn is_released(
    connection: &Connection,
    plan: i64,
    reading: ReadingId,
    rest_from: Timestamp,
) -> Result<bool, StoreError> {
    let release =
        "SELECT 1 FROM audit WHERE object = 'plan/' || ?1 AND action = ?2 AND time_ms < ?3
        AND sequence > (SELECT max(sequence) FROM audit WHERE object = ?4)";
    let parameters = params![plan, RELEASE, rest_from.unix_ms(), reading.to_string()];
    Ok(connection.prepare(release)?.exists(parameters)?)
}
