//! Withdrawn and corrected readings, and studies that are renamed, archived and extended.

use serde_json::Value;
use spineline::anatomy::{Level, Posture};
use spineline_store::{
    CaseReadings, Corner, Event, ExportRemark, FilmEdit, FilmId, NewCase, PlanDesign, ReadingId,
    Store, Study, StudyEdit, WithdrawalCause, system_random,
};
use tempfile::TempDir;

use crate::plan::mark;
use crate::session::{
    FILM, READING, by, clicks, film_bytes, folder_with_new_store, folder_with_store, image, name,
    place,
};

const STUDY: &str = "S-1";
/// Events of the first reading of the session.
const CLICKED: u64 = 23;

/// The session up to the end of its first reading.
fn finished() -> (TempDir, Store) {
    assert_eq!(clicks().len() as u64, CLICKED);
    let (folder, mut store) = folder_with_store(5);
    store.record_all(READING, &clicks(), 0, &by("A", 10)).expect("events");
    store.finish_reading(READING, CLICKED, &by("A", 11)).expect("finished");
    (folder, store)
}

/// Observer, repeat and first corner of L4 of the readings of the erect film in an exported case.
fn exported(store: &Store) -> Vec<(String, u64, Value)> {
    let case = store.export_case(&name(STUDY)).expect("a case").text;
    let case: Value = serde_json::from_str(&case).expect("JSON");
    let readings = case["films"][0]["readings"].as_array().expect("readings").iter();
    let of = |reading: &Value| {
        let observer = reading["observer"].as_str().expect("a name").to_owned();
        let corner = reading["vertebrae"]["L4"]["superior_left"].clone();
        (observer, reading["repeat"].as_u64().expect("a number"), corner)
    };
    readings.map(of).collect()
}

fn actions(store: &Store) -> Vec<(String, String, String)> {
    let log = store.audit_log().expect("a log").into_iter();
    log.map(|entry| (entry.actor, entry.action, entry.object)).collect()
}

#[test]
fn a_withdrawn_reading_stays_in_the_store_and_counts_nowhere() {
    let (folder, mut store) = finished();
    let before = store.reading_state(READING).expect("a state");
    assert_eq!(exported(&store).len(), 1);
    let changed = store.last_result_change(&name(STUDY)).expect("an entry");

    refused!(store.withdraw_reading(READING, "  ", &by("lead", 70)), NoReason { .. });
    store.withdraw_reading(READING, "T6 lies on T7", &by("lead", 70)).expect("withdrawn");
    let record = store.reading(READING).expect("a reading");
    let withdrawal = record.withdrawn.clone().expect("a withdrawal");
    assert_eq!((&withdrawal.who, withdrawal.at), (&name("lead"), by("lead", 70).at));
    assert_eq!(withdrawal.cause, WithdrawalCause::Reason("T6 lies on T7".to_owned()));
    assert!(record.finished_at.is_some() && !record.counts());
    assert_eq!(store.reading_state(READING).expect("a state"), before);
    assert!(store.last_result_change(&name(STUDY)).expect("an entry") > changed);

    assert_eq!(exported(&store), []);
    let remarks = store.export_case(&name(STUDY)).expect("a case").remarks;
    assert!(matches!(remarks[0], ExportRemark::Withdrawn { reading: READING, .. }), "{remarks:?}");
    let current = store.current_case(&name(STUDY), CaseReadings::Finished).expect("a case");
    assert_eq!((current.films[&Posture::Erect].readings, current.case.films.len()), (0, 0));
    let last = actions(&store).pop().expect("an entry");
    assert_eq!(last, ("lead".into(), "withdraw".into(), "withdrawal/1".into()));

    refused!(store.withdraw_reading(READING, "again", &by("A", 71)), Withdrawn { .. });
    refused!(store.correct_reading(READING, &by("A", 71)), Withdrawn { .. });
    assert!(store.verify(None).expect("verifiable").is_clean());
    drop(store);
    let raw = rusqlite::Connection::open(folder.path().join("store")).expect("a database");
    for sql in ["UPDATE withdrawals SET reason = 'x'", "DELETE FROM withdrawals"] {
        assert!(raw.execute_batch(sql).is_err(), "{sql}");
    }
}

#[test]
fn an_open_reading_that_is_withdrawn_takes_no_more_clicks() {
    let (_folder, mut store) = finished();
    let open = store.begin_reading(FilmId(2), 1, &by("A", 60)).expect("a reading");
    store.withdraw_reading(open, "begun by mistake", &by("A", 61)).expect("withdrawn");
    let click = place(Level::L4, Corner::SuperiorLeft, 1.0, 2.0);
    refused!(store.record(open, &click, 0, &by("A", 62)), Withdrawn { .. });
    refused!(store.finish_reading(open, 0, &by("A", 62)), Withdrawn { .. });
}

#[test]
fn a_correction_replaces_the_reading_when_it_is_finished() {
    let (_folder, mut store) = finished();
    let before = store.reading_state(READING).expect("a state");
    refused!(store.correct_reading(READING, &by("B", 70)), NotYours { .. });
    let correction = store.correct_reading(READING, &by("A", 70)).expect("a copy");
    let copied = store.reading_state(correction).expect("a state");
    assert_eq!((&copied.vertebrae, copied.revision), (&before.vertebrae, CLICKED));
    assert!(!copied.finished);
    let record = store.reading(correction).expect("a reading");
    assert_eq!((record.repeat, record.corrects), (1, Some(READING)));
    refused!(store.correct_reading(READING, &by("A", 70)), Exists { .. });
    refused!(store.correct_reading(correction, &by("A", 70)), NotFinished { .. });

    // Until the end, the corrected reading counts; beside its correction it does not.
    let in_hand = CaseReadings::InHand { reading: correction, pending: &[] };
    let compared = store.current_case(&name(STUDY), in_hand).expect("a case").compared;
    let film = compared.expect("a frontal film").film;
    let readings = film.landmarks.corner_readings();
    assert_eq!((readings.len(), exported(&store)[0].2[0].as_f64()), (1, Some(400.25)));

    let (level, corner) = (Level::L4, Corner::SuperiorLeft);
    let moved = Event::MoveCorner { level, corner, column_px: 333.5, row_px: 2000.0 };
    store.record(correction, &moved, CLICKED, &by("A", 71)).expect("a correction");
    store.finish_reading(correction, CLICKED + 1, &by("A", 72)).expect("finished");
    let readings = exported(&store);
    assert_eq!(readings.len(), 1, "the corrected reading is not averaged with its correction");
    assert_eq!((readings[0].1, readings[0].2[0].as_f64()), (1, Some(333.5)));
    let replaced = store.reading(READING).expect("a reading").withdrawn.expect("replaced");
    assert_eq!(replaced.cause, WithdrawalCause::CorrectedBy(correction));
    assert_eq!(replaced.who, name("A"));
    assert_eq!(store.reading_state(READING).expect("a state"), before);
    let log = actions(&store);
    let told = |action: &str, object: &str| {
        assert!(log.contains(&("A".into(), action.into(), object.into())), "{action} {object}");
    };
    told("correct", "reading/2");
    told("finish", "reading/2");
    told("replace", "withdrawal/1");
    // The correction can be corrected in turn.
    let again = store.correct_reading(correction, &by("A", 80)).expect("a copy");
    store.finish_reading(again, CLICKED + 1, &by("A", 81)).expect("finished");
    assert_eq!(exported(&store).len(), 1);
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn an_abandoned_correction_leaves_the_reading_as_it_is() {
    let (_folder, mut store) = finished();
    let correction = store.correct_reading(READING, &by("A", 70)).expect("a copy");
    store.withdraw_reading(correction, "not needed", &by("A", 71)).expect("withdrawn");
    assert_eq!(exported(&store)[0].2[0].as_f64(), Some(400.25));
    store.correct_reading(READING, &by("A", 72)).expect("another one");
}

#[test]
fn a_withdrawn_reading_does_not_come_back_by_its_open_correction() {
    let (_folder, mut store) = finished();
    let correction = store.correct_reading(READING, &by("A", 70)).expect("a copy");
    let withdrawn = store.withdraw_reading(READING, "another patient", &by("lead", 71));
    assert_eq!(withdrawn.expect("withdrawn"), Some(correction));
    refused!(store.finish_reading(correction, CLICKED, &by("A", 72)), Withdrawn { .. });
    assert_eq!(exported(&store), []);
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn a_planned_study_keeps_its_readings_until_the_end_and_takes_no_correction() {
    let (_folder, mut store) = folder_with_new_store();
    let (study, lead) = (name("B-1"), by("lead", 0));
    store.add_study(&Study::new(study.clone(), None, true), &lead).expect("a study");
    for (seed, posture) in [(1, Posture::Erect), (2, Posture::LeftBending)] {
        store.add_film(&study, posture, &film_bytes(seed), &image(), &lead).expect("a film");
    }
    let design = PlanDesign { repeats: 1, washout_days: 0, proposals: false };
    store.reading_plan(&study, &[name("A")], design, &mut system_random, &lead).expect("a plan");
    let read = |store: &mut Store, minute| {
        let spineline_store::Next::Begin(film) =
            store.observer(&name("A")).next_film_for(&study, by("A", minute).at).expect("a plan")
        else {
            panic!("a film")
        };
        let reading = store.begin_planned(&film.code, &by("A", minute)).expect("a reading");
        let revision = mark(store, reading, 0, &by("A", minute));
        store.finish_reading(reading, revision, &by("A", minute)).expect("finished");
        reading
    };
    let first = read(&mut store, 1);
    for who in ["A", "lead"] {
        refused!(store.withdraw_reading(first, "wrong", &by(who, 2)), PlanRuns { .. });
    }
    read(&mut store, 3);
    refused!(store.correct_reading(first, &by("A", 4)), PlanGoverns { .. });
    store.withdraw_reading(first, "wrong", &by("lead", 5)).expect("withdrawn");
    // The study stays open.
    store.observer(&name("B")).reading(first).expect("visible");
}

#[test]
fn a_study_is_renamed_and_archived_and_an_archived_one_is_read_only() {
    let (_folder, mut store) = finished();
    let study = name(STUDY);
    let open = store.begin_reading(FilmId(2), 1, &by("A", 60)).expect("a reading");
    let label = StudyEdit::Label { label: Some("before brace".to_owned()) };
    store.edit_study(&study, &label, 0, &by("lead", 61)).expect("renamed");
    let refused = store.edit_study(&study, &StudyEdit::Label { label: None }, 0, &by("lead", 62));
    refused!(refused, Conflict { .. });
    assert_eq!(store.conflicts_of_study(&study).expect("kept").len(), 1);
    let archived = |archived| StudyEdit::Archived { archived };
    refused!(store.edit_study(&study, &archived(false), 1, &by("lead", 62)), NotArchived { .. });
    store.edit_study(&study, &archived(true), 1, &by("lead", 63)).expect("archived");
    let found = store.study(&study).expect("a study");
    assert_eq!((found.label.as_deref(), found.archived), (Some("before brace"), true));

    let click = place(Level::L4, Corner::SuperiorLeft, 1.0, 2.0);
    let who = by("A", 64);
    let chosen = spineline_files::method_text::ChosenOptions::default();
    let film = NewCase::of(found).film(Posture::Neutral, film_bytes(9), image());
    let refusals = [
        store.record(open, &click, 0, &who).map(drop),
        store.finish_reading(open, 0, &who).map(drop),
        store.begin_reading(FILM, 2, &who).map(drop),
        store.correct_reading(READING, &who).map(drop),
        store.withdraw_reading(READING, "wrong", &who).map(drop),
        store.edit_film(FILM, FilmEdit::Inverted(false), 1, &who).map(drop),
        store.set_study_options(&study, &chosen, 0, &who).map(drop),
        store.add_films(&film, &who).map(drop),
        store.edit_study(&study, &StudyEdit::Label { label: None }, 2, &who).map(drop),
        store.edit_study(&study, &archived(true), 2, &who).map(drop),
    ];
    for refused in refusals {
        refused!(refused, Archived { .. });
    }
    assert_eq!(exported(&store).len(), 1, "it can be read and exported");
    store.edit_study(&study, &archived(false), 2, &by("lead", 65)).expect("restored");
    store.record(open, &click, 0, &who).expect("a click");
    let words: Vec<String> = actions(&store).into_iter().map(|(_, action, _)| action).collect();
    for action in ["rename", "archive", "unarchive"] {
        assert!(words.iter().any(|word| word == action), "{action}");
    }
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn films_are_added_to_a_study_all_or_none() {
    let (_folder, mut store) = finished();
    let study = store.study(&name(STUDY)).expect("a study");
    let neutral = NewCase::of(study).film(Posture::Neutral, film_bytes(8), image());
    let known = neutral.clone().film(Posture::Traction, film_bytes(1), image());
    refused!(store.add_films(&known, &by("lead", 60)), AlreadyKnown { .. });
    assert_eq!(store.films(&name(STUDY)).expect("films").len(), 2);
    let added = store.add_films(&neutral, &by("lead", 61)).expect("a film");
    assert_eq!((added.films.len(), added.readings), (1, 0));
    let films = store.films(&name(STUDY)).expect("films");
    assert_eq!(films.last().map(|film| film.view), Some(Posture::Neutral.into()));
    let reading = store.reading(ReadingId(1)).expect("a reading");
    assert!(reading.counts());
}
