//! How corners came about: from a reader's clicks to a case file and back into a store.

use spineline::anatomy::{Level, Posture, Side};
use spineline::measure::{Corners, Origin};
use spineline_store::{
    AcceptedVertebra, Corner, Event, NewCase, Next, PlanDesign, ReadingId, Store, StoreError, Study,
};
use tempfile::TempDir;

use crate::plan::random;
use crate::session::{by, create, film_bytes, folder_with_new_store, image, minute, name, place};

const BODY: [(Corner, [f64; 2]); 4] = [
    (Corner::SuperiorLeft, [400.0, 1000.0]),
    (Corner::SuperiorRight, [600.0, 1004.0]),
    (Corner::InferiorLeft, [398.0, 1100.0]),
    (Corner::InferiorRight, [602.0, 1103.0]),
];

fn accept(level: Level) -> Event {
    let vertebra = AcceptedVertebra { level, corners: BODY.into_iter().collect(), sd_share: None };
    Event::AcceptCorners { vertebrae: vec![vertebra] }
}

fn wall(level: Level, side: Side, column_px: f64) -> Event {
    Event::PlaceWall { level, side, column_px, row_px: 1050.0 }
}

/// A study with a film and an open reading of observer A.
fn begun() -> (TempDir, Store, ReadingId) {
    let (folder, mut store) = folder_with_new_store();
    let (id, lead) = (name("S-1"), by("lead", 1));
    store.add_study(&Study::new(id.clone(), None, true), &lead).expect("a study");
    let mut image = image();
    image["file"] = "erect.dcm".into();
    let film = store.add_film(&id, Posture::Erect, &film_bytes(1), &image, &lead).expect("a film");
    let reading = store.begin_reading(film, 1, &by("A", 2)).expect("a reading");
    (folder, store, reading)
}

fn record(store: &mut Store, reading: ReadingId, events: &[Event]) {
    for event in events {
        let revision = store.reading_state(reading).expect("a reading").revision;
        store.record(reading, event, revision, &by("A", 3)).expect("an event");
    }
}

#[test]
fn a_moved_corner_of_an_accepted_vertebra_is_adjusted_and_one_undo_takes_it_back() {
    let (_folder, mut store, reading) = begun();
    let level = Level::T9;
    let moved =
        Event::MoveCorner { level, corner: Corner::SuperiorLeft, column_px: 401.0, row_px: 999.0 };
    record(&mut store, reading, &[accept(Level::T9), moved]);
    let origins = |store: &Store| {
        store.reading_state(reading).expect("a reading").vertebrae[&Level::T9]
            .corner_origins(Posture::Erect.into())
    };
    let accepted = Corners::all(Origin::Accepted);
    assert_eq!(origins(&store), Corners { superior_left: Origin::Adjusted, ..accepted });
    record(&mut store, reading, &[Event::Undo]);
    assert_eq!(origins(&store), accepted);
    record(&mut store, reading, &[Event::Undo]);
    assert!(store.reading_state(reading).expect("a reading").vertebrae.is_empty());
}

#[test]
fn origins_and_walls_reach_the_case_and_another_store() {
    let (folder, mut store, reading) = begun();
    let clicked = BODY.map(|(corner, [column, row])| place(Level::T8, corner, column, row - 140.0));
    let level = Level::T9;
    let moved =
        Event::MoveCorner { level, corner: Corner::InferiorLeft, column_px: 397.0, row_px: 1101.0 };
    let walls = [wall(Level::T9, Side::Left, 399.0), wall(Level::T9, Side::Right, 601.0)];
    let events = [&clicked[..], &walls, &[accept(Level::T9), moved]].concat();
    record(&mut store, reading, &events);
    let revision = store.reading_state(reading).expect("a reading").revision;
    store.finish_reading(reading, revision, &by("A", 4)).expect("the end");
    let text = store.export_case(&name("S-1")).expect("a case").text;
    let case = spineline_files::parse_case(&text).expect("its own file");
    let readings = case.films[0].landmarks.corner_readings();
    let t9 = &readings[0].vertebrae[&Level::T9];
    let accepted = Corners::all(Origin::Accepted);
    assert_eq!(t9.origins, Corners { inferior_left: Origin::Adjusted, ..accepted });
    assert_eq!(t9.walls.map(|wall| wall.map(|place| place.column_px)), [Some(399.0), Some(601.0)]);
    assert!(readings[0].vertebrae[&Level::T8].is_placed());
    // A second store exports the same text.
    let mut other = create(&folder.path().join("other"));
    let new = NewCase::read(&text, |_| Ok::<_, StoreError>(film_bytes(1))).expect("a case");
    other.add_case(&new, &by("lead", 5)).expect("a study");
    assert_eq!(other.export_case(&new.study.id).expect("a case").text, text);
}

#[test]
fn a_plan_without_proposals_takes_clicked_corners_only() {
    let (_folder, mut store) = folder_with_new_store();
    let (id, lead) = (name("S-1"), by("lead", 1));
    store.add_study(&Study::new(id.clone(), None, true), &lead).expect("a study");
    store.add_film(&id, Posture::Erect, &film_bytes(1), &image(), &lead).expect("a film");
    let design = PlanDesign { repeats: 1, washout_days: 0, proposals: false };
    store.reading_plan(&id, &[name("A")], design, &mut random(1), &lead).expect("a plan");
    let Next::Begin(film) =
        store.observer(&name("A")).next_film_for(&id, minute(2)).expect("a plan")
    else {
        panic!("a film to read")
    };
    let reading = store.begin_planned(&film.code, &by("A", 2)).expect("a reading");
    assert!(!store.observer(&name("A")).reading(reading).expect("its own").proposals);
    for event in [accept(Level::T9), wall(Level::T9, Side::Left, 399.0)] {
        refused!(store.record(reading, &event, 0, &by("A", 3)), BadEvent { .. });
    }
    record(&mut store, reading, &[place(Level::T9, Corner::SuperiorLeft, 400.0, 1000.0)]);
}

#[test]
fn vertebrae_that_are_not_whole_are_not_accepted() {
    let (_folder, mut store, reading) = begun();
    let mut refuse = |event: Event| {
        refused!(store.record(reading, &event, 0, &by("A", 3)), BadEvent { .. });
    };
    refuse(Event::AcceptCorners { vertebrae: Vec::new() });
    for (corners, sd_share) in
        [(&BODY[..3], None), (&BODY[..], Some(-0.1)), (&BODY[..], Some(f64::NAN))]
    {
        let corners = corners.iter().copied().collect();
        let vertebra = AcceptedVertebra { level: Level::T9, corners, sd_share };
        refuse(Event::AcceptCorners { vertebrae: vec![vertebra] });
    }
}
