//! The current case of a study against its exported case file.

use serde_json::{Value, json};
use spineline::analysis::Case;
use spineline::anatomy::{Level, Posture, Side};
use spineline_store::{CaseReadings, Corner, Event, FilmEdit, FilmId, ReadingId, Store, Study};

use crate::session::{by, film_bytes, folder_with_new_store, name, place};

const STUDY: &str = "S-1";

/// Films of known spacing with its source and error, of known spacing on the detector, and of unknown spacing.
fn images() -> [(Posture, Value); 3] {
    [
        (
            Posture::Erect,
            json!({
                "columns": 1000, "rows": 2500, "column_spacing_mm": 0.2, "row_spacing_mm": 0.25,
                "spacing_plane": "patient", "spacing_source": "ruler",
                "spacing_relative_sd": 0.01, "patient_left": "image_left",
            }),
        ),
        (
            Posture::LeftBending,
            json!({
                "columns": 900, "rows": 2400, "column_spacing_mm": 1, "row_spacing_mm": 0.143,
                "spacing_plane": "detector", "patient_left": "image_right",
                "file": "S-1-left.dcm", "sha256": "0".repeat(64),
            }),
        ),
        (
            Posture::RightBending,
            json!({
                "columns": 800, "rows": 2300, "spacing_plane": "unknown",
                "patient_left": "image_left", "inverted": false,
            }),
        ),
    ]
}

/// Corner places without a short decimal form, for one vertebra of one reading.
fn corners(level: Level, seed: f64) -> Vec<(Corner, [f64; 2])> {
    let top = 1000.0 + 100.0 * f64::from(level as u8) / 3.0 + seed;
    let place = |column: f64, row: f64| [column + seed / 7.0, top + row];
    vec![
        (Corner::SuperiorLeft, place(400.1, 0.0)),
        (Corner::SuperiorRight, place(610.3, 1.0 / 3.0)),
        (Corner::InferiorLeft, place(398.7, 40.9)),
        (Corner::InferiorRight, place(612.9, 41.1)),
    ]
}

fn clicks(level: Level, seed: f64) -> Vec<Event> {
    let click = |(corner, [column, row]): (Corner, [f64; 2])| place(level, corner, column, row);
    corners(level, seed).into_iter().map(click).collect()
}

/// A vertebra in a case file's form.
fn written(level: Level, seed: f64, axis_deg: Option<f64>) -> Value {
    let mut vertebra = json!({});
    for (corner, place) in corners(level, seed) {
        vertebra[corner.key()] = json!(place);
    }
    if let Some(axis_deg) = axis_deg {
        vertebra["axis_deg"] = axis_deg.into();
    }
    vertebra
}

fn crest(side: Side, [column_px, row_px]: [f64; 2]) -> Event {
    Event::PlaceIliacCrest { side, column_px, row_px }
}

fn axis(level: Level, axis_deg: Option<f64>) -> Event {
    Event::SetAxis { level, axis_deg }
}

/// Begins a reading with these events, and finishes it on request.
fn read(
    store: &mut Store,
    film: i64,
    repeat: u32,
    who: &str,
    events: &[Event],
    finish: bool,
) -> ReadingId {
    let signature = by(who, film);
    let reading = store.begin_reading(FilmId(film), repeat, &signature).expect("a reading");
    let made = store.record_all(reading, events, 0, &signature).expect("events");
    if finish {
        store.finish_reading(reading, made.revision, &signature).expect("finished");
    }
    reading
}

const LEFT: [[f64; 2]; 2] = [[250.1, 2300.7], [251.3, 2299.9]];
const RIGHT: [[f64; 2]; 2] = [[760.2, 2304.4], [759.1, 2303.3]];

/// A study with every kind of event, and the open reading of its left film.
fn study(store: &mut Store) -> ReadingId {
    let lead = by("lead", 0);
    let study = Study::new(name(STUDY), None, true);
    store.add_study(&study, &lead).expect("a study");
    for (seed, (posture, image)) in (1..).zip(images()) {
        store.add_film(&study.id, posture, &film_bytes(seed), &image, &lead).expect("a film");
    }
    store.edit_film(FilmId(3), FilmEdit::Inverted(true), 0, &lead).expect("an edit");
    let mut first =
        [clicks(Level::L4, 0.0), clicks(Level::T12, 0.0), clicks(Level::T1, 0.0)].concat();
    let moved = corners(Level::L4, 5.0)[3];
    first.extend([
        axis(Level::L4, Some(-3.7)),
        Event::Undo,
        Event::Redo,
        axis(Level::T12, Some(2.1)),
        axis(Level::T12, None),
        axis(Level::T1, Some(0.3)),
        Event::RemoveVertebra { level: Level::T1 },
        Event::Undo,
        Event::MoveCorner {
            level: Level::L4,
            corner: moved.0,
            column_px: moved.1[0],
            row_px: moved.1[1],
        },
        Event::Undo,
        crest(Side::Left, LEFT[0]),
        crest(Side::Right, RIGHT[0]),
        Event::Scale { from_px: [10.0, 10.0], to_px: [10.0, 410.0], length_mm: 100.0 },
        Event::Invert { inverted: true },
        Event::Note { text: "unclear".to_owned() },
    ]);
    read(store, 1, 1, "A", &first, true);
    let mut second = clicks(Level::L4, 1.0);
    second.extend([crest(Side::Left, LEFT[1]), crest(Side::Right, RIGHT[1])]);
    read(store, 1, 2, "A", &second, true);
    // A single crest is not counted, and a reading without a vertebra remains a reading.
    read(store, 1, 1, "B", &[crest(Side::Left, [1.0, 2.0])], true);
    read(store, 3, 1, "A", &clicks(Level::L5, 2.0), true);
    let mut partial = clicks(Level::L3, 3.0);
    partial.extend(clicks(Level::L2, 3.0).into_iter().take(2));
    partial.push(axis(Level::L1, Some(1.5)));
    read(store, 2, 1, "A", &partial, false)
}

fn erect() -> Value {
    let mean = |pair: [[f64; 2]; 2]| [0, 1].map(|axis| (pair[0][axis] + pair[1][axis]) / 2.0);
    json!({
        "posture": "erect", "image": images()[0].1,
        "iliac_crests_px": { "left": mean(LEFT), "right": mean(RIGHT) },
        "readings": [
            { "observer": "A", "repeat": 1, "vertebrae": {
                "L4": written(Level::L4, 0.0, Some(-3.7)),
                "T12": written(Level::T12, 0.0, None),
                "T1": written(Level::T1, 0.0, Some(0.3)),
            } },
            { "observer": "A", "repeat": 2, "vertebrae": { "L4": written(Level::L4, 1.0, None) } },
            { "observer": "B", "repeat": 1, "vertebrae": {} },
        ],
    })
}

fn left(vertebrae: &Value) -> Value {
    let readings = json!([{ "observer": "A", "repeat": 1, "vertebrae": vertebrae }]);
    json!({ "posture": "left_bending", "image": images()[1].1, "readings": readings })
}

fn right() -> Value {
    let mut image = images()[2].1.clone();
    image["inverted"] = true.into();
    let vertebrae = json!({ "L5": written(Level::L5, 2.0, None) });
    let readings = json!([{ "observer": "A", "repeat": 1, "vertebrae": vertebrae }]);
    json!({ "posture": "right_bending", "image": image, "readings": readings })
}

fn parsed(films: &[Value]) -> Case {
    let case = json!({
        "format": "spineline-case", "version": 1, "case_id": STUDY, "synthetic": true,
        "films": films,
    });
    spineline_files::parse_case(&case.to_string()).expect("a case")
}

#[test]
fn the_case_of_finished_readings_equals_the_case_file() {
    let (_folder, mut store) = folder_with_new_store();
    study(&mut store);
    let current = store.current_case(&name(STUDY), CaseReadings::Finished).expect("a case");
    // The left film has no finished reading; the right one has no marked vertebra of the model.
    assert_eq!(current.case, parsed(&[erect()]));
    let exported = store.export_case(&name(STUDY)).expect("a case file");
    let case = spineline_files::parse_case(&exported.text).expect("a case");
    let mut unread = left(&Value::Null);
    unread["readings"] = json!([]);
    assert_eq!(case, parsed(&[erect(), unread.clone(), right()]));
    let text: Value = serde_json::from_str(&exported.text).expect("JSON");
    assert_eq!(text["films"], json!([erect(), unread, right()]));
    assert_eq!(current.case.films[0], case.films[0]);
}

#[test]
fn the_case_of_an_open_reading_has_complete_vertebrae_and_pending_events() {
    let (_folder, mut store) = folder_with_new_store();
    let reading = study(&mut store);
    let case = |pending: &[Event]| {
        store
            .current_case(&name(STUDY), CaseReadings::InHand { reading, pending })
            .expect("a case")
            .case
    };
    let marked = json!({ "L3": written(Level::L3, 3.0, None) });
    assert_eq!(case(&[]), parsed(&[erect(), left(&marked)]));
    let pending: Vec<Event> = clicks(Level::L2, 3.0).split_off(2);
    let marked = json!({
        "L3": written(Level::L3, 3.0, None), "L2": written(Level::L2, 3.0, None),
    });
    assert_eq!(case(&pending), parsed(&[erect(), left(&marked)]));
}

#[test]
fn an_image_invalid_in_a_case_file_is_refused() {
    let (_folder, mut store) = folder_with_new_store();
    let (lead, id) = (by("lead", 0), name(STUDY));
    store.add_study(&Study::new(id.clone(), None, true), &lead).expect("new");
    let image = json!({
        "columns": 10, "rows": 10, "column_spacing_mm": 0.2, "patient_left": "image_left",
    });
    store.add_film(&id, Posture::Erect, &film_bytes(1), &image, &lead).expect("a film");
    read(&mut store, 1, 1, "A", &clicks(Level::L4, 0.0), true);
    refused!(store.current_case(&id, CaseReadings::Finished), Case(_));
    refused!(store.export_case(&id), Case(_));
}

#[test]
fn an_incomplete_film_is_used_once_it_shows_enough() {
    let (_folder, mut store) = folder_with_new_store();
    let (lead, id) = (by("lead", 0), name(STUDY));
    store.add_study(&Study::new(id.clone(), None, true), &lead).expect("new");
    let (posture, image) = images().into_iter().next().expect("a picture");
    store.add_film(&id, posture, &film_bytes(1), &image, &lead).expect("a film");
    // T2 and T3 lie behind the shoulders, and T8 is hidden.
    let seen = Level::MODEL.into_iter().filter(|l| *l < Level::T3 && *l != Level::T8);
    let events: Vec<Event> =
        seen.zip(0..).flat_map(|(level, i)| clicks(level, f64::from(i))).collect();
    let reading = read(&mut store, 1, 1, "A", &events, false);
    let in_hand = CaseReadings::InHand { reading, pending: &[] };
    let mut current = store.current_case(&id, in_hand).expect("a case");
    let film = current.films.remove(&posture).expect("the film");
    assert_eq!(film.missing(), [Level::T8, Level::T3, Level::T2]);
    assert!(film.is_usable(), "live results begin before the end of the reading");
    let revision = u64::try_from(events.len()).expect("few events");
    store.finish_reading(reading, revision, &by("A", 1)).expect("finished");
    let current = store.current_case(&id, CaseReadings::Finished).expect("a case");
    assert!(current.films[&posture].is_usable());
    assert_eq!(current.usable_case().films.len(), 1);
}
