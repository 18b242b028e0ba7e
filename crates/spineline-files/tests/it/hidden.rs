//! Files of patients whose films do not show every vertebra.

use serde_json::Value;
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::measure::{Corners, Origin};
use spineline_files::{
    AnalysisFile, CaseFile, FilmOrigin, ModelFile, Provenance, Request, parse_analysis, parse_load,
    parse_model, to_text,
};
use spineline_phantom::{Readers, Scenario, generate};

use super::repeat::run;

fn whole() -> Case {
    generate(0, Scenario::Bend, &Readers::exact(), 1).expect("subject 1 exists").case
}

/// The same patient with T2 and T3 hidden on one film, and T8 on another.
fn partial() -> Case {
    let mut case = whole();
    for film in &mut case.films {
        for reading in film.landmarks.corner_readings_mut() {
            reading.vertebrae.retain(|&level, _| match film.posture {
                Posture::Neutral => level < Level::T3,
                Posture::LeftBending => level != Level::T8,
                _ => true,
            });
        }
    }
    case
}

fn analyzed(case: &Case) -> Analysis {
    analyze(case, &AnalysisOptions::default()).expect("enough is marked")
}

fn json(analysis: &Analysis, case: &Case) -> Value {
    let provenance = Provenance::new(run(), FilmOrigin::Synthetic, Vec::new());
    let request = Request { options: analysis.options.clone(), ..Request::default() };
    let file = AnalysisFile::new(analysis, CaseFile::from_case(case), provenance.asking(&request));
    serde_json::from_str(&to_text(&file)).expect("JSON")
}

#[test]
fn an_analysis_file_marks_interpolated_vertebrae_and_has_only_what_is_seen() {
    let case = partial();
    let file = json(&analyzed(&case), &case);
    let bend = &file["postures"]["left_bending"];
    let interpolated = &bend["interpolated"]["T8"];
    assert_eq!(interpolated["between"], serde_json::json!(["T9", "T7"]));
    assert!(interpolated["location_sd_mm"].as_f64().is_some_and(|sd| (0.5..2.5).contains(&sd)));
    assert!(interpolated["tilt_sd_deg"].as_f64().is_some_and(|sd| sd > 4.0));
    let levels = bend["locations_mm"].as_object().expect("places");
    assert!(levels.contains_key("T8") && levels.contains_key("T4") && !levels.contains_key("T3"));
    let errors = &file["models"]["iliac_line"]["postures"]["left_bending"]["location_error_mm"];
    let compared = errors["levels"].as_object().expect("errors");
    assert!(compared.contains_key("T7") && !compared.contains_key("T8"));
    // A complete film lacks this key.
    let case = whole();
    let file = json(&analyzed(&case), &case);
    assert!(file["postures"]["left_bending"].get("interpolated").is_none());
}

#[test]
fn an_analysis_file_states_origins_where_a_person_did_not_click() {
    let mut case = whole();
    let left = case.film_mut(Posture::LeftBending).expect("a bend");
    let readings = left.landmarks.corner_readings_mut();
    for landmark in readings.iter_mut().flat_map(|reading| reading.vertebrae.iter_mut()) {
        match landmark {
            (Level::T8, landmark) => landmark.origins = Corners::all(Origin::Adjusted),
            (Level::T9, landmark) => landmark.origins.superior_left = Origin::Adjusted,
            _ => {}
        }
    }
    let file = json(&analyzed(&case), &case);
    let expected = serde_json::json!({ "T9": "mixed", "T8": "adjusted" });
    assert_eq!(file["postures"]["left_bending"]["origins"], expected);
    // Where all corners were clicked, the key is absent.
    assert!(file["postures"]["erect"].get("origins").is_none());
    // What the file says is enough to compute it again.
    let stored = parse_analysis(&to_text(&file)).expect("our own file");
    assert_eq!(json(&analyzed(&stored.case), &stored.case)["postures"], file["postures"]);
}

#[test]
fn a_shorter_model_is_stored_and_carries_the_weight_of_what_is_above() {
    let analysis = analyzed(&partial());
    let text = to_text(&ModelFile::new(&analysis, &analysis.models[0], "test", None));
    let stored = parse_model(&text).expect("our own file").model;
    assert_eq!((stored.levels.len(), stored.top()), (13, Level::T4));
    assert_eq!(stored.known_levels(), Some(analysis.movement.levels()));
    let load =
        r#"{"format":"spineline-load","version":1,"loads":[{"kind":"gravity","body_weight":400}]}"#;
    let weight = |text: &str| {
        let model = parse_model(text).expect("our own file").model;
        let placed = parse_load(load).expect("a load").place(&model).expect("on this model");
        let force = |item: &spineline::multibody::LoadItem| match item.load {
            spineline::multibody::BodyLoad::ForceAtPoint { force_n, .. } => force_n.norm(),
            _ => panic!("weights are forces"),
        };
        placed.loading.items.iter().map(force).sum::<f64>()
    };
    // Oracle: the trunk above L4 weighs the same, wherever the model ends.
    let analysis = analyzed(&whole());
    let complete = to_text(&ModelFile::new(&analysis, &analysis.models[0], "test", None));
    assert!((weight(&text) - weight(&complete)).abs() < 1e-9);
}
