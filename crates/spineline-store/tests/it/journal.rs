//! Clicks, undo, conflicts, films and exported cases.

use spineline::anatomy::{FilmView, Level, Posture, Side};
use spineline_files::parse_case;
use spineline_store::{
    Corner, Event, ExportRemark, FilmEdit, FilmId, Name, ReadingId, Store, StoreError, Study,
};

use crate::session::{
    FILM, READING, STEPS, by, clicks, film_bytes, fingerprint, folder_with_store, image, name,
    place,
};

#[test]
fn every_click_is_in_the_state_after_a_reload() {
    let (folder, store) = folder_with_store(STEPS);
    drop(store);
    let store = Store::open(&folder.path().join("store")).expect("a store");
    let state = store.reading_state(READING).expect("a state");
    assert_eq!((state.revision, state.finished), (clicks().len() as u64, true));
    assert_eq!(
        state.vertebrae.keys().copied().collect::<Vec<_>>(),
        [Level::L4, Level::L3, Level::T12]
    );
    let l3 = &state.vertebrae[&Level::L3];
    assert_eq!(l3.axis_deg, Some(-3.7));
    assert_eq!(l3.corners[&Corner::InferiorLeft], [397.5, 1961.0]);
    assert_eq!(l3.corners[&Corner::SuperiorRight], [610.5, 1853.125]);
    assert_eq!(state.iliac_crests_px[&Side::Right], [760.0, 2304.0]);
    assert_eq!(state.scale_mm, Some(100.0));
    assert_eq!(state.inverted, Some(true));
    assert_eq!(state.notes, ["Größe unklar; Zeile 2\n\"Zitat\""]);
    assert!(state.undoable > 0 && state.redoable > 0);
}

#[test]
fn undo_and_redo_cover_every_edit_and_survive_a_reload() {
    let (folder, mut store) = folder_with_store(5);
    let path = folder.path().join("store");
    let mut states = vec![store.reading_state(READING).expect("a state").vertebrae];
    let corners = &clicks()[..12];
    let mut revision = 0;
    let mut record = |store: &mut Store, event: &Event| {
        let done = store.record(READING, event, revision, &by("A", 60)).expect("an event");
        revision += 1;
        assert_eq!(done.revision, revision);
        *store = Store::open(&path).expect("a store");
        store.reading_state(READING).expect("a state")
    };
    for corner in corners {
        states.push(record(&mut store, corner).vertebrae);
    }
    for earlier in states.iter().rev().skip(1) {
        assert_eq!(record(&mut store, &Event::Undo).vertebrae, *earlier);
    }
    for later in states.iter().skip(1) {
        assert_eq!(record(&mut store, &Event::Redo).vertebrae, *later);
    }
    let state = record(&mut store, &Event::Undo);
    assert_eq!(state.redoable, 1);
    let state = record(&mut store, &Event::Invert { inverted: false });
    assert_eq!(state.redoable, 0, "a new edit ends what could be redone");
}

#[test]
fn a_stale_click_is_refused_and_kept() {
    let (folder, mut store) = folder_with_store(5);
    let mut tab = Store::open(&folder.path().join("store")).expect("the same store");
    let (first, second) = (
        place(Level::L4, Corner::SuperiorLeft, 1.0, 2.0),
        place(Level::L4, Corner::SuperiorLeft, 9.0, 8.0),
    );
    store.record(READING, &first, 0, &by("A", 10)).expect("the first");
    let refused = tab.record(READING, &second, 0, &by("A", 11));
    refused!(refused, Conflict { expected: 0, found: 1, conflict: 1, .. });
    let state = store.reading_state(READING).expect("a state");
    assert_eq!(state.vertebrae[&Level::L4].corners[&Corner::SuperiorLeft], [1.0, 2.0]);
    let kept = store.conflicts_of_reading(READING, 0).expect("conflicts");
    assert_eq!(kept.len(), 1);
    assert_eq!((kept[0].who.as_str(), kept[0].base_revision, kept[0].found_revision), ("A", 0, 1));
    assert_eq!(kept[0].at, crate::session::minute(11));
    assert_eq!(serde_json::from_str::<Event>(&kept[0].change).expect("an event"), second);
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn a_stale_edit_of_a_film_is_refused_and_kept() {
    let (_folder, mut store) = folder_with_store(4);
    let edit = FilmEdit::Posture(Posture::RightBending);
    let refused = store.edit_film(FILM, edit, 0, &by("other", 20));
    refused!(refused, Conflict { expected: 0, found: 1, .. });
    let film = &store.films(&name("S-1")).expect("films")[0];
    assert_eq!((film.view, film.inverted, film.revision), (Posture::Erect.into(), true, 1));
    let kept = store.conflicts_of_film(FILM).expect("conflicts");
    assert_eq!(kept[0].change, r#"{"posture":"right_bending"}"#);
    store.edit_film(FILM, edit, 1, &by("other", 21)).expect("a fresh edit");
    assert_eq!(store.films(&name("S-1")).expect("films")[0].view, Posture::RightBending.into());
}

#[test]
fn a_film_is_checked_until_its_posture_changes() {
    let (_folder, mut store) = folder_with_store(4);
    let mut edit = |revision, edit| {
        store.edit_film(FILM, edit, revision, &by("lead", 20)).expect("an edit");
        let film = store.films(&name("S-1")).expect("films").remove(0);
        (film.stated.checked, film.inverted)
    };
    assert_eq!(edit(1, FilmEdit::Checked(true)), (true, true));
    assert_eq!(edit(2, FilmEdit::Inverted(false)), (true, false));
    assert_eq!(edit(3, FilmEdit::Posture(Posture::RightBending)), (false, false));
    assert_eq!(edit(4, FilmEdit::Checked(true)), (true, false));
    assert_eq!(edit(5, FilmEdit::Checked(false)), (false, false));
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn a_finished_reading_is_immutable_and_an_open_one_belongs_to_its_observer() {
    let (_folder, mut store) = folder_with_store(STEPS);
    let last = clicks().len() as u64;
    let before = fingerprint(&store);
    refused!(store.record(READING, &Event::Redo, last, &by("A", 90)), Finished { .. });
    refused!(store.finish_reading(READING, last, &by("A", 90)), Finished { .. });
    refused!(store.record(ReadingId(2), &Event::Redo, 2, &by("A", 90)), NotYours { .. });
    refused!(store.begin_reading(FILM, 1, &by("A", 90)), Exists { .. });
    refused!(store.begin_reading(FILM, 0, &by("A", 90)), BadRepeat { .. });
    assert_eq!(fingerprint(&store), before);
}

#[test]
fn an_invalid_event_is_refused_with_its_reason_and_changes_no_state() {
    let (_folder, mut store) = folder_with_store(5);
    let before = fingerprint(&store);
    let (level, corner) = (Level::L4, Corner::InferiorLeft);
    for event in [
        Event::Undo,
        Event::Redo,
        Event::MoveCorner { level, corner, column_px: 1.0, row_px: 1.0 },
        Event::RemoveVertebra { level },
        Event::SetAxis { level, axis_deg: Some(f64::NAN) },
        Event::SetAxis { level, axis_deg: Some(91.0) },
        place(Level::L4, corner, f64::INFINITY, 0.0),
        place(Level::L4, corner, 0.0, -1e9),
        Event::Scale { from_px: [1.0, 1.0], to_px: [1.0, 1.0], length_mm: 5.0 },
        Event::Scale { from_px: [1.0, 1.0], to_px: [2.0, 1.0], length_mm: 0.0 },
    ] {
        let refused = store.record(READING, &event, 0, &by("A", 10));
        assert!(matches!(refused, Err(StoreError::BadEvent { .. })), "{event:?}: {refused:?}");
    }
    let note = Event::Note { text: "Doe ".repeat(2_000) };
    let refused = store.record(READING, &note, 0, &by("A", 10)).expect_err("too long");
    assert!(matches!(refused, StoreError::TooLarge { .. }) && !refused.to_string().contains("Doe"));
    assert_eq!(fingerprint(&store), before);
}

#[test]
fn a_reading_with_an_incomplete_vertebra_cannot_be_finished() {
    let (_folder, mut store) = folder_with_store(5 + 6);
    let level = Level::L3;
    let refused = store.finish_reading(READING, 6, &by("A", 90));
    refused!(refused, Incomplete { level: Level::L3, corners: 2, .. });
    store.record(READING, &Event::RemoveVertebra { level }, 6, &by("A", 91)).expect("an event");
    store.finish_reading(READING, 7, &by("A", 92)).expect("complete now");
}

#[test]
fn a_repeated_picture_is_reported_with_its_posture() {
    let (folder, mut store) = folder_with_store(3);
    refused!(
        store.add_film(&name("S-1"), Posture::Traction, &film_bytes(2), &image(), &by("lead", 9)),
        AlreadyKnown { film: FilmId(2), view: FilmView::Frontal(Posture::LeftBending), .. }
    );
    assert_eq!(store.films(&name("S-1")).expect("films").len(), 2);
    // Another study may have it; its bytes are stored once.
    let study = Study::new(name("S-2"), None, true);
    store.add_study(&study, &by("lead", 10)).expect("a study");
    let added = store
        .add_film(&name("S-2"), Posture::Erect, &film_bytes(2), &image(), &by("lead", 11))
        .expect("a film");
    let content = store.film(added).expect("the film").content;
    assert_eq!(store.content(&content).expect("bytes"), film_bytes(2));
    drop(store);
    let raw = rusqlite::Connection::open(folder.path().join("store")).expect("a database");
    let count: i64 =
        raw.query_row("SELECT count(*) FROM contents", [], |row| row.get(0)).expect("a count");
    assert_eq!(count, 2);
}

#[test]
fn possible_patient_names_are_refused_without_quoting_them() {
    for text in ["", "Doe, Jane", "Jané", "../x", &"a".repeat(65)] {
        let refused = Name::new(text).expect_err("no identifier");
        assert!(text.is_empty() || !refused.to_string().contains(text), "{refused}");
    }
}

#[test]
fn an_exported_case_round_trips_with_every_corner() {
    let (_folder, store) = folder_with_store(STEPS);
    let exported = store.export_case(&name("S-1")).expect("a case");
    let expected = [
        ExportRemark::ScaleLeftOut { reading: READING },
        ExportRemark::Unfinished { reading: ReadingId(2) },
    ];
    assert_eq!(exported.remarks, expected);
    assert!(!exported.text.contains("Doe") && !exported.text.contains("Zitat"));
    let case = parse_case(&exported.text).expect("a case");
    assert!(case.synthetic);
    assert_eq!(case.films.len(), 2);
    let spineline::measure::FilmLandmarks::Corners { readings, iliac_crests, .. } =
        &case.films[0].landmarks
    else {
        panic!("no corners")
    };
    let l4 = &readings[0].vertebrae[&Level::L4];
    assert_eq!(
        (l4.corners.superior_left.column_px, l4.corners.superior_left.row_px),
        (400.25, 2000.0)
    );
    assert_eq!(readings[0].vertebrae.len(), 3);
    assert_eq!(iliac_crests.expect("crests").left.row_px, 2300.5);
}

#[test]
fn a_store_saved_and_loaded_a_thousand_times_exports_the_same_bytes() {
    let (folder, store) = folder_with_store(STEPS);
    drop(store);
    let path = folder.path().join("store");
    let first = Store::open(&path).and_then(|s| s.export_case(&name("S-1"))).expect("a case");
    for round in 0..1_000 {
        let mut store = Store::open(&path).expect("a store");
        // What is still being read is not exported.
        if round % 10 == 0 {
            let event = Event::Invert { inverted: round % 20 == 0 };
            store.record(ReadingId(2), &event, 2 + round / 10, &by("B", 100)).expect("an event");
        }
        assert_eq!(store.export_case(&name("S-1")).expect("a case"), first, "round {round}");
    }
    let store = Store::open(&path).expect("a store");
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn a_clock_that_jumps_back_is_recorded_and_order_is_kept() {
    let (_folder, mut store) = folder_with_store(5);
    let corners = &clicks()[..3];
    for (revision, (event, minutes)) in (0..).zip(corners.iter().zip([10, -100_000, 11])) {
        store.record(READING, event, revision, &by("A", minutes)).expect("an event");
    }
    let log = store.audit_log().expect("a log");
    let actions: Vec<_> = log.iter().rev().take(4).map(|entry| entry.action.as_str()).collect();
    assert_eq!(actions, ["record", "record", "clock_went_back", "record"]);
    assert_eq!(
        store.reading_state(READING).expect("a state").vertebrae[&Level::L4].corners.len(),
        3
    );
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn all_levels_are_shifted_by_one_change_that_can_be_undone() {
    let (_folder, mut store) = folder_with_store(5);
    let by = by("A", 60);
    store.record_all(READING, &clicks()[..12], 0, &by).expect("corners");
    let before = store.reading_state(READING).expect("a state").vertebrae;
    let up = Event::ShiftLevels { up: true };
    store.record(READING, &up, 12, &by).expect("shifted");
    let after = store.reading_state(READING).expect("a state").vertebrae;
    assert_eq!(after.keys().copied().collect::<Vec<_>>(), [Level::L3, Level::L2, Level::T11]);
    assert_eq!(after[&Level::L3], before[&Level::L4]);
    assert_eq!(after[&Level::T11], before[&Level::T12]);
    store.record(READING, &Event::Undo, 13, &by).expect("undone");
    assert_eq!(store.reading_state(READING).expect("a state").vertebrae, before);
    let down = Event::ShiftLevels { up: false };
    store.record(READING, &down, 14, &by).expect("L4 is L5 now");
    refused!(store.record(READING, &down, 15, &by), BadEvent { .. });
}
