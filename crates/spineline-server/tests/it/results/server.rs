//! A server over a store with synthetic studies, and a plain client.

use serde_json::Value;
use spineline::analysis::Case;
use spineline::anatomy::{FilmView, Level, Posture, Side};
use spineline::measure::{Film, FilmLandmarks, Reading, VertebraLandmarks};
use spineline_files::{FilmSource, image_value};
use spineline_phantom::{Phantom, Readers, Scenario, generate};
use spineline_store::{Access, Corner, Event, FilmId, ReadingId, Signature, Store, Study};

use crate::browser::App;
pub use crate::browser::{by, name};

pub const READER: &str = "A";

pub fn phantom() -> Phantom {
    generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists")
}

/// An app over a store that was filled before, asked by [`READER`].
pub struct Running(App);

pub fn serve(fill: impl FnOnce(&mut Store)) -> Running {
    Running(App::new(Access::Token, fill))
}

impl Running {
    /// What the server answers: status, and body as JSON.
    pub fn ask(&self, method: &str, path: &str, body: Option<&Value>) -> (u16, Value) {
        let browser = self.0.observer(READER);
        let answer = match body {
            Some(body) => browser.json(method.parse().expect("a method"), path, body),
            None => browser.get(path),
        };
        let value = serde_json::from_slice(&answer.body).unwrap_or(Value::Null);
        (answer.status.as_u16(), value)
    }

    pub fn get(&self, path: &str) -> Value {
        let (status, body) = self.ask("GET", path, None);
        assert_eq!(status, 200, "{path}: {body}");
        body
    }

    pub fn post(&self, path: &str, body: &Value) -> Value {
        let (status, body) = self.ask("POST", path, Some(body));
        assert_eq!(status, 200, "{path}: {body}");
        body
    }
}

/// A study with the films of a case, not read yet.
pub fn add_study(store: &mut Store, study: &str, case: &Case) -> Vec<(Posture, FilmId)> {
    let id = name(study);
    let record = Study::new(id.clone(), None, case.synthetic);
    store.add_study(&record, &by("lead")).expect("a new study");
    let films = case.films.iter().map(|film| {
        let FilmLandmarks::Corners { image, .. } = &film.landmarks else { panic!("landmarks") };
        let bytes = format!("{study} {}", film.posture);
        let view = FilmView::Frontal(film.posture);
        let image = image_value(view, image, FilmSource::default());
        let added = store.add_film(&id, film.posture, bytes.as_bytes(), &image, &by("lead"));
        (film.posture, added.expect("a new film"))
    });
    films.collect()
}

/// A study whose films are read as in the case, all readings finished.
pub fn add_read_study(store: &mut Store, study: &str, case: &Case) {
    for (posture, film) in add_study(store, study, case) {
        let marked = case.film(posture).expect("its film");
        let readings = marked.landmarks.corner_readings();
        assert!(!readings.is_empty(), "phantoms have corners");
        for reading in readings {
            let by = by(&reading.id.observer);
            let begun = store.begin_reading(film, reading.id.repeat, &by).expect("a new reading");
            let count = record(store, begun, &events(marked, reading), &by);
            store.finish_reading(begun, count, &by).expect("whole vertebrae");
        }
    }
}

/// Records events on an empty reading; returns their number.
pub fn record(store: &mut Store, reading: ReadingId, events: &[Event], by: &Signature) -> u64 {
    for (revision, event) in (0..).zip(events) {
        store.record(reading, event, revision, by).expect("a sound event");
    }
    events.len() as u64
}

/// A reading as clicks.
pub fn events(film: &Film, reading: &Reading<VertebraLandmarks>) -> Vec<Event> {
    let FilmLandmarks::Corners { iliac_crests, .. } = &film.landmarks else { panic!("landmarks") };
    let mut events: Vec<Event> = Vec::new();
    for (&level, landmark) in &reading.vertebrae {
        events.extend(vertebra(level, landmark));
    }
    if let Some(crests) = iliac_crests {
        for (side, place) in [(Side::Left, crests.left), (Side::Right, crests.right)] {
            let (column_px, row_px) = (place.column_px, place.row_px);
            events.push(Event::PlaceIliacCrest { side, column_px, row_px });
        }
    }
    events
}

/// A vertebra as clicks.
pub fn vertebra(level: Level, landmark: &VertebraLandmarks) -> Vec<Event> {
    let corners = Corner::FRONTAL.points().into_iter().zip(landmark.corners.points());
    let mut events: Vec<Event> = corners
        .map(|(corner, place)| Event::PlaceCorner {
            level,
            corner,
            column_px: place.column_px,
            row_px: place.row_px,
        })
        .collect();
    if let Some(axis) = landmark.axis_clockwise {
        events.push(Event::SetAxis { level, axis_deg: Some(axis.deg()) });
    }
    events
}

/// The only reading of a film of a case.
pub fn reading_of(case: &Case, posture: Posture) -> (&Film, &Reading<VertebraLandmarks>) {
    let film = case.film(posture).expect("its film");
    (film, &film.landmarks.corner_readings()[0])
}

/// Checks that no list of numbers contains null, which JSON writes for values that are not numbers.
pub fn assert_numbers(value: &Value, place: &str) {
    match value {
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                assert!(!item.is_null(), "{place}/{i} is not a number");
                assert_numbers(item, &format!("{place}/{i}"));
            }
        }
        Value::Object(fields) => {
            fields.iter().for_each(|(key, item)| assert_numbers(item, &format!("{place}/{key}")));
        }
        _ => {}
    }
}
