//! A scripted session of known outcome: every step is one write, and the same session always gives the same history.

use std::ops::Range;
use std::path::Path;

use serde_json::json;
use spineline::anatomy::{Level, Posture, Side};
use spineline_store::{
    Corner, Event, FilmEdit, FilmId, Name, ReadingId, Signature, Store, StoreError, Study,
    Timestamp,
};
use tempfile::TempDir;

pub fn name(text: &str) -> Name {
    Name::new(text).expect("a good name")
}

/// This number of minutes after a fixed morning.
pub fn minute(minutes: i64) -> Timestamp {
    Timestamp::from_unix_ms(1_750_000_000_000 + minutes * 60_000).expect("a moment")
}

pub fn by(who: &str, minutes: i64) -> Signature {
    Signature::new(name(who), minute(minutes))
}

pub fn create(path: &Path) -> Store {
    Store::create(path, &by("lead", 0)).expect("a new store")
}

pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// A folder with a new store, `store`.
pub fn folder_with_new_store() -> (TempDir, Store) {
    folder_with_store(0)
}

/// A folder with the store `store` after these steps of the session.
pub fn folder_with_store(steps: usize) -> (TempDir, Store) {
    let folder = folder();
    let store = create_after(&folder.path().join("store"), steps);
    (folder, store)
}

pub fn image() -> serde_json::Value {
    json!({
        "columns": 1000, "rows": 2500, "column_spacing_mm": 0.2, "row_spacing_mm": 0.25,
        "spacing_plane": "patient", "patient_left": "image_left"
    })
}

/// The bytes of a synthetic film, longer than a page of the file.
pub fn film_bytes(seed: u32) -> Vec<u8> {
    (0..9_000_u32).map(|i| (i.wrapping_mul(2_654_435_761).wrapping_add(seed) >> 13) as u8).collect()
}

pub fn place(level: Level, corner: Corner, column_px: f64, row_px: f64) -> Event {
    Event::PlaceCorner { level, corner, column_px, row_px }
}

/// The events of the first reading: three vertebrae, and one event of every other kind.
pub fn clicks() -> Vec<Event> {
    let mut events = Vec::new();
    for (count, level) in [Level::L4, Level::L3, Level::T12].into_iter().enumerate() {
        let top = 2000.0 - 150.0 * count as f64;
        for (corner, column, row) in [
            (Corner::SuperiorLeft, 400.25, 0.0),
            (Corner::SuperiorRight, 610.5, 3.125),
            (Corner::InferiorLeft, 398.0, 110.75),
            (Corner::InferiorRight, 612.0, 113.0),
        ] {
            events.push(place(level, corner, column, top + row));
        }
    }
    let level = Level::L3;
    events.extend([
        Event::SetAxis { level, axis_deg: Some(-3.7) },
        Event::Undo,
        Event::Redo,
        Event::Note { text: "Größe unklar; Zeile 2\n\"Zitat\"".to_owned() },
        Event::PlaceIliacCrest { side: Side::Left, column_px: 250.0, row_px: 2300.5 },
        Event::PlaceIliacCrest { side: Side::Right, column_px: 760.0, row_px: 2304.0 },
        Event::MoveCorner { level, corner: Corner::InferiorLeft, column_px: 397.5, row_px: 1961.0 },
        Event::Scale { from_px: [10.0, 10.0], to_px: [10.0, 410.0], length_mm: 100.0 },
        Event::Invert { inverted: true },
        Event::RemoveVertebra { level: Level::T12 },
        Event::Undo,
    ]);
    events
}

const FIRST_CLICK: usize = 5;
const CLICKS: usize = 23;
/// Number of writes in a session.
pub const STEPS: usize = FIRST_CLICK + CLICKS + 5;
pub const READING: ReadingId = ReadingId(1);
pub const FILM: FilmId = FilmId(1);

/// One write. The store must be in the state after the steps before.
pub fn run(store: &mut Store, step: usize) -> Result<(), StoreError> {
    let minutes = 1 + step as i64;
    let (lead, reader, other) = (by("lead", minutes), by("A", minutes), by("B", minutes));
    let id = name("S-1");
    match step {
        0 => {
            let label = Some("Doe, Jane".to_owned());
            store.add_study(&Study::new(id, label, true), &lead)
        }
        1 => store.add_film(&id, Posture::Erect, &film_bytes(1), &image(), &lead).map(drop),
        2 => store.add_film(&id, Posture::LeftBending, &film_bytes(2), &image(), &lead).map(drop),
        3 => store.edit_film(FILM, FilmEdit::Inverted(true), 0, &lead).map(drop),
        4 => store.begin_reading(FILM, 1, &reader).map(drop),
        _ if step < FIRST_CLICK + CLICKS => {
            let click = step - FIRST_CLICK;
            store.record(READING, &clicks()[click], click as u64, &reader).map(drop)
        }
        _ => match step - FIRST_CLICK - CLICKS {
            0 => match store.record(READING, &Event::Undo, 3, &reader) {
                Err(StoreError::Conflict { .. }) => Ok(()),
                Err(other) => Err(other),
                Ok(_) => panic!("a stale event went through"),
            },
            1 => store.finish_reading(READING, CLICKS as u64, &reader).map(drop),
            2 => store.begin_reading(FilmId(2), 1, &other).map(drop),
            3 => {
                let event = place(Level::L4, Corner::SuperiorLeft, 1.5, 2.5);
                store.record(ReadingId(2), &event, 0, &other).map(drop)
            }
            // A clock that jumps back by a year.
            _ => store.record(ReadingId(2), &Event::Undo, 1, &by("B", -500_000)).map(drop),
        },
    }
}

/// Runs these steps of the session.
pub fn run_steps(store: &mut Store, steps: Range<usize>) {
    steps.for_each(|step| run(store, step).expect("a step"));
}

/// Creates a store and runs this number of steps.
pub fn create_after(path: &Path, steps: usize) -> Store {
    let mut store = create(path);
    run_steps(&mut store, 0..steps);
    store
}

/// All readable state of a store, with the end of its log.
pub fn fingerprint(store: &Store) -> String {
    try_fingerprint(store).expect("a readable store")
}

pub fn try_fingerprint(store: &Store) -> Result<String, StoreError> {
    use std::fmt::Write;
    let mut text = String::new();
    for study in store.studies()? {
        writeln!(text, "{study:?}").expect("memory");
        writeln!(text, "{:?}", store.grants(&study.id)?).expect("memory");
        for film in store.films(&study.id)? {
            let bytes = store.content(&film.content)?.len();
            let lost = store.conflicts_of_film(film.id)?;
            writeln!(text, "{film:?} {bytes} {lost:?}").expect("memory");
        }
        for reading in store.readings(&study.id)? {
            let (state, lost) =
                (store.reading_state(reading.id)?, store.conflicts_of_reading(reading.id, 0)?);
            writeln!(text, "{reading:?} {state:?} {lost:?}").expect("memory");
        }
    }
    writeln!(text, "{:?} {:?}", store.accounts()?, store.head()?).expect("memory");
    Ok(text)
}

/// The fingerprints after every number of steps.
pub fn reference(path: &Path) -> Vec<String> {
    assert_eq!(clicks().len(), CLICKS);
    let mut store = create(path);
    let mut prints = vec![fingerprint(&store)];
    for step in 0..STEPS {
        run(&mut store, step).expect("a step of the session");
        prints.push(fingerprint(&store));
    }
    prints
}
