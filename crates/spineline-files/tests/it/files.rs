//! Files: round trips, and errors with place and name.

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::{FilmView, ImageSide, Level, Posture};
use spineline::measure::{
    Corners, FilmLandmarks, ImageGeometry, LateralFilm, Origin, Placement, PlacementSource,
    Reading, ReadingId, Spacing, SpacingPlane, SpacingSource,
};
use spineline::multibody::{Load, Solution, Statics, StiffnessLibrary};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline::uncertainty::{LandmarkNoise, MonteCarlo};
use spineline_files::{
    AnalysisFile, CaseFile, FileError, FilmOrigin, FilmSource, InputFile, ModelFile, Provenance,
    Request, StiffnessFile, parse_case, parse_model, parse_stiffness, to_text,
};
use spineline_phantom::{Phantom, Readers, Scenario, SpaceSetup, generate, generate_in_space};

use super::repeat::run;

fn phantom(readers: &Readers) -> Phantom {
    generate(2, Scenario::Rod, readers, 5).expect("subject 3 exists")
}

fn text() -> String {
    to_text(&CaseFile::from_case(&phantom(&Readers::default()).case))
}

fn refused(text: &str) -> FileError {
    parse_case(text).expect_err("the text is wrong on purpose")
}

#[test]
fn a_case_round_trips() {
    let case = phantom(&Readers::default()).case;
    let once = to_text(&CaseFile::from_case(&case));
    let read = parse_case(&once).expect("our own file");
    // Hand-set axes pass through degrees; everything else is the same to the last bit.
    let twice = to_text(&CaseFile::from_case(&read));
    assert_eq!(once, twice);
    assert_eq!(case.films.len(), read.films.len());
    let exact = phantom(&Readers::exact()).case;
    assert_eq!(parse_case(&to_text(&CaseFile::from_case(&exact))).expect("our own file"), exact);
}

#[test]
fn confidences_and_estimated_levels_are_kept_in_a_case() {
    let mut case = phantom(&Readers::exact()).case;
    let readings = case.films[0].landmarks.corner_readings_mut();
    let t5 = readings[0].vertebrae.get_mut(&Level::T5).expect("marked");
    t5.confidence = Some(Corners {
        superior_left: 0.9,
        superior_right: 0.8,
        inferior_left: 0.125,
        inferior_right: 1.0,
    });
    let located = Placement::new(Frontal::new(1.0, 2.0), Angle::ZERO);
    case.films[1].landmarks = FilmLandmarks::Placements {
        spacing_plane: SpacingPlane::Detector,
        scale_relative_sd: Some(0.02),
        source: PlacementSource::SurfaceMidline,
        readings: vec![Reading {
            id: ReadingId::new("scan", 1),
            vertebrae: [(Level::T5, located)].into(),
        }],
    };
    let text = to_text(&CaseFile::from_case(&case));
    assert_eq!(parse_case(&text).expect("our own file"), case);
    let corners = text.replacen(
        "\"posture\": \"erect\"",
        "\"posture\": \"erect\", \"placement_source\": \"surface_midline\"",
        1,
    );
    assert!(matches!(refused(&corners), FileError::SourceOfCorners { .. }));
    let lengths = "\"posture\": \"erect\", \"lengths\": { \"plane\": \"patient\" }";
    let corners = text.replacen("\"posture\": \"erect\"", lengths, 1);
    assert!(matches!(refused(&corners), FileError::LengthsOfCorners { .. }));
}

#[test]
fn a_shape_of_pixels_round_trips_and_does_not_stand_beside_a_spacing() {
    // Synthetic.
    let text = |image: &str| {
        format!(
            r#"{{"format": "spineline-case", "version": 1, "case_id": "A", "synthetic": true, "films": [{{"posture": "erect", "image":
            {{"columns": 400, "rows": 500, {image}"patient_left": "image_left"}}, "readings": []}}], "lateral": {{"image":
            {{"columns": 400, "rows": 500, {image}"patient_anterior": "image_left"}}}}}}"#
        )
    };
    let of = |image: &str| parse_case(&text(image));
    let case = of(r#""pixel_aspect": 0.5, "#).expect("a case");
    let FilmLandmarks::Corners { image, .. } = &case.films[0].landmarks else { panic!("corners") };
    let lateral = case.lateral.as_ref().expect("a lateral film").image;
    for image in [*image, lateral] {
        assert_eq!(image.spacing.map(|spacing| spacing.aspect()), Some(0.5));
        assert_eq!(image.scale(), None);
    }
    assert_eq!(parse_case(&to_text(&CaseFile::from_case(&case))).expect("our own file"), case);
    for bad in [
        r#""pixel_aspect": 0.5, "column_spacing_mm": 0.1, "row_spacing_mm": 0.1, "#,
        r#""column_spacing_mm": 0.1, "#,
    ] {
        assert!(of(bad).is_err(), "{bad}");
        let lateral_alone = text("").replacen(
            r#""rows": 500, "patient_anterior""#,
            &format!(r#""rows": 500, {bad}"patient_anterior""#),
            1,
        );
        assert!(matches!(refused(&lateral_alone), FileError::LateralSpacing), "{bad}");
    }
}

#[test]
fn origins_walls_and_deviations_round_trip_and_are_absent_where_all_was_clicked() {
    let mut case = phantom(&Readers::default()).case;
    assert!(!to_text(&CaseFile::from_case(&case)).contains("origins"));
    let readings = case.films[0].landmarks.corner_readings_mut();
    let landmark = readings[0].vertebrae.values_mut().next().expect("a vertebra");
    let accepted = Corners::all(Origin::Accepted);
    landmark.origins = Corners { inferior_right: Origin::Adjusted, ..accepted };
    landmark.walls = [Some(Pixel::new(1200.25, 900.5)), None];
    landmark.sd_share = Some(0.0625);
    let text = to_text(&CaseFile::from_case(&case));
    let again = parse_case(&text).expect("our own file");
    assert_eq!(text, to_text(&CaseFile::from_case(&again)));
    let [read, written] = [&again, &case].map(|case| &case.films[0].landmarks.corner_readings()[0]);
    assert_eq!(read.vertebrae.values().next(), written.vertebrae.values().next());
    // A location and a tilt do not have corners with an origin.
    let mixed = text.replacen("\"accepted\"", "\"guessed\"", 1);
    assert!(parse_case(&mixed).is_err(), "an unknown origin");
}

#[test]
fn pedicles_round_trip() {
    let setup = SpaceSetup { pedicles: true, ..SpaceSetup::default() };
    let case = generate_in_space(&setup).case;
    let read = parse_case(&to_text(&CaseFile::from_case(&case))).expect("our own file");
    assert_eq!(read.films, case.films);
}

#[test]
fn spacing_provenance_picture_file_and_lateral_film_round_trip() {
    let mut case = phantom(&Readers::exact()).case;
    let spacing = |source, relative_sd| Spacing {
        column_mm: 0.14,
        row_mm: 0.15,
        plane: SpacingPlane::Detector,
        source,
        relative_sd,
    };
    for (film, spacing) in case.films.iter_mut().zip([
        Some(spacing(SpacingSource::Ball, Some(0.012))),
        Some(spacing(SpacingSource::Distances, None)),
        None,
    ]) {
        match &mut film.landmarks {
            FilmLandmarks::Corners { image, .. } => image.spacing = spacing,
            FilmLandmarks::Placements { .. } => panic!("phantoms have landmarks"),
        }
    }
    let corners = Corners {
        superior_left: Pixel::new(100.0, 200.0),
        superior_right: Pixel::new(400.0, 210.5),
        inferior_left: Pixel::new(90.0, 400.0),
        inferior_right: Pixel::new(395.25, 405.0),
    };
    case.lateral = Some(LateralFilm {
        image: ImageGeometry {
            columns: 2000,
            rows: 4000,
            spacing: Some(Spacing::stated(0.1, 0.2, SpacingPlane::Unknown)),
            patient_left: ImageSide::Right,
        },
        simultaneous: true,
        readings: vec![Reading {
            id: ReadingId::new("A", 2),
            vertebrae: [(Level::L3, corners)].into(),
        }],
    });
    let source = |file: &str| FilmSource {
        file: Some(file.to_owned()),
        sha256: Some(spineline_files::sha256_hex(file.as_bytes())),
        inverted: true,
    };
    let file = CaseFile::from_case(&case)
        .with_source(Posture::Erect, source("erect.dcm"))
        .with_source(FilmView::Lateral, source("side.dcm"));
    let text = to_text(&file);
    assert_eq!(parse_case(&text).expect("our own file"), case);
    let read: CaseFile = serde_json::from_str(&text).expect("our own file");
    assert_eq!(read.source(Posture::Erect), Some(source("erect.dcm")));
    assert_eq!(read.source(Posture::Neutral), Some(FilmSource::default()));
    assert_eq!(read.source(FilmView::Lateral), Some(source("side.dcm")));
}

#[test]
fn a_spacing_without_its_plane_is_refused() {
    let one = text().replacen("\"column_spacing_mm\": 0.1,", "", 1);
    assert!(matches!(refused(&one), FileError::SpacingIncomplete { .. }));
    let pixels =
        text().replacen("\"spacing_plane\": \"patient\"", "\"spacing_plane\": \"pixels\"", 1);
    assert!(matches!(refused(&pixels), FileError::SpacingOfPixels { .. }));
    let source = text().replacen(
        "\"spacing_plane\": \"patient\"",
        "\"spacing_plane\": \"patient\", \"spacing_source\": \"bal\"",
        1,
    );
    assert!(refused(&source).to_string().contains("ball"), "{}", refused(&source));
}

#[test]
fn a_file_saved_a_hundred_times_keeps_its_bytes() {
    let first = text();
    let mut now = first.clone();
    for _ in 0..100 {
        now = to_text(&CaseFile::from_case(&parse_case(&now).expect("our own file")));
    }
    assert_eq!(first, now);
}

#[test]
fn an_unknown_key_is_reported_with_place_and_nearest_known_key() {
    let wrong = text().replacen("\"superior_left\"", "\"superior_lfet\"", 1);
    match refused(&wrong) {
        FileError::UnknownKey { key, nearest, place, line } => {
            assert_eq!(key, "superior_lfet");
            assert_eq!(nearest.as_deref(), Some("superior_left"));
            assert!(place.contains("films[0].readings[0].vertebrae") && line > 1, "{place}");
        }
        other => panic!("not about the key: {other}"),
    }
}

#[test]
fn a_list_with_too_many_values_is_named_as_one_with_too_few_is() {
    let with = |key: &str, list: &[f64]| {
        let mut case: serde_json::Value = serde_json::from_str(&text()).expect("JSON");
        case["films"][0]["readings"][0]["vertebrae"]["T8"][key] = list.into();
        refused(&serde_json::to_string_pretty(&case).expect("JSON"))
    };
    let place = "in `films[0].readings[0].vertebrae.T8.superior_left`: ";
    let few = with("superior_left", &[1.0]).to_string();
    let many = with("superior_left", &[1.0, 2.0, 3.0]).to_string();
    assert!(few.contains(&format!("{place}1 values where a list of 2 is expected")), "{few}");
    assert!(many.contains(&format!("{place}more values than expected")), "{many}");
    assert!(matches!(with("confidence", &[0.5; 5]), FileError::Value { .. }));
    // Text after the JSON, or within it, is a fault of syntax.
    for wrong in [text() + "]", text().replacen('[', "[5 5 ", 1)] {
        assert!(matches!(refused(&wrong), FileError::Syntax { .. }), "{}", refused(&wrong));
    }
}

#[test]
fn a_repeated_level_is_an_error() {
    let wrong = text().replacen("\"T7\":", "\"T8\":", 1);
    assert!(refused(&wrong).to_string().contains("T8 is given twice"), "{}", refused(&wrong));
    // Two spellings of one vertebra are the same vertebra.
    let wrong = text().replacen("\"T7\":", "\"Th8\":", 1);
    assert!(refused(&wrong).to_string().contains("T8 is given twice"));
}

#[test]
fn an_unknown_vertebra_is_named() {
    let wrong = text().replacen("\"T7\":", "\"T13\":", 1);
    assert!(refused(&wrong).to_string().contains("`T13` is not a vertebra"), "{}", refused(&wrong));
}

#[test]
fn not_a_number_is_refused_as_json() {
    let wrong = text().replacen("\"column_spacing_mm\": 0.1", "\"column_spacing_mm\": NaN", 1);
    assert!(matches!(refused(&wrong), FileError::Syntax { .. }), "{}", refused(&wrong));
    let wrong = text().replacen("\"column_spacing_mm\": 0.1", "\"column_spacing_mm\": 1e999", 1);
    assert!(matches!(refused(&wrong), FileError::Syntax { .. } | FileError::Value { .. }));
    assert!(matches!(refused(&text()[..500]), FileError::Syntax { .. }), "cut short");
    // Deep nesting gives an error and no stack overflow.
    refused(&"[".repeat(100_000));
    refused(&"{\"films\":".repeat(100_000));
}

#[test]
fn other_formats_and_newer_versions_are_reported() {
    let model = text().replacen("spineline-case", "spineline-model", 1);
    assert!(matches!(refused(&model), FileError::Format { .. }));
    // Cut off or not: the header says what it is.
    assert!(matches!(refused(&model[..model.len() / 2]), FileError::Format { .. }));
    let case = text();
    assert!(matches!(refused(&case[..case.len() / 2]), FileError::Syntax { .. }));
    assert!(matches!(refused("{}"), FileError::Format { .. }));
    for list in ["[1]", "[]", &format!("[{case}]"), "\u{feff} [\"spineline-case\", 1]"] {
        assert_eq!(refused(list).to_string(), "it is a list, and a file holds one case");
    }
    let newer = text().replacen("\"version\": 1", "\"version\": 2", 1);
    assert!(matches!(refused(&newer), FileError::Version { found: 2, supported: 1 }));
}

#[test]
fn an_incomplete_vertebra_and_corners_without_a_picture_are_refused() {
    let half = r#"{"format":"spineline-case","version":1,"case_id":"a","films":[{"posture":"erect",
        "readings":[{"observer":"A","repeat":1,"vertebrae":{"L4":{"location_mm":[0,0]}}}]}]}"#;
    assert!(refused(half).to_string().contains("L4"), "{}", refused(half));
    let bare = r#"{"format":"spineline-case","version":1,"case_id":"a","films":[{"posture":"neutral",
        "readings":[{"observer":"A","repeat":1,"vertebrae":{"L4":{"superior_left":[0,0],
        "superior_right":[1,0],"inferior_left":[0,1],"inferior_right":[1,1]}}}]}]}"#;
    assert!(matches!(refused(bare), FileError::NoImage { posture: Posture::Neutral }));
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_are_read() {
    let windows = format!("\u{feff}{}", text().replace('\n', "\r\n"));
    assert!(parse_case(&windows).is_ok());
}

#[test]
fn a_stored_model_gives_the_shapes_of_the_analysis() {
    // Oracle: the simulation inside of the analysis, computed from the unstored model.
    let case = phantom(&Readers::default()).case;
    let options = AnalysisOptions::default();
    let analysis = analyze(&case, &options).expect("a phantom");
    for model in &analysis.models {
        let stored = parse_model(&to_text(&ModelFile::new(&analysis, model, "test", None)))
            .expect("our own file");
        let stored = stored.model;
        assert!(stored.spine == analysis.personalised_model(model).spine, "to the last bit");
        let joints = vec![0; stored.stiffness_nmm_per_rad.len()];
        let stiffness = stored.stiffness_nmm_per_rad.iter().copied();
        let statics = Statics::from_stiffness(&stored.spine, stiffness, &joints, stored.support);
        for (simulation, load) in
            model.simulations.iter().zip(&stored.loads).filter(|(s, _)| s.is_usable())
        {
            assert!((simulation.force_n - load.force_n).abs() == 0.0);
            let mut solution = Solution::default();
            let line = Load::along(simulation.line, simulation.depth_mm);
            statics.solve(&line, &[load.force_n], &[], &mut solution);
            for (i, place) in simulation.shape.locations.iter().enumerate() {
                // The axes of a vertebra pass through decimal text and back without loss; so do the places.
                assert!(
                    solution.deformed.location(i).distance_mm(*place) < 1e-8,
                    "{} {i}",
                    model.kind
                );
            }
        }
    }
}

fn provenance() -> Provenance {
    Provenance::new(run(), FilmOrigin::Synthetic, vec![InputFile::of("case.json", b"{}")])
}

fn analysis_file(analysis: &Analysis, case: &Case) -> AnalysisFile {
    let request = Request { options: analysis.options.clone(), ..Request::default() };
    AnalysisFile::new(analysis, CaseFile::from_case(case), provenance().asking(&request))
}

#[test]
fn an_analysis_file_says_synthetic() {
    let case = phantom(&Readers::default()).case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let file = analysis_file(&analysis, &case);
    let text = to_text(&file);
    for key in [
        "\"synthetic\": true",
        "\"inflection_line\"",
        "\"contradicted_joints\"",
        "\"fitted\": false",
        "\"segment_mm\"",
    ] {
        assert!(text.contains(key), "{key}");
    }
}

#[test]
fn an_analysis_file_has_uncertainty_where_it_was_asked_for() {
    let case = phantom(&Readers::default()).case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let monte_carlo =
        MonteCarlo::new(&case, &analysis, LandmarkNoise::Pixels(2.0), 1).expect("sound noise");
    let mut tally = monte_carlo.tally();
    (0..3).for_each(|index| tally.add(&monte_carlo.replicate(index)));
    let plain = analysis_file(&analysis, &case);
    assert!(!to_text(&plain).contains("\"uncertainty\""));
    let file = plain.with_uncertainty(&analysis, Some(&tally.finish(4)));
    let text = to_text(&file);
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let found = &json["uncertainty"];
    assert_eq!((&found["replicates"], &found["done"]), (&4.into(), &3.into()));
    assert_eq!(found["noise"]["erect"]["source"], "given");
    let cobb = found["quantities"].as_array().expect("a list").iter().find(|q| {
        q["quantity"] == "cobb" && q["posture"] == "erect" && q["group"] == "main_thoracic"
    });
    let cobb = cobb.expect("the main curve");
    assert_eq!(cobb["unit"], "deg");
    assert_eq!(cobb["value"], json["clinical"]["curves"]["main_thoracic"]["cobb_deg"]["erect"]);
    assert!(cobb["sd"].as_f64().is_some_and(|sd| sd > 0.0));
}

#[test]
fn an_analysis_file_contains_the_identifiability_of_multipliers() {
    let case = phantom(&Readers::default()).case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let plain = analysis_file(&analysis, &case);
    assert!(!to_text(&plain).contains("\"identifiability\""));
    let found: Vec<_> = analysis.models.iter().map(|m| analysis.identifiability(m)).collect();
    let text = to_text(&plain.with_identifiability(&analysis, Some(&found)));
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let model = &json["models"]["inflection_line"];
    let records = model["identifiability"]["multipliers"].as_object().expect("by name");
    assert_eq!(records.len(), model["multipliers"].as_object().expect("by name").len());
    for (name, record) in records {
        let value = model["multipliers"][name].as_f64().expect("a number");
        assert_eq!(record["verdict"], "interval", "{name}");
        let ends = [0, 1].map(|end| record["interval_95"][end].as_f64().expect("an end"));
        let mean = record["stiffness"].as_f64().expect("a number");
        assert!(ends[0] < mean && mean < ends[1], "{name}: {mean} in {ends:?}");
        assert!((mean / value).ln().abs() < 0.3, "{name}: {mean}, and the multiplier {value}");
    }
    let directions = model["identifiability"]["directions"].as_array().expect("a list");
    assert_eq!(directions.len(), records.len());
    // Orthogonal directions share the direction that the gauge fixes.
    let shares: f64 = directions.iter().filter_map(|d| d["gauge_share"].as_f64()).sum();
    assert!((shares - 1.0).abs() < 1e-9, "{shares}");
}

#[test]
fn the_stiffness_table_round_trips_and_a_missing_joint_is_named() {
    let library = StiffnessLibrary::default();
    let text = to_text(&StiffnessFile::from(&library));
    let read = parse_stiffness(&text).expect("our own file");
    for (a, b) in read.rows().iter().zip(library.rows()) {
        assert_eq!((a.inferior, a.superior, &a.source), (b.inferior, b.superior, &b.source));
        for (x, y) in a.nmm_per_rad.iter().zip(b.nmm_per_rad) {
            // Newton metres in the file, newton millimetres inside.
            assert!((x - y).abs() < 1e-9 * y);
        }
    }
    let negative =
        text.replacen("\"lateral_nm_per_rad\": 132.0", "\"lateral_nm_per_rad\": -1.0", 1);
    assert!(
        parse_stiffness(&negative).expect_err("a negative spring").to_string().contains("L4/L3")
    );
}

#[test]
fn every_schema_is_an_object_that_requires_its_format() {
    let names: Vec<&str> = spineline_files::schema_names().collect();
    assert_eq!(
        names,
        [
            "case",
            "analysis",
            "cohort",
            "model",
            "load",
            "provenance",
            "refused-case",
            "reliability",
            "rotation-prior",
            "simulation",
            "stiffness",
        ]
    );
    for name in names {
        let schema = spineline_files::schema(name).expect("a known format");
        let schema: serde_json::Value = serde_json::from_str(schema).expect("JSON");
        let required = schema.get("required").and_then(|r| r.as_array()).expect("required keys");
        assert!(required.iter().any(|key| key == "format"), "{name}");
    }
    assert!(spineline_files::schema("picture").is_none());
}
