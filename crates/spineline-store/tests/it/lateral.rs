//! The lateral film and pedicles: from a case file to readings, and back.

use serde_json::{Value, json};
use spineline::anatomy::{FilmView, Level, Posture, Side};
use spineline_store::{
    CaseReadings, CaseRemark, Corner, Event, FilmEdit, FilmId, NewCase, Store, StoreError,
};
use tempfile::TempDir;

use crate::session::{by, film_bytes, folder_with_new_store, name, place};

/// A case of one vertebra, with pedicles on the erect film, and a lateral film that was exposed with it.
fn case() -> Value {
    json!({ "format": "spineline-case", "version": 1, "case_id": "P-1", "synthetic": true,
        "films": [{ "posture": "erect",
            "image": { "columns": 1000, "rows": 2500, "patient_left": "image_left", "file": "a.dcm" },
            "readings": [{ "observer": "A", "repeat": 1, "vertebrae": { "L4": {
                "superior_left": [400.0, 2000.0], "superior_right": [600.0, 2004.0],
                "inferior_left": [398.0, 2100.0], "inferior_right": [602.0, 2103.0],
                "left_pedicle": [440.5, 2030.0], "right_pedicle": [560.25, 2031.0] } } }] }],
        "lateral": { "simultaneous": true,
            "image": { "columns": 900, "rows": 2500, "column_spacing_mm": 0.2,
                "row_spacing_mm": 0.25, "patient_anterior": "image_right", "file": "b.dcm",
                "inverted": true },
            "readings": [{ "observer": "A", "repeat": 1, "vertebrae": { "L4": {
                "superior_anterior": [640.0, 1990.0], "superior_posterior": [450.0, 2010.0],
                "inferior_anterior": [650.0, 2100.0], "inferior_posterior": [455.0, 2095.5] } } }] } })
}

fn read(case: &Value) -> NewCase {
    let bytes_of = |file: &str| Ok::<_, StoreError>(film_bytes(u32::from(file.as_bytes()[0])));
    NewCase::read(&case.to_string(), bytes_of).expect("a case")
}

/// A store with the case, and its lateral film.
fn stored() -> (TempDir, Store, FilmId) {
    let (folder, mut store) = folder_with_new_store();
    let added = store.add_case(&read(&case()), &by("lead", 1)).expect("a study");
    assert_eq!((added.readings, &added.remarks[..]), (2, &[][..]));
    (folder, store, added.films[1])
}

#[test]
fn a_case_with_a_lateral_film_and_pedicles_comes_back_whole() {
    let (_folder, store, lateral) = stored();
    let film = store.film(lateral).expect("a film");
    assert_eq!(
        (film.view, film.stated.simultaneous, film.inverted),
        (FilmView::Lateral, true, true)
    );
    let exported = store.export_case(&name("P-1")).expect("a case");
    assert_eq!(exported.remarks, []);
    let text = case().to_string();
    let [before, after] = [&text, &exported.text].map(|text| spineline_files::parse_case(text));
    assert_eq!(after.expect("a case"), before.expect("a case"));
    let source = |text: &str| {
        spineline_files::parse_case_file(text)
            .expect("a case")
            .source(FilmView::Lateral)
            .expect("a picture")
    };
    assert_eq!(source(&exported.text), source(&text));

    let current = store.current_case(&name("P-1"), CaseReadings::Finished).expect("a case");
    assert_eq!(current.films.len(), 1, "frontal films");
    let seen = current.lateral.as_ref().expect("a lateral film");
    assert_eq!((seen.readings, seen.marked.len()), (1, 1));
    let parsed = spineline_files::parse_case(&text).expect("a case");
    assert_eq!(current.usable_case().lateral, parsed.lateral);
}

#[test]
fn a_lateral_film_without_a_picture_stays_in_its_case_file() {
    let mut case = case();
    case["lateral"]["image"].as_object_mut().expect("an image").remove("file");
    let (_folder, mut store) = folder_with_new_store();
    let added = store.add_case(&read(&case), &by("lead", 1)).expect("a study");
    assert_eq!((added.films.len(), &added.remarks[..]), (1, &[CaseRemark::Lateral][..]));
}

#[test]
fn each_view_takes_its_own_landmarks_and_undo_takes_them_back() {
    let (_folder, mut store, lateral) = stored();
    let frontal = FilmId(1);
    let by = by("B", 2);
    let level = Level::T9;
    let pedicle = |row_px| {
        let side = Side::Left;
        Event::PlacePedicle { level, side, column_px: 440.0, row_px }
    };
    let [front, left] = [Corner::SuperiorAnterior, Corner::SuperiorLeft]
        .map(|corner| place(Level::T9, corner, 600.0, 900.0));
    for (film, taken, others) in [
        (lateral, vec![front.clone()], vec![left.clone(), pedicle(900.0)]),
        (frontal, vec![left, pedicle(900.0), pedicle(905.0)], vec![front]),
    ] {
        let reading = store.begin_reading(film, 1, &by).expect("a reading");
        let count = taken.len() as u64;
        store.record_all(reading, &taken, 0, &by).expect("landmarks of this view");
        for other in &others {
            refused!(store.record(reading, other, count, &by), BadEvent { .. });
        }
        let before = store.reading_state(reading).expect("a state").vertebrae;
        store.record(reading, &Event::Undo, count, &by).expect("an undo");
        let after = store.reading_state(reading).expect("a state").vertebrae;
        if film == frontal {
            let rows = [&before, &after].map(|known| known[&Level::T9].pedicles.values().next());
            assert_eq!(rows, [Some(&[440.0, 905.0]), Some(&[440.0, 900.0])]);
        } else {
            assert!(after.is_empty());
        }
    }
    let edit = FilmEdit::Posture(Posture::Neutral);
    refused!(store.edit_film(lateral, edit, 0, &by), NotFrontal { .. });
    assert!(store.verify(None).expect("verifiable").is_clean());
}
