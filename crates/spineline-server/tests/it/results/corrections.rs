use serde_json::{Value, json};
use spineline::analysis::Case;
use spineline::anatomy::{Level, Posture};
use spineline_store::{Event, ReadingId, Store};

use super::server::{READER, Running, add_study, by, events, phantom, reading_of, record, serve};

/// Readings of the erect film by the signed-in user.
const READING: i64 = 1;

/// The clicks of a film, with T6 tilted: the left corners of its body lie 60 px lower if it is.
fn clicks(case: &Case, posture: Posture, is_tilted: bool) -> Vec<Event> {
    let (film, reading) = reading_of(case, posture);
    let tilted = |event: Event| match event {
        Event::PlaceCorner { level: Level::T6, corner, column_px, row_px }
            if is_tilted && corner.key().ends_with("left") =>
        {
            Event::PlaceCorner { level: Level::T6, corner, column_px, row_px: row_px + 60.0 }
        }
        other => other,
    };
    events(film, reading).into_iter().map(tilted).collect()
}

/// A study read once by the user, with or without the tilted vertebra on the erect film.
fn add_read(store: &mut Store, study: &str, case: &Case, is_tilted: bool) {
    for (posture, film) in add_study(store, study, case) {
        let reading = store.begin_reading(film, 1, &by(READER)).expect("a new reading");
        let clicks = clicks(case, posture, is_tilted && posture == Posture::Erect);
        let count = record(store, reading, &clicks, &by(READER));
        store.finish_reading(reading, count, &by(READER)).expect("finished");
    }
}

fn curves(running: &Running, study: &str) -> Value {
    running.get(&format!("/api/studies/{study}/findings"))["study"]["curves"].clone()
}

#[test]
fn after_a_correction_the_cobb_angle_is_computed_from_the_corrected_landmarks_alone() {
    let case = phantom().case;
    let running = serve(|store| {
        add_read(store, "wrong", &case, true);
        add_read(store, "right", &case, false);
    });
    let (wrong, right) = (curves(&running, "wrong"), curves(&running, "right"));
    assert!(wrong != right, "T6 changes the curves");
    let finish = |reading: i64, revision: &Value| {
        let body = json!({ "expected_revision": revision });
        running.post(&format!("/api/readings/{reading}/finish"), &body);
    };
    let correction = running.post(&format!("/api/readings/{READING}/correction"), &Value::Null);
    assert_eq!((&correction["corrects"], &correction["repeat"]), (&json!(READING), &json!(1)));
    assert_eq!(correction["vertebrae"].as_array().map(Vec::len), Some(15));
    let number = correction["reading"].as_i64().expect("a number");
    let moves = clicks(&case, Posture::Erect, false).into_iter().filter_map(|event| match event {
        Event::PlaceCorner { level: level @ Level::T6, corner, column_px, row_px } => {
            Some(json!(Event::MoveCorner { level, corner, column_px, row_px }))
        }
        _ => None,
    });
    let body = json!({
        "expected_revision": correction["revision"], "events": moves.collect::<Vec<_>>(),
    });
    let moved = running.post(&format!("/api/readings/{number}/events"), &body);
    assert_eq!(curves(&running, "wrong"), wrong, "the correction is not finished");
    finish(number, &moved["reading"]["revision"]);
    assert_eq!(curves(&running, "wrong"), right);

    let films = running.get("/api/studies/wrong")["summary"]["films"].clone();
    let readings = films[0]["readings"].as_array().expect("readings");
    assert_eq!(readings[0]["withdrawn"]["who"], READER);
    assert_eq!(
        (&readings[0]["withdrawn"]["reason"], &readings[1]["withdrawn"]),
        (&Value::Null, &Value::Null)
    );
    let (status, again) =
        running.ask("POST", &format!("/api/readings/{READING}/correction"), Some(&Value::Null));
    assert_eq!((status, &again["code"]), (409, &json!("withdrawn")));
}

#[test]
fn a_withdrawn_second_reading_leaves_the_first_one_alone() {
    let case = phantom().case;
    let mut second = None;
    let running = serve(|store| {
        add_read(store, "S1", &case, false);
        second =
            Some(store.begin_reading(spineline_store::FilmId(1), 2, &by(READER)).expect("new"));
    });
    let ReadingId(second) = second.expect("a reading");
    let alone = curves(&running, "S1");
    let body = json!({ "expected_revision": 0, "events": clicks(&case, Posture::Erect, true) });
    let marked = running.post(&format!("/api/readings/{second}/events"), &body);
    let body = json!({ "expected_revision": marked["reading"]["revision"] });
    running.post(&format!("/api/readings/{second}/finish"), &body);
    assert!(curves(&running, "S1") != alone, "two readings are averaged");
    assert!(!running.get("/api/studies/S1/reliability").as_array().expect("a list").is_empty());
    let path = format!("/api/readings/{second}/withdrawal");
    let (status, refused) = running.ask("POST", &path, Some(&json!({ "reason": " " })));
    assert_eq!((status, &refused["message"]), (422, &json!("a withdrawal needs a reason")));
    running.post(&path, &json!({ "reason": "T6 is tilted" }));
    assert_eq!(curves(&running, "S1"), alone);
    assert_eq!(running.get("/api/studies/S1/reliability"), json!([]));
    let case = running.get("/api/studies/S1/case");
    assert_eq!(case["films"][0]["readings"].as_array().map(Vec::len), Some(1));
}
