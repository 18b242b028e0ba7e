//! Blinded plans: codes and order that cannot be computed, washouts, and the data that readers may see.

use std::collections::{BTreeMap, BTreeSet};

use sha2::{Digest, Sha256};
use spineline::anatomy::{Level, Posture};
use spineline::measure::{Spacing, SpacingPlane};
use spineline_store::{
    BlindFilm, ClosedReading, Corner, Event, FilmCode, FilmEdit, Hash, Name, Next, PlanDesign,
    ReadingId, Signature, Store, StoreError, Study, Timestamp, Visibility, system_random,
};
use tempfile::TempDir;

use crate::session::{by, film_bytes, folder_with_new_store, image, minute, name, place};

const DAY: i64 = 24 * 60;
const DESIGN: PlanDesign = PlanDesign { repeats: 2, washout_days: 14, proposals: true };

/// Random numbers that are the same in every run, for codes and secrets of plans.
pub fn random(seed: u8) -> impl FnMut(&mut [u8]) {
    let mut count = 0_u64;
    move |bytes| {
        for byte in bytes {
            count += 1;
            *byte = Sha256::digest([&[seed][..], &count.to_le_bytes()].concat())[0];
        }
    }
}

fn planned(design: PlanDesign) -> (TempDir, Store) {
    planned_by(design, &mut random(7))
}

fn planned_by(design: PlanDesign, random: &mut dyn FnMut(&mut [u8])) -> (TempDir, Store) {
    let (folder, mut store) = folder_with_new_store();
    let id = name("S-1");
    let label = Some("Doe, Jane".to_owned());
    store.add_study(&Study::new(id.clone(), label, true), &by("lead", 1)).expect("a study");
    for (seed, posture) in (0..).zip(Posture::ALL) {
        store.add_film(&id, posture, &film_bytes(seed), &image(), &by("lead", 2)).expect("a film");
    }
    let observers = [name("B"), name("A")];
    let slots =
        store.reading_plan(&id, &observers, design, random, &by("lead", 3)).expect("a plan");
    assert_eq!(slots, 5 * 2 * design.repeats as usize);
    (folder, store)
}

fn next(store: &Store, who: &str, now: Timestamp) -> Next {
    store.observer(&name(who)).next_film_for(&name("S-1"), now).expect("a plan")
}

/// Marks a vertebra in a reading of this revision; returns the revision after it.
pub fn mark(store: &mut Store, reading: ReadingId, revision: u64, by: &Signature) -> u64 {
    let corners = [
        place(Level::L4, Corner::SuperiorLeft, 400.0, 2000.0),
        place(Level::L4, Corner::SuperiorRight, 610.0, 2000.0),
        place(Level::L4, Corner::InferiorLeft, 400.0, 2110.0),
        place(Level::L4, Corner::InferiorRight, 610.0, 2110.0),
    ];
    store.record_all(reading, &corners, revision, by).expect("four corners").revision
}

fn read_one(store: &mut Store, film: &BlindFilm, who: &str, minutes: i64) -> ReadingId {
    let reading = store.begin_planned(&film.code, &by(who, minutes)).expect("the next film");
    let revision = mark(store, reading, 0, &by(who, minutes));
    store.finish_reading(reading, revision, &by(who, minutes)).expect("a reading of a vertebra");
    reading
}

/// The time from which a film that was read may be read again.
fn released_after(finished: Timestamp) -> Timestamp {
    finished.plus_days(14).midnight_after()
}

/// The first whole minute of a test at or after a time.
fn minutes_until(time: Timestamp) -> i64 {
    (time.unix_ms() - minute(0).unix_ms() + 59_999) / 60_000
}

/// Reads each film when it is released; returns the order of contents and the days of reading.
fn read_all(store: &mut Store, who: &str) -> Vec<(String, i64)> {
    let (mut minutes, mut order) = (10, Vec::new());
    loop {
        match next(store, who, minute(minutes)) {
            Next::Begin(film) => {
                read_one(store, &film, who, minutes);
                order.push((film.content.to_string(), minutes));
                minutes += 30;
            }
            Next::Wait(until) => {
                let waited = minutes_until(until);
                assert!(waited > minutes);
                minutes = waited;
            }
            Next::Continue(..) => panic!("every reading was finished"),
            Next::Done => return order,
        }
    }
}

/// Codes of all plans, in the order of the log.
fn codes(store: &Store) -> Vec<String> {
    let log = store.audit_log().expect("a log").into_iter();
    log.filter_map(|entry| entry.object.strip_prefix("slot/").map(str::to_owned)).collect()
}

#[test]
fn the_order_depends_on_the_random_numbers_and_observers_only() {
    let mut orders = BTreeMap::new();
    for (plan, seed) in [("a", 7), ("b", 7), ("c", 8)] {
        let (_folder, mut store) = planned_by(DESIGN, &mut random(seed));
        let codes = codes(&store);
        orders.insert(plan, (codes, read_all(&mut store, "A"), read_all(&mut store, "B")));
    }
    assert_eq!(orders["a"], orders["b"]);
    assert_ne!(orders["a"].1, orders["c"].1);
    assert_ne!(orders["a"].1, orders["a"].2);
}

#[test]
fn codes_and_order_cannot_be_computed_in_a_store_of_ones_own() {
    let design = PlanDesign { repeats: 6, washout_days: 0, ..DESIGN };
    let [(clinic, clinic_order), (own, own_order)] = [(); 2].map(|()| {
        let (_folder, mut store) = planned_by(design, &mut system_random);
        let codes: BTreeSet<String> = codes(&store).into_iter().collect();
        (codes, read_all(&mut store, "A"))
    });
    assert_eq!((clinic.len(), own.len()), (60, 60));
    assert!(clinic.is_disjoint(&own), "{clinic:?} and {own:?}");
    assert_ne!(clinic_order, own_order);
}

#[test]
fn the_log_shows_the_secret_of_the_order_when_the_plan_is_done() {
    let (_folder, mut store) = planned(DESIGN);
    let revealed = |store: &Store| {
        let log = store.audit_log().expect("a log");
        let shown: Vec<String> = log
            .iter()
            .filter_map(|entry| entry.action.strip_prefix("reveal_").map(str::to_owned))
            .collect();
        let digests: BTreeSet<&String> = log
            .iter()
            .filter(|entry| entry.object == "plan/1")
            .map(|entry| &entry.digest)
            .collect();
        assert_eq!(digests.len(), 1, "the secret was fixed when the plan was made");
        shown
    };
    let first = read_all(&mut store, "A");
    assert_eq!(revealed(&store), Vec::<String>::new(), "B has not read");
    let second = read_all(&mut store, "B");
    let shown = revealed(&store);
    let [secret] = &shown[..] else { panic!("{shown:?}") };
    assert_eq!(secret.len(), 64);
    let films = store.films(&name("S-1")).expect("films");
    for (observer, order) in [("A", first), ("B", second)] {
        let expected = [1, 2].into_iter().flat_map(|repeat| {
            let mut round: Vec<_> = films.iter().map(|film| (film.id.0, &film.content)).collect();
            round.sort_by_key(|(film, _)| {
                Hash::of(format!("{secret} S-1 {observer} {repeat} {film}").as_bytes())
            });
            round.into_iter().map(|(_, content)| content.to_string())
        });
        assert!(expected.eq(order.into_iter().map(|(content, _)| content)), "{observer}");
    }
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn every_film_is_read_once_per_round_and_after_the_washout() {
    let (_folder, mut store) = planned(PlanDesign { repeats: 3, ..DESIGN });
    let order = read_all(&mut store, "A");
    let films: BTreeSet<_> = order.iter().map(|(content, _)| content.clone()).collect();
    assert_eq!((films.len(), order.len()), (5, 15));
    for round in order.chunks(5) {
        assert_eq!(round.iter().map(|(content, _)| content).collect::<BTreeSet<_>>().len(), 5);
    }
    for film in &films {
        let times: Vec<i64> =
            order.iter().filter(|read| read.0 == *film).map(|read| read.1).collect();
        assert!(times.windows(2).all(|pair| pair[1] - pair[0] >= 14 * DAY), "{times:?}");
    }
    assert!(store.verify(None).expect("verifiable").is_clean());
}

#[test]
fn a_repeat_begun_early_or_out_of_turn_is_refused() {
    let (_folder, mut store) = planned(DESIGN);
    refused!(store.begin_planned(&FilmCode::new("NOCODE"), &by("A", 10)), OutOfTurn);
    let Next::Begin(film) = next(&store, "A", minute(10)) else { panic!("a film") };
    // A code of another reader.
    refused!(store.begin_planned(&film.code, &by("B", 10)), OutOfTurn);
    refused!(
        store.begin_reading(store.films(&name("S-1")).expect("films")[0].id, 9, &by("A", 10)),
        PlanGoverns { .. }
    );
    let refused = store.add_film(&name("S-1"), Posture::Erect, b"late", &image(), &by("lead", 10));
    refused!(refused, PlanGoverns { .. });
    let reading = store.begin_planned(&film.code, &by("A", 10)).expect("the next film");
    assert_eq!(next(&store, "A", minute(11)), Next::Continue(film.clone(), reading));
    let revision = mark(&mut store, reading, 0, &by("A", 12));
    store.finish_reading(reading, revision, &by("A", 12)).expect("finished");
    for _ in 0..4 {
        let Next::Begin(film) = next(&store, "A", minute(12)) else { panic!("a film") };
        read_one(&mut store, &film, "A", 12);
    }
    let until = released_after(minute(12));
    let waits = next(&store, "A", minute(12 + 14 * DAY));
    assert_eq!(
        waits,
        Next::Wait(until),
        "a wait ends at midnight and does not tell one reading from another"
    );
    assert_eq!(until.unix_ms() % (DAY * 60_000), 0);
    let Next::Begin(second) = next(&store, "A", until) else { panic!("released") };
    let early = store.begin_planned(&second.code, &by("A", 13));
    assert!(matches!(early, Err(StoreError::Washout { until: u }) if u == until), "{early:?}");
    assert_ne!(film.code, second.code);
}

#[test]
fn a_clock_that_jumps_back_does_not_shorten_the_washout() {
    let (_folder, mut store) = planned(PlanDesign { repeats: 2, ..DESIGN });
    for _ in 0..5 {
        let Next::Begin(film) = next(&store, "A", minute(10)) else { panic!("a film") };
        let reading = store.begin_planned(&film.code, &by("A", 10)).expect("the next film");
        // By the clock, it was marked and finished four weeks before it was begun.
        let earlier = by("A", 10 - 28 * DAY);
        let revision = mark(&mut store, reading, 0, &earlier);
        store.finish_reading(reading, revision, &earlier).expect("finished");
    }
    assert_eq!(next(&store, "A", minute(10)), Next::Wait(released_after(minute(10))));
}

#[test]
fn a_blinded_reader_sees_only_codes_and_own_readings_until_the_end() {
    let (_folder, mut store) = planned(PlanDesign { repeats: 1, ..DESIGN });
    let (a, b, study) = (name("A"), name("B"), name("S-1"));
    let Next::Begin(film) = next(&store, "A", minute(10)) else { panic!("a film") };
    let seen = format!("{film:?}");
    for secret in ["Doe", "S-1", "erect", "Erect", "bending", "film/", "repeat"] {
        assert!(!seen.contains(secret), "{seen}");
    }
    let first = store.begin_planned(&film.code, &by("A", 10)).expect("the next film");
    let event = place(Level::L4, Corner::SuperiorLeft, 1.0, 2.0);
    store.record(first, &event, 0, &by("A", 10)).expect("an event");
    store.record(first, &Event::Undo, 1, &by("A", 10)).expect("an event");
    let revision = mark(&mut store, first, 2, &by("A", 10));
    store.finish_reading(first, revision, &by("A", 10)).expect("finished");
    refused!(store.observer(&b).reading(first), NotYours { .. });
    assert_eq!(store.observer(&b).closed(first).expect("a reading"), None);
    // The film of this reading is read again, so its picture is hidden.
    refused!(store.observer(&a).reading(first), Finished { .. });
    let closed = store.observer(&a).closed(first).expect("a reading");
    assert_eq!(closed, Some(ClosedReading { study: study.clone(), revision }));
    let sees = |store: &Store, who: &Name| store.observer(who).visibility(&study).expect("a study");
    read_all(&mut store, "A");
    assert_eq!(sees(&store, &a), Visibility::Reader);
    read_all(&mut store, "B");
    assert_eq!(sees(&store, &a), Visibility::Open);
    for who in [&a, &b] {
        let seen = store.observer(who).reading(first).expect("open");
        assert_eq!(seen.state(&[]).expect("a state").revision, revision);
        assert_eq!(store.observer(who).closed(first).expect("a reading"), None);
    }
    assert_eq!(next(&store, "B", minute(9_999_999)), Next::Done);
}

#[test]
fn a_blinded_reader_learns_no_time_of_a_click_of_others() {
    let (_folder, mut store) = planned(DESIGN);
    let changed = |store: &Store, who: &str| {
        store.observer(&name(who)).last_change(&name("S-1")).expect("a change").at
    };
    assert_eq!(changed(&store, "A"), minute(3), "the plan");
    let Next::Begin(film) = next(&store, "B", minute(10)) else { panic!("a film") };
    let reading = store.begin_planned(&film.code, &by("B", 10)).expect("the next film");
    let event = place(Level::L4, Corner::SuperiorLeft, 1.0, 2.0);
    store.record(reading, &event, 0, &by("B", 11)).expect("an event");
    assert_eq!((changed(&store, "A"), changed(&store, "B")), (minute(3), minute(11)));
    store.finish_reading(reading, 9, &by("B", 12)).expect_err("another revision");
    store.record(reading, &Event::Undo, 1, &by("B", 13)).expect("an event");
    let revision = mark(&mut store, reading, 2, &by("B", 13));
    store.finish_reading(reading, revision, &by("B", 14)).expect("finished");
    assert_eq!((changed(&store, "A"), changed(&store, "B")), (minute(3), minute(14)));
    assert_eq!(changed(&store, "lead"), minute(14));
    let Next::Begin(film) = next(&store, "A", minute(15)) else { panic!("a film") };
    store.begin_planned(&film.code, &by("A", 15)).expect("the next film");
    assert_eq!((changed(&store, "A"), changed(&store, "B")), (minute(15), minute(14)));
}

#[test]
fn a_film_does_not_change_between_its_planned_readings() {
    let (_folder, mut store) = planned(DESIGN);
    let before = store.films(&name("S-1")).expect("films");
    let edits = [
        FilmEdit::Inverted(true),
        FilmEdit::Posture(Posture::Neutral),
        FilmEdit::Spacing(Spacing::stated(0.3, 0.3, SpacingPlane::Patient)),
    ];
    for edit in edits {
        // A stale edit is refused too, and not kept as a conflict that somebody could apply.
        for revision in [0, 5] {
            let refused = store.edit_film(before[0].id, edit, revision, &by("lead", 5));
            refused!(refused, PlanRuns { .. });
        }
    }
    read_all(&mut store, "A");
    refused!(store.edit_film(before[0].id, edits[0], 0, &by("lead", 6)), PlanRuns { .. });
    assert_eq!(store.films(&name("S-1")).expect("films"), before);
    read_all(&mut store, "B");
    store.edit_film(before[0].id, edits[0], 0, &by("lead", 7)).expect("the plan is complete");
}

#[test]
fn a_plan_that_was_read_by_a_clock_years_ahead_is_released() {
    let (_folder, mut store) = planned(DESIGN);
    let (study, lead) = (name("S-1"), by("lead", 50));
    refused!(store.release_washout(&study, &lead), NothingAhead { .. });
    let ahead = 20 * 365 * DAY;
    // The clock of the first four readings is 20 years ahead.
    let mut last = String::new();
    for minutes in [ahead, ahead, ahead, ahead, 40] {
        let Next::Begin(film) = next(&store, "A", minute(minutes)) else { panic!("a film") };
        read_one(&mut store, &film, "A", minutes);
        last = film.content.to_string();
    }
    let locked = [minute(ahead), minute(40)].map(|finished| Next::Wait(released_after(finished)));
    assert!(locked.contains(&next(&store, "A", minute(60))));
    assert_eq!(store.release_washout(&study, &by("lead", 70)).expect("released"), 4);
    let entry = store.audit_log().expect("a log").pop().expect("an entry");
    assert_eq!((entry.action.as_str(), entry.object.as_str()), ("release", "plan/1"));
    assert_eq!((entry.actor.as_str(), entry.time_ms), ("lead", minute(70).unix_ms()));
    refused!(store.release_washout(&study, &by("lead", 71)), NothingAhead { .. });
    // Readings dated by the right clock keep their washout.
    let (mut minutes, mut released, mut order) = (80, 80, Vec::new());
    loop {
        match next(&store, "A", minute(minutes)) {
            Next::Begin(film) => {
                read_one(&mut store, &film, "A", minutes);
                order.push((film.content.to_string(), minutes));
            }
            Next::Wait(until) => {
                assert_eq!(until, released_after(minute(40)));
                released = minutes_until(until);
                minutes = released;
            }
            Next::Done => break,
            Next::Continue(..) => panic!("every reading was finished"),
        }
    }
    let kept = order.iter().position(|(film, _)| *film == last).expect("it was read again");
    assert!(order[..kept].iter().all(|(_, minutes)| *minutes == 80), "{order:?}");
    assert!(order[kept..].iter().all(|(_, minutes)| *minutes == released), "{order:?}");
    assert!(store.verify(None).expect("verifiable").is_clean());
    refused!(store.release_washout(&name("S-9"), &lead), Unknown { .. });
}

#[test]
fn codes_are_unique_across_plans_with_the_same_random_numbers() {
    let (_folder, mut store) = planned(DESIGN);
    let lead: Signature = by("lead", 5);
    let study = Study::new(name("S-2"), None, true);
    store.add_study(&study, &lead).expect("a study");
    store.add_film(&study.id, Posture::Erect, b"x", &image(), &lead).expect("a film");
    store
        .reading_plan(
            &study.id,
            &[name("A")],
            PlanDesign { repeats: 900, ..DESIGN },
            &mut random(7),
            &lead,
        )
        .expect("a plan");
    let codes: BTreeSet<String> = codes(&store).into_iter().collect();
    assert_eq!(codes.len(), 20 + 900);
}

#[test]
fn an_empty_plan_or_a_plan_after_readings_is_refused() {
    let (_folder, mut store) = folder_with_new_store();
    let (study, lead) = (name("S-1"), by("lead", 1));
    store.add_study(&Study::new(study.clone(), None, true), &lead).expect("a study");
    // The study has no films.
    let refused = store.reading_plan(&study, &[name("A")], DESIGN, &mut random(7), &lead);
    refused!(refused, BadPlan { .. });
    let film = store.add_film(&study, Posture::Erect, b"x", &image(), &lead).expect("a film");
    for (observers, repeats) in [(&[][..], 2), (&[name("A")][..], 0), (&[name("A")][..], u32::MAX)]
    {
        let design = PlanDesign { repeats, ..DESIGN };
        let refused = store.reading_plan(&study, observers, design, &mut random(7), &lead);
        refused!(refused, BadPlan { .. });
    }
    let long = PlanDesign { washout_days: 3651, ..DESIGN };
    let refused = store.reading_plan(&study, &[name("A")], long, &mut random(7), &lead);
    let words = refused.expect_err("more than the limit").to_string();
    assert!(words.contains("at most 3650 days"), "{words}");
    store.begin_reading(film, 1, &by("A", 2)).expect("a reading");
    // A reading was begun.
    let refused = store.reading_plan(&study, &[name("A")], DESIGN, &mut random(7), &lead);
    refused!(refused, BadPlan { .. });
}

#[test]
fn a_plan_is_changed_until_its_first_reading_begins() {
    let (_folder, mut store) = planned(DESIGN);
    let (study, lead) = (name("S-1"), by("lead", 4));
    let before = store.open_plan(&study).expect("readable").expect("no reading yet");
    assert_eq!((&before.observers[..], before.design), (&[name("A"), name("B")][..], DESIGN));
    let Next::Begin(old) = next(&store, "A", minute(5)) else { panic!("a film") };
    let design = PlanDesign { repeats: 1, washout_days: 0, proposals: false };
    let change = |store: &mut Store, plan: i64| {
        store.change_plan(&study, plan, &[name("A"), name("C")], design, &mut random(9), &lead)
    };
    assert_eq!(change(&mut store, before.id).expect("changed"), 5 * 2);
    refused!(change(&mut store, before.id), PlanReplaced { .. });
    let now = store.open_plan(&study).expect("readable").expect("no reading yet");
    assert_eq!((&now.observers[..], now.design), (&[name("A"), name("C")][..], design));
    // A code of the old plan.
    refused!(store.begin_planned(&old.code, &by("A", 6)), OutOfTurn);
    assert_eq!(next(&store, "B", minute(6)), Next::Done);
    let Next::Begin(film) = next(&store, "A", minute(6)) else { panic!("a film") };
    read_one(&mut store, &film, "A", 7);
    assert_eq!(store.open_plan(&study).expect("readable"), None);
    refused!(change(&mut store, now.id), BadPlan { .. });
    assert!(store.verify(None).expect("verifiable").is_clean());
}
