//! Blinded plans: seeded order, washouts, and what a reader may see.

use std::collections::{BTreeMap, BTreeSet};

use spineline::anatomy::{Level, Posture};
use spineline_store::{
    BlindFilm, Corner, Event, FilmCode, Name, Next, PlanDesign, ReadingId, Signature, Store,
    StoreError, Study, Timestamp, VisibleReadings,
};

use crate::session::{by, create, film_bytes, image, minute, name, place};

const DAY: i64 = 24 * 60;
const DESIGN: PlanDesign = PlanDesign { repeats: 2, washout_days: 14, seed: 7, proposals: true };

fn planned(folder: &tempfile::TempDir, file: &str, study: &str, design: PlanDesign) -> Store {
    let mut store = create(&folder.path().join(file));
    let id = name(study);
    let label = Some("Doe, Jane".to_owned());
    store
        .add_study(&Study { id: id.clone(), label, synthetic: true }, &by("lead", 1))
        .expect("a study");
    for (seed, posture) in (0..).zip(Posture::ALL) {
        store.add_film(&id, posture, &film_bytes(seed), &image(), &by("lead", 2)).expect("a film");
    }
    let observers = [name("B"), name("A")];
    let slots = store.reading_plan(&id, &observers, design, &by("lead", 3)).expect("a plan");
    assert_eq!(slots, 5 * 2 * design.repeats as usize);
    store
}

fn next(store: &Store, who: &str, now: Timestamp) -> Next {
    store.observer(&name(who)).next_film_for(&name("S-1"), now).expect("a plan")
}

fn read_one(store: &mut Store, film: &BlindFilm, who: &str, minutes: i64) -> ReadingId {
    let reading = store.begin_planned(&film.code, &by(who, minutes)).expect("the next film");
    store.finish_reading(reading, 0, &by(who, minutes)).expect("a reading of nothing");
    reading
}

/// Reads on, as soon as films are released; the order of contents, with the days on which each was read.
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
                let wait = (until.unix_ms() - minute(minutes).unix_ms()) / 60_000;
                assert!(wait > 0);
                minutes += wait;
            }
            Next::Continue(..) => panic!("every reading was finished"),
            Next::Done => return order,
        }
    }
}

#[test]
fn the_order_depends_on_seed_and_observers_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut orders = BTreeMap::new();
    for (file, design) in [("a", DESIGN), ("b", DESIGN), ("c", PlanDesign { seed: 8, ..DESIGN })] {
        let mut store = planned(&folder, file, "S-1", design);
        orders.insert(file, (read_all(&mut store, "A"), read_all(&mut store, "B")));
    }
    assert_eq!(orders["a"], orders["b"]);
    assert_ne!(orders["a"].0, orders["c"].0);
    assert_ne!(orders["a"].0, orders["a"].1);
}

#[test]
fn every_film_is_read_once_per_round_and_after_the_washout() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut store = planned(&folder, "store", "S-1", PlanDesign { repeats: 3, ..DESIGN });
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
    let folder = tempfile::tempdir().expect("a folder");
    let mut store = planned(&folder, "store", "S-1", DESIGN);
    let refused = store.begin_planned(&FilmCode::new("NOCODE"), &by("A", 10));
    assert!(matches!(refused, Err(StoreError::OutOfTurn)), "{refused:?}");
    let Next::Begin(film) = next(&store, "A", minute(10)) else { panic!("a film") };
    let refused = store.begin_planned(&film.code, &by("B", 10));
    assert!(matches!(refused, Err(StoreError::OutOfTurn)), "a code of another: {refused:?}");
    let refused =
        store.begin_reading(store.films(&name("S-1")).expect("films")[0].id, 9, &by("A", 10));
    assert!(matches!(refused, Err(StoreError::PlanGoverns { .. })), "{refused:?}");
    let refused = store.add_film(&name("S-1"), Posture::Erect, b"late", &image(), &by("lead", 10));
    assert!(matches!(refused, Err(StoreError::PlanGoverns { .. })), "{refused:?}");
    let reading = store.begin_planned(&film.code, &by("A", 10)).expect("the next film");
    assert_eq!(next(&store, "A", minute(11)), Next::Continue(film.clone(), reading));
    store.finish_reading(reading, 0, &by("A", 12)).expect("finished");
    for _ in 0..4 {
        let Next::Begin(film) = next(&store, "A", minute(12)) else { panic!("a film") };
        read_one(&mut store, &film, "A", 12);
    }
    let until = minute(12).plus_days(14);
    let waits = next(&store, "A", minute(12 + 14 * DAY - 1));
    assert_eq!(waits, Next::Wait(until));
    let Next::Begin(second) = next(&store, "A", until) else { panic!("released") };
    let early = store.begin_planned(&second.code, &by("A", 13));
    assert!(matches!(early, Err(StoreError::Washout { until: u }) if u == until), "{early:?}");
    assert_ne!(film.code, second.code);
}

#[test]
fn a_clock_that_jumps_back_does_not_shorten_the_washout() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut store = planned(&folder, "store", "S-1", PlanDesign { repeats: 2, ..DESIGN });
    for _ in 0..5 {
        let Next::Begin(film) = next(&store, "A", minute(10)) else { panic!("a film") };
        let reading = store.begin_planned(&film.code, &by("A", 10)).expect("the next film");
        // By the clock, it was finished four weeks before it was begun.
        store.finish_reading(reading, 0, &by("A", 10 - 28 * DAY)).expect("finished");
    }
    assert_eq!(next(&store, "A", minute(10)), Next::Wait(minute(10).plus_days(14)));
}

#[test]
fn a_blinded_reader_sees_only_codes_and_own_readings_until_the_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut store = planned(&folder, "store", "S-1", PlanDesign { repeats: 1, ..DESIGN });
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
    store.finish_reading(first, 2, &by("A", 10)).expect("finished");
    assert_eq!(store.observer(&a).reading_state(first).expect("own").revision, 2);
    let refused = store.observer(&b).reading_state(first);
    assert!(matches!(refused, Err(StoreError::NotYours { .. })), "{refused:?}");
    let visible =
        |store: &Store, who: &Name| store.observer(who).readings(&study).expect("readings");
    assert_eq!(visible(&store, &b), VisibleReadings::Blinded(Vec::new()));
    let VisibleReadings::Blinded(own) = visible(&store, &a) else { panic!("not yet open") };
    assert_eq!((own.len(), own[0].id, own[0].code.clone()), (1, first, film.code));
    read_all(&mut store, "A");
    assert!(matches!(visible(&store, &a), VisibleReadings::Blinded(own) if own.len() == 5));
    read_all(&mut store, "B");
    assert!(matches!(visible(&store, &a), VisibleReadings::Open(all) if all.len() == 10));
    assert_eq!(store.observer(&b).reading_state(first).expect("open").revision, 2);
    assert_eq!(next(&store, "B", minute(9_999_999)), Next::Done);
}

#[test]
fn codes_are_unique_across_plans_with_one_seed() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut store = planned(&folder, "store", "S-1", DESIGN);
    let lead: Signature = by("lead", 5);
    let study = Study { id: name("S-2"), label: None, synthetic: true };
    store.add_study(&study, &lead).expect("a study");
    store.add_film(&study.id, Posture::Erect, b"x", &image(), &lead).expect("a film");
    store
        .reading_plan(&study.id, &[name("A")], PlanDesign { repeats: 900, ..DESIGN }, &lead)
        .expect("a plan");
    let codes: BTreeSet<String> = store
        .audit_log()
        .expect("a log")
        .into_iter()
        .filter_map(|entry| entry.object.strip_prefix("slot/").map(str::to_owned))
        .collect();
    assert_eq!(codes.len(), 20 + 900);
}

#[test]
fn an_empty_plan_or_a_plan_after_readings_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut store = create(&folder.path().join("store"));
    let (study, lead) = (name("S-1"), by("lead", 1));
    store
        .add_study(&Study { id: study.clone(), label: None, synthetic: true }, &lead)
        .expect("a study");
    let refused = store.reading_plan(&study, &[name("A")], DESIGN, &lead);
    assert!(matches!(refused, Err(StoreError::BadPlan { .. })), "no films: {refused:?}");
    let film = store.add_film(&study, Posture::Erect, b"x", &image(), &lead).expect("a film").film;
    for (observers, repeats) in [(&[][..], 2), (&[name("A")][..], 0), (&[name("A")][..], u32::MAX)]
    {
        let refused =
            store.reading_plan(&study, observers, PlanDesign { repeats, ..DESIGN }, &lead);
        assert!(matches!(refused, Err(StoreError::BadPlan { .. })), "{refused:?}");
    }
    store.begin_reading(film, 1, &by("A", 2)).expect("a reading");
    let refused = store.reading_plan(&study, &[name("A")], DESIGN, &lead);
    assert!(matches!(refused, Err(StoreError::BadPlan { .. })), "a reading: {refused:?}");
}
