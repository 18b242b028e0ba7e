//! A study with a lateral film and pedicles: the spine in space in its results, and readings of the lateral film.

use serde_json::{Value, json};
use spineline::analysis::Case;
use spineline::anatomy::{FilmView, Posture};
use spineline::spatial::Angle;
use spineline_files::{CaseFile, FilmSource};
use spineline_phantom::{SpaceSetup, generate_in_space};
use spineline_store::{NewCase, StoreError};

use super::server::{Running, by, serve};

/// A synthetic case of an erect and a lateral film, with pedicles.
fn case() -> Case {
    let apical_rotation = Angle::from_deg(12.0);
    let setup = SpaceSetup { apical_rotation, pedicles: true, ..SpaceSetup::default() };
    let file = CaseFile::from_case(&generate_in_space(&setup).case);
    // As files have it: without the plane of the lateral film's spacing.
    spineline_files::parse_case(&spineline_files::to_text(&file)).expect("a case")
}

/// A server with the case as a study of its name.
fn serving(case: &Case) -> Running {
    let named = |file: &str| FilmSource { file: Some(file.to_owned()), ..FilmSource::default() };
    let file = CaseFile::from_case(case)
        .with_source(Posture::Erect, named("erect.dcm"))
        .with_source(FilmView::Lateral, named("lateral.dcm"));
    let text = spineline_files::to_text(&file);
    let bytes_of = |file: &str| Ok::<_, StoreError>(file.as_bytes().to_vec());
    let new = NewCase::read(&text, bytes_of).expect("a case");
    serve(|store| {
        let added = store.add_case(&new, &by("lead")).expect("a study");
        assert_eq!(added.remarks, []);
    })
}

fn film_of(running: &Running, study: &str, view: FilmView) -> i64 {
    let summary = running.get(&format!("/api/studies/{study}"))["summary"].clone();
    let films = summary["films"].as_array().expect("films").iter();
    let film = films.clone().find(|film| film["posture"] == view.key()).expect("its film");
    film["film"].as_i64().expect("a number")
}

#[test]
fn an_analysis_from_the_store_has_the_spine_in_space_of_its_case() {
    let case = case();
    let running = serving(&case);
    let study = format!("/api/studies/{}", case.id);
    let taken = running.get(&format!("{study}/case"));
    let taken = spineline_files::parse_case(&taken.to_string()).expect("a case");
    assert!(taken == case, "films, landmarks and pedicles come back");
    let analysis = running.get(&format!("{study}/exports/analysis"));
    let vertebrae = analysis["space"]["vertebrae"].as_object().expect("vertebrae");
    let marked = case.lateral.as_ref().map(|film| film.readings[0].vertebrae.len());
    assert_eq!(Some(vertebrae.len()), marked);
    let model = running.get(&format!("{study}/model"));
    let pitch_from = model["pitch_from"].as_array().expect("sources");
    let bodies = model["bodies"].as_array().expect("bodies");
    assert_eq!(pitch_from.len(), bodies.len());
    for (source, body) in pitch_from.iter().zip(bodies) {
        let is_marked = vertebrae.contains_key(body["level"].as_str().expect("a level"));
        assert_eq!(source, if is_marked { "lateral_film" } else { "population" });
    }
    let rotations = analysis["axial_rotation"].as_object().expect("rotations");
    assert!(rotations.len() > 10, "{}", rotations.len());
}

#[test]
fn the_lateral_film_is_read_by_the_corners_of_its_own() {
    let case = case();
    let running = serving(&case);
    let film = film_of(&running, &case.id, FilmView::Lateral);
    let reading = running.post(&format!("/api/films/{film}/readings"), &json!({ "repeat": 2 }));
    assert_eq!(
        (&reading["posture"], &reading["image"]["is_lateral"]),
        (&json!("lateral"), &json!(true))
    );
    assert_eq!(
        reading["next"],
        json!({ "kind": "corner", "level": "L4", "corner": "superior_anterior" })
    );
    assert_eq!(reading["next_by_walls"], Value::Null);
    let path = format!("/api/readings/{}", reading["reading"]);
    let corners = [
        ("superior_anterior", 300.0, 900.0),
        ("superior_posterior", 400.0, 910.0),
        ("inferior_posterior", 400.0, 1000.0),
        ("inferior_anterior", 300.0, 990.0),
    ];
    let events = |mirrored: bool| -> Value {
        let place = |(corner, column, row): (&str, f64, f64)| {
            let column_px = if mirrored { 700.0 - column } else { column };
            json!({ "kind": "place_corner", "level": "L4", "corner": corner,
                "column_px": column_px, "row_px": row })
        };
        corners.map(place).into_iter().collect()
    };
    // One order is wrong for each direction in which the patient may face.
    let mut found = Vec::new();
    for mirrored in [false, true] {
        let asked = json!({ "events": events(mirrored), "turn_axis": null });
        let preview = running.post(&format!("{path}/preview"), &asked);
        let reading = &preview["reading"];
        found.push((reading["faults"].clone(), reading["vertebrae"][0]["axis"]["text"].clone()));
        assert_eq!(preview["live"]["overlay"], Value::Null);
        if reading["faults"] == json!([]) {
            assert_eq!(
                preview["live"]["status_text"].as_str().map(|text| &text[..18]),
                Some("1 of 15 vertebrae;")
            );
        }
    }
    found.sort_by_key(|(faults, _)| faults.as_array().map(Vec::len));
    assert_eq!(found[0].0, json!([]));
    let text = found[0].1.as_str().expect("an axis");
    assert!(text.starts_with("pitch "), "{text}");
    let fault = found[1].0[0]["text"].as_str().expect("a fault");
    assert!(fault.contains("front and back corners are exchanged"), "{fault}");
    let crest = json!({ "expected_revision": 0, "events": [{ "kind": "place_iliac_crest", "side": "left", "column_px": 3.0, "row_px": 3.0 }] });
    assert_eq!(running.ask("POST", &format!("{path}/events"), Some(&crest)).0, 422);
}
