//! Exported models say which vertebrae were measured beyond the erect film, and which were assumed.

use serde_json::Value;
use spineline::analysis::{AnalysisOptions, AxialSource, PitchSource, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::measure::body_widths;
use spineline::multibody::{StiffnessLibrary, Support};
use spineline::spatial::Vec3;
use spineline_files::{ExportFormat, ModelFile, parse_model, to_text};
use spineline_phantom::{
    BentPhantom, Readers, Scenario, SpaceBending, SpaceSetup, generate, generate_bends_in_space,
};

use super::exports::{exported, model, named, numbers, read};

/// Levels that the lateral film shows, and those with pedicles, of the case below.
const ON_LATERAL: std::ops::RangeInclusive<Level> = Level::L4..=Level::T4;
const WITH_PEDICLES: std::ops::RangeInclusive<Level> = Level::T12..=Level::T6;

/// The text of a model of a synthetic patient in space whose upper vertebrae are hidden on the lateral film, and of whose pedicles
/// some are marked.
fn partly_measured() -> String {
    let bending = SpaceBending { support: Support::Frontal, library: StiffnessLibrary::default() };
    let found =
        generate_bends_in_space(&SpaceSetup { pedicles: true, ..SpaceSetup::default() }, &bending);
    let BentPhantom { erect, .. } = found.expect("a force bends it so far");
    let mut case = erect.case;
    let film = case.film_mut(Posture::Erect).expect("erect");
    let readings = film.landmarks.corner_readings_mut();
    assert!(!readings.is_empty(), "phantoms have corners");
    for (level, landmark) in readings.iter_mut().flat_map(|reading| &mut reading.vertebrae) {
        if !WITH_PEDICLES.contains(level) {
            landmark.pedicles = [None; 2];
        }
    }
    for reading in &mut case.lateral.as_mut().expect("a lateral film").readings {
        reading.vertebrae.retain(|level, _| ON_LATERAL.contains(level));
    }
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    to_text(&ModelFile::new(&analysis, &analysis.models[0], "test", None))
}

#[test]
fn every_format_says_what_was_measured() {
    let model = parse_model(&partly_measured()).expect("our own file").model;
    for ((level, pitch), axial) in model.levels.iter().zip(&model.pitch_from).zip(&model.axial_from)
    {
        let pitch_from = if ON_LATERAL.contains(level) {
            PitchSource::LateralFilm
        } else {
            PitchSource::Population
        };
        let axial_from = if WITH_PEDICLES.contains(level) {
            AxialSource::Pedicles
        } else {
            AxialSource::Unknown
        };
        assert_eq!((*pitch, *axial), (Some(pitch_from), Some(axial_from)), "{level}");
    }
    for format in ExportFormat::ALL {
        let text = exported(&model, format);
        for part in [
            "MEASURED on the lateral film (L4 to T4); ASSUMED, the profile of a population (T3 to T2)",
            "NOT KNOWN, and zero here (L4 to L1, T5 to T2); MEASURED from both pedicles on the erect film (T12 to T6)",
        ] {
            assert!(text.contains(part), "{format:?}: {part}");
        }
    }
}

#[test]
fn files_for_views_say_it_by_vertebra() {
    let model = parse_model(&partly_measured()).expect("our own file").model;
    let file: Value = serde_json::from_str(&exported(&model, ExportFormat::Gltf)).expect("JSON");
    let nodes = file["nodes"].as_array().expect("nodes");
    assert_eq!(nodes[0]["extras"]["pitch_from"], "lateral_film");
    assert_eq!(nodes[0]["extras"]["axial_rotation_from"], "unknown");
    assert_eq!(nodes[14]["extras"]["pitch_from"], "population");
    assert_eq!(nodes[6]["extras"]["axial_rotation_from"], "pedicles");
    let (all, _) = read(&exported(&model, ExportFormat::Vtp));
    let arrays = named(&all, "DataArray");
    for (name, measured) in [("pitch_measured", 13), ("axial_rotation_measured", 7)] {
        let found = arrays.iter().filter(|array| array.attribute("Name") == name);
        let counts: Vec<usize> = found
            .map(|array| array.text.split_whitespace().filter(|v| *v == "1").count())
            .collect();
        // Eight points and six sides of a vertebra.
        assert_eq!(counts, [8 * measured, 6 * measured], "{name}");
    }
}

/// The drawn width of every vertebra of a VTP file: between its first corner and the one to its left.
fn drawn_widths_mm(text: &str) -> Vec<f64> {
    let (all, _) = read(text);
    let arrays = named(&all, "DataArray");
    let points = arrays.iter().find(|array| array.attribute("Name") == "Points").expect("places");
    let points: Vec<Vec3> =
        numbers(points.text.trim()).chunks(3).map(Vec3::from_column_slice).collect();
    points.chunks(8).map(|corners| (corners[2] - corners[0]).norm()).collect()
}

#[test]
fn widths_are_those_between_the_corners_of_the_erect_film_and_else_typical() {
    let case = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists").case;
    let erect = case.film(Posture::Erect).expect("erect");
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let wanted: Vec<f64> = body_widths(erect, analysis.movement.levels())
        .into_iter()
        .map(|w| w.expect("corners"))
        .collect();
    let mut model = analysis.personalised_model(&analysis.models[0]);
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
    let text = exported(&model, ExportFormat::Vtp);
    assert!(near(&drawn_widths_mm(&text), &wanted));
    assert!(text.contains("MEASURED between the corners on the erect film (L4 to T2)"));
    let sizes = analysis.body_sizes();
    assert!(near(&sizes.iter().map(|size| size.width_mm).collect::<Vec<_>>(), &wanted));
    model.widths_mm[3] = None;
    let text = exported(&model, ExportFormat::Vtp);
    let drawn = drawn_widths_mm(&text);
    assert!((drawn[3] - wanted[3]).abs() > 1e-3, "L1 is typical now");
    assert!(near(&drawn[4..], &wanted[4..]));
    assert!(text.contains("scaled to the distances between vertebrae (L1)"), "{text}");
}

#[test]
fn a_model_without_a_lateral_film_is_assumed_and_a_file_may_not_say() {
    let frontal = model(Support::Frontal);
    assert!(frontal.pitch_from.iter().all(|from| *from == Some(PitchSource::Population)));
    assert!(frontal.axial_from.iter().all(|from| *from == Some(AxialSource::Unknown)));
    let mut silent: Value = serde_json::from_str(&partly_measured()).expect("JSON");
    for vertebra in silent["vertebrae"].as_array_mut().expect("vertebrae") {
        let vertebra = vertebra.as_object_mut().expect("a vertebra");
        assert!(vertebra.remove("pitch_from").is_some());
        assert!(vertebra.remove("axial_rotation_from").is_some());
    }
    let silent = parse_model(&silent.to_string()).expect("a file that does not say").model;
    let text = exported(&silent, ExportFormat::Mjcf);
    assert!(text.contains("which the model file does not say (L4 to T2)"), "{text}");
    for part in ["MEASURED on the lateral film", "MEASURED from both pedicles"] {
        assert!(!text.contains(part), "{part}");
    }
    let view = exported(&silent, ExportFormat::Vtp);
    assert!(view.contains("-1"), "not stated");
}
