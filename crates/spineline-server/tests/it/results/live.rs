use serde_json::{Value, json};
use spineline::analysis::Case;
use spineline::anatomy::{Level, Posture};
use spineline::measure::{Corners, FilmLandmarks, VertebraLandmarks};
use spineline::spatial::{Angle, Pixel};
use spineline_phantom::mirror;
use spineline_store::{PlanDesign, ReadingId, Store, system_random};

use super::server::{
    READER, Running, add_read_study, add_study, assert_numbers, by, events, name, phantom,
    reading_of, record, serve, vertebra,
};

fn px(value: &Value) -> [f64; 2] {
    serde_json::from_value(value.clone()).expect("a place")
}

/// A reading of the erect film of `S1` by the signed-in user, of all vertebrae up to a level.
fn begun(store: &mut Store, case: &Case, count: usize) -> ReadingId {
    let films = store.films(&name("S1")).expect("films");
    let film = films.iter().find(|film| film.view == Posture::Erect.into()).expect("erect");
    let by = by(READER);
    let readings = store.readings(&name("S1")).expect("readings");
    let own = readings.iter().filter(|one| one.film == film.id && one.observer == by.who);
    let next = 1 + own.map(|one| one.repeat).max().unwrap_or(0);
    let reading = store.begin_reading(film.id, next, &by).expect("a new reading");
    let (_, landmarks) = reading_of(case, Posture::Erect);
    let clicks: Vec<_> = Level::MODEL[..count]
        .iter()
        .flat_map(|level| vertebra(*level, &landmarks.vertebrae[level]))
        .collect();
    record(store, reading, &clicks, &by);
    reading
}

/// A server with a reading that `fill` makes, and the address of the reading.
fn serve_reading(fill: impl FnOnce(&mut Store) -> ReadingId) -> (Running, String) {
    let mut reading = None;
    let running = serve(|store| reading = Some(fill(store)));
    (running, format!("/api/readings/{}", reading.expect("begun").0))
}

/// A server with the films of a case, and the address of a begun reading of its erect film. The reading has the lowest `count` vertebrae.
fn serve_begun(case: &Case, count: usize) -> (Running, String) {
    serve_reading(|store| {
        add_study(store, "S1", case);
        begun(store, case, count)
    })
}

#[test]
fn an_incomplete_reading_is_partial_and_names_missing_vertebrae() {
    let case = phantom().case;
    let (running, reading) = serve_begun(&case, 10);
    let live = running.get(&format!("{reading}/live"));
    assert_eq!(live["status"], "partial");
    assert_eq!(live["status_text"], "10 of 15 vertebrae; T6, T5, T4, T3 and T2 are missing");
    assert!(live["overlay"].is_null() && live["study"].is_null());
}

#[test]
fn a_reading_that_ends_at_t6_has_live_angles_a_curve_and_cobb_lines() {
    let case = phantom().case;
    let (running, reading) = serve_begun(&case, 11);
    let live = running.get(&format!("{reading}/live"));
    assert_eq!(live["status"], "partial");
    assert_eq!(live["status_text"], "11 of 15 vertebrae; T5, T4, T3 and T2 are missing");
    let curves = live["study"]["curves"].as_array().expect("curves").len();
    assert!(curves > 0, "{live}");
    let overlay = &live["overlay"];
    assert_eq!(overlay["curve_px"].as_array().map(Vec::len), Some(120));
    assert_eq!(overlay["cobb"].as_array().map(Vec::len), Some(curves));
    // The same angles as after the end of the reading.
    let body = json!({ "expected_revision": 44 });
    running.post(&format!("{reading}/finish"), &body);
    let finished = running.get("/api/studies/S1/findings");
    assert_eq!(finished["study"]["curves"], live["study"]["curves"]);
}

#[test]
fn a_complete_reading_gives_an_overlay_and_study_results() {
    let case = phantom().case;
    let (running, reading) = serve_reading(|store| {
        add_read_study(store, "S1", &case);
        begun(store, &case, 15)
    });
    let live = running.get(&format!("{reading}/live"));
    assert_numbers(&live, "live");
    assert_eq!(live["status"], "complete", "{live}");
    assert_eq!(live["study"]["curves"].as_array().map(Vec::len), Some(3));
    let codes: Vec<&str> = live["notices"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|n| n["code"].as_str())
        .collect();
    assert!(codes.contains(&"synthetic"), "{codes:?}");
    let overlay = &live["overlay"];
    assert_eq!(overlay["curve_px"].as_array().map(Vec::len), Some(120));
    assert_eq!(overlay["cobb"].as_array().map(Vec::len), Some(3));
    assert_eq!(overlay["inflections"].as_array().map(Vec::len), Some(2));
}

/// All places of an overlay.
fn places(overlay: &Value) -> Vec<[f64; 2]> {
    match overlay {
        Value::Array(items) if items.len() == 2 && items.iter().all(Value::is_number) => {
            vec![px(overlay)]
        }
        Value::Array(items) => items.iter().flat_map(places).collect(),
        Value::Object(fields) => fields.values().flat_map(places).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn overlays_lie_within_their_films_and_curves_pass_midpoints() {
    let case = phantom().case;
    let running = serve(|store| add_read_study(store, "S1", &case));
    for (film, posture) in (1..).zip(case.films.iter().map(|film| film.posture)) {
        let overlay = running.get(&format!("/api/studies/S1/films/{film}/overlay"));
        let (marked, reading) = reading_of(&case, posture);
        let FilmLandmarks::Corners { image, .. } = &marked.landmarks else { panic!("landmarks") };
        let all = places(&overlay);
        assert!(all.len() > 150, "{posture}");
        for [column, row] in &all {
            assert!(image.contains(Pixel::new(*column, *row)), "{posture}: {column}, {row}");
        }
        assert_eq!(
            overlay["lines"].as_array().map(Vec::len),
            Some(if posture == Posture::Erect { 0 } else { 3 })
        );
        let curve: Vec<[f64; 2]> =
            overlay["curve_px"].as_array().expect("a list").iter().map(px).collect();
        for residual in overlay["residuals"].as_array().expect("a list") {
            let from = px(&residual["from_px"]);
            // The crossing of the diagonals, computed in pixels: it does not depend on the scale.
            let level: Level =
                residual["level"].as_str().expect("a name").parse().expect("a level");
            let crossing = crossing(&reading.vertebrae[&level].corners);
            assert!(
                (from[0] - crossing[0]).hypot(from[1] - crossing[1]) < 1e-6,
                "{posture} {level}"
            );
            let to = px(&residual["to_px"]);
            let nearest = curve
                .iter()
                .map(|p| (p[0] - to[0]).hypot(p[1] - to[1]))
                .fold(f64::INFINITY, f64::min);
            // Half of the distance between two points of the drawn curve.
            let step = (curve[1][0] - curve[0][0]).hypot(curve[1][1] - curve[0][1]);
            assert!(nearest < step, "{posture} {level}: {nearest} px");
        }
    }
}

fn crossing(corners: &Corners<Pixel>) -> [f64; 2] {
    let [a, b, c, d] = [
        corners.superior_left,
        corners.inferior_right,
        corners.superior_right,
        corners.inferior_left,
    ]
    .map(|p| nalgebra::Vector2::new(p.column_px, p.row_px));
    let parts =
        nalgebra::Matrix2::from_columns(&[b - a, c - d]).lu().solve(&(c - a)).expect("they cross");
    (a + (b - a) * parts[0]).into()
}

#[test]
fn a_mirrored_film_has_the_mirrored_overlay() {
    let case = phantom().case;
    let mut mirrored = case.clone();
    mirrored.films.iter_mut().for_each(mirror);
    let running = serve(|store| {
        add_read_study(store, "S1", &case);
        add_read_study(store, "S2", &mirrored);
    });
    let films = case.films.len();
    for (film, marked) in case.films.iter().enumerate() {
        let FilmLandmarks::Corners { image, .. } = &marked.landmarks else { panic!("landmarks") };
        let last = f64::from(image.columns - 1);
        let [plain, turned] = [(1, film), (2, film + films)].map(|(study, film)| {
            running.get(&format!("/api/studies/S{study}/films/{}/overlay", film + 1))
        });
        let (plain, turned) = (places(&plain), places(&turned));
        assert_eq!(plain.len(), turned.len());
        for (a, b) in plain.iter().zip(&turned) {
            // Ends of clipped lines keep their order; fits agree to their tolerance.
            assert!(
                (last - a[0] - b[0]).hypot(a[1] - b[1]) < 1e-3,
                "{}: {a:?} {b:?}",
                marked.posture
            );
        }
    }
}

#[test]
fn swapped_sides_are_refused_with_a_reason() {
    let case = phantom().case;
    let mut wrong = case.clone();
    for film in &mut wrong.films {
        let FilmLandmarks::Corners { image, .. } = &mut film.landmarks else { panic!("landmarks") };
        image.patient_left = image.patient_left.opposite();
    }
    let (running, reading) = serve_reading(|store| {
        add_study(store, "S1", &wrong);
        begun(store, &case, 4)
    });
    let live = running.get(&format!("{reading}/live"));
    assert_eq!(live["status"], "refused");
    let text = live["status_text"].as_str().expect("words");
    assert!(text.contains("left and right corners are exchanged"), "{text}");
    assert_eq!(live["notices"][0]["severity"], "error");
}

#[test]
fn a_bending_film_has_its_curve_before_the_erect_film_is_read() {
    let case = phantom().case;
    let (running, reading) = serve_reading(|store| {
        let films = add_study(store, "S1", &case);
        let (_, film) =
            films.into_iter().find(|(p, _)| *p == Posture::LeftBending).expect("a bend");
        let by = by(READER);
        let begun = store.begin_reading(film, 1, &by).expect("a new reading");
        let (film, landmarks) = reading_of(&case, Posture::LeftBending);
        record(store, begun, &events(film, landmarks), &by);
        begun
    });
    let live = running.get(&format!("{reading}/live"));
    assert_eq!(live["status"], "complete");
    assert!(live["study"].is_null());
    assert_eq!(live["overlay"]["curve_px"].as_array().map(Vec::len), Some(120));
    assert_eq!(live["overlay"]["lines"], json!([]));
}

#[test]
fn blinded_readers_see_no_results() {
    let case = phantom().case;
    let (running, reading) = serve_reading(|store| {
        add_study(store, "S1", &case);
        let design = PlanDesign { repeats: 1, washout_days: 1, proposals: true };
        let random = &mut system_random;
        store
            .reading_plan(&name("S1"), &[name(READER)], design, random, &by("lead"))
            .expect("a plan");
        let who = name(READER);
        let next = store.observer(&who).next_film_for(&name("S1"), by(READER).at).expect("a plan");
        let spineline_store::Next::Begin(film) = next else { panic!("a film to begin") };
        store.begin_planned(&film.code, &by(READER)).expect("in turn")
    });
    let path = format!("{reading}/live");
    let (status, body) = running.ask("GET", &path, None);
    assert_eq!((status, &body["code"]), (403, &json!("blinded")));
}

#[test]
fn a_preview_gives_results_and_records_no_event() {
    let case = phantom().case;
    let (running, reading) = serve_begun(&case, 15);
    let before = running.get(&format!("{reading}/live"));
    let (_, landmarks) = reading_of(&case, Posture::Erect);
    let corner = landmarks.vertebrae[&Level::T8].corners.superior_left;
    let moved = json!({
        "kind": "move_corner", "level": "T8", "corner": "superior_left",
        "column_px": corner.column_px + 6.0, "row_px": corner.row_px,
    });
    let path = format!("{reading}/preview");
    let preview = running.post(&path, &json!({ "events": [moved], "turn_axis": null }));
    let residual = |live: &Value| {
        let all = live["overlay"]["residuals"].as_array().expect("a list").clone();
        all.into_iter().find(|r| r["level"] == "T8").map(|r| px(&r["from_px"])).expect("T8")
    };
    // Moving one corner moves the crossing of the diagonals on this film only.
    assert!((residual(&preview["live"])[0] - residual(&before)[0]).abs() > 1.0);
    assert_eq!(running.get(&format!("{reading}/live")), before);
    let midpoint = residual(&before);
    let towards = json!({ "level": "T8", "towards_px": [midpoint[0] + 10.0, midpoint[1] - 100.0] });
    let turned = running.post(&path, &json!({ "events": [], "turn_axis": towards }));
    let vertebrae = turned["reading"]["vertebrae"].as_array().expect("a list");
    let axis = vertebrae.iter().find(|v| v["level"] == "T8").map(|v| &v["axis"]).expect("T8");
    let deg = axis["axis_deg"].as_f64().expect("an angle");
    assert!(axis["by_hand"] == true && deg > 0.0);
    assert!((10.0 * deg - (10.0 * deg).round()).abs() < 1e-9, "{deg} is not in tenths");
}

#[test]
fn recorded_events_are_answered_with_their_results() {
    let case = phantom().case;
    let (running, reading) = serve_begun(&case, 15);
    let revision = running.get(&reading)["revision"].as_u64().expect("a number");
    let before = running.get(&format!("{reading}/live"));
    let (_, landmarks) = reading_of(&case, Posture::Erect);
    let corner = landmarks.vertebrae[&Level::T8].corners.superior_left;
    let moved = json!([{
        "kind": "move_corner", "level": "T8", "corner": "superior_left",
        "column_px": corner.column_px + 6.0, "row_px": corner.row_px,
    }]);
    let preview = running.post(&format!("{reading}/preview"), &json!({ "events": moved }));
    let body = json!({ "expected_revision": revision, "events": moved });
    let recorded = running.post(&format!("{reading}/events"), &body);
    assert_eq!(recorded["reading"]["revision"], json!(revision + 1));
    assert_eq!(recorded["live"]["status"], "complete", "{recorded}");
    assert_ne!(recorded["live"], before);
    // The same as during the drag, and after a reload.
    assert_eq!(recorded["live"], preview["live"]);
    assert_eq!(recorded["live"], running.get(&format!("{reading}/live")));
    assert_eq!(recorded["reading"], running.get(&reading));
    // A repeated request gets the same answer.
    assert_eq!(running.post(&format!("{reading}/events"), &body), recorded);
}

/// Codes of the notices of the erect film's open reading, after a change of its landmarks up to a level.
fn notices_of(count: usize, change: impl Fn(&mut Case), fill: impl Fn(&mut Store)) -> Vec<String> {
    let case = phantom().case;
    let mut odd = case.clone();
    change(&mut odd);
    let (running, reading) = serve_reading(|store| {
        add_study(store, "S1", &case);
        fill(store);
        begun(store, &odd, count)
    });
    let live = running.get(&format!("{reading}/live"));
    let notices = live["notices"].as_array().expect("a list").iter();
    notices.map(|notice| notice["code"].as_str().expect("a name").to_owned()).collect()
}

/// One vertebra of the erect film's only reading.
fn vertebra_mut(case: &mut Case, level: Level) -> &mut VertebraLandmarks {
    let film = case.film_mut(Posture::Erect).expect("erect");
    let readings = film.landmarks.corner_readings_mut();
    readings[0].vertebrae.get_mut(&level).expect("all are marked")
}

#[test]
fn doubtful_corners_of_an_incomplete_reading_are_named() {
    let thin = |case: &mut Case| {
        let corners = &mut vertebra_mut(case, Level::L1).corners;
        let (upper, lower) = (corners.superior_left, corners.inferior_left);
        corners.superior_left = Pixel::new(
            lower.column_px + 0.25 * (upper.column_px - lower.column_px),
            lower.row_px + 0.25 * (upper.row_px - lower.row_px),
        );
    };
    let wide = |case: &mut Case| {
        let corners = &mut vertebra_mut(case, Level::L1).corners;
        corners.superior_left.column_px +=
            0.8 * (corners.superior_left.column_px - corners.superior_right.column_px);
    };
    let turned = |case: &mut Case| {
        vertebra_mut(case, Level::L1).axis_clockwise = Some(Angle::from_deg(80.0));
    };
    for count in [8, 15] {
        let none = notices_of(count, |_| (), |_| ());
        let codes = ["body_sides_differ", "corner_far_from_neighbours", "axis_against_corners"];
        let changes: [&dyn Fn(&mut Case); 3] = [&thin, &wide, &turned];
        for (code, change) in codes.into_iter().zip(changes) {
            assert!(!none.iter().any(|known| known == code), "{none:?}");
            let found = notices_of(count, change, |_| ());
            let times = found.iter().filter(|known| *known == code).count();
            assert_eq!(times, 1, "{code} with {count} vertebrae: {found:?}");
        }
    }
}

#[test]
fn a_corner_far_from_the_finished_readings_of_its_film_is_named() {
    let odd = |case: &mut Case| {
        vertebra_mut(case, Level::L1).corners.superior_left.column_px += 80.0;
    };
    let twice = |store: &mut Store| {
        let case = phantom().case;
        let films = store.films(&name("S1")).expect("films");
        let film = films.iter().find(|film| film.view == Posture::Erect.into()).expect("erect");
        let (marked, landmarks) = reading_of(&case, Posture::Erect);
        for repeat in 1..=2 {
            let by = by(READER);
            let reading = store.begin_reading(film.id, repeat, &by).expect("a new reading");
            let revision = record(store, reading, &events(marked, landmarks), &by);
            store.finish_reading(reading, revision, &by).expect("a complete reading");
        }
    };
    let code = "corner_far_from_readings".to_owned();
    assert!(!notices_of(8, odd, |_| ()).contains(&code), "no other reading");
    assert!(!notices_of(8, |_| (), twice).contains(&code), "equal readings");
    assert!(notices_of(8, odd, twice).contains(&code));
}

#[test]
fn landmarks_of_another_posture_are_refused_by_both_names() {
    let case = phantom().case;
    let (running, reading) = serve_reading(|store| {
        let films = add_study(store, "S1", &case);
        let by = by(READER);
        let (_, landmarks) = reading_of(&case, Posture::Erect);
        let of_both =
            films.into_iter().filter(|(p, _)| [Posture::Erect, Posture::Neutral].contains(p));
        let begun = of_both.map(|(_, film)| {
            let begun = store.begin_reading(film, 1, &by).expect("a new reading");
            let clicks: Vec<_> = Level::MODEL[..15]
                .iter()
                .flat_map(|level| vertebra(*level, &landmarks.vertebrae[level]))
                .collect();
            record(store, begun, &clicks, &by);
            begun
        });
        begun.last().expect("two films")
    });
    let live = running.get(&format!("{reading}/live"));
    assert_eq!(live["notices"][0]["code"], "film_repeated", "{live}");
    let text = live["status_text"].as_str().expect("words");
    assert!(text.contains("erect") && text.contains("neutral"), "{text}");
}
