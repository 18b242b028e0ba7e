//! Load and simulation files: every kind is read, and errors name number, kind and vertebra.

use spineline::analysis::{AnalysisOptions, PersonalisedModel, analyze};
use spineline::multibody::{BodyLoad, Timing};
use spineline::response::{erect_shape, measure_angles};
use spineline::spatial::{Angle, Mat3, Vec3};
use spineline_files::{
    FileError, LoadFile, ModelFile, Simulated, parse_load, parse_model, to_text,
};
use spineline_phantom::{Readers, Scenario, generate};

const EVERY_KIND: &str = r#"[
  {"kind":"force_on_line","level":"T2","force":[0,10,0],"point_mm":[-10,0,380]},
  {"kind":"force_at_point","level":"T8","force":[1,2,3],"point_in_vertebra_mm":[1,0,0],"timing":"held"},
  {"kind":"force_at_point","level":"T8","force":[1,2,3]},
  {"kind":"follower_force","level":"T5","force_in_vertebra":[0,5,0],"point_in_vertebra_mm":[0,0,2]},
  {"kind":"moment","level":"T3","moment":[100,0,0]},
  {"kind":"follower_moment","level":"T3","moment_in_vertebra":[0,100,0]},
  {"kind":"gravity","body_weight":40},
  {"kind":"pad","level":"T9","point_in_vertebra_mm":[0,-40,0],"direction":[0,1,0],"force_per_mm":2,"advance_mm":5},
  {"kind":"strap","level":"Th4","anchor_mm":[0,-200,300],"force_per_mm":1,"shortening_mm":5},
  {"kind":"rod","inferior":"T12","superior":"T6","turn_deg":[90,0,0],"timing":"held"}
]"#;

fn file(loads: &str) -> String {
    format!(r#"{{"format":"spineline-load","version":1,"loads":{loads}}}"#)
}

fn model_text() -> String {
    let phantom = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists");
    let analysis = analyze(&phantom.case, &AnalysisOptions::default()).expect("a phantom");
    to_text(&ModelFile::new(&analysis, &analysis.models[0], "test", None))
}

fn model() -> PersonalisedModel {
    parse_model(&model_text()).expect("our own file").model
}

/// The error of invalid loads.
fn refused(loads: &str) -> FileError {
    match parse_load(&file(loads)).map(|read| read.place(&model())) {
        Err(error) | Ok(Err(error)) => error,
        Ok(Ok(_)) => panic!("accepted: {loads}"),
    }
}

#[test]
fn every_load_kind_is_read_and_placed() {
    let read = parse_load(&file(EVERY_KIND)).expect("sound");
    let placed = read.place(&model()).expect("on this model");
    // Nine loads on vertebrae, of which gravity makes fourteen; one rod.
    assert_eq!(placed.loading.items.len(), 8 + 14);
    assert_eq!(
        (placed.load_of_item[5], placed.load_of_item[6], placed.load_of_item[19]),
        (5, 6, 6)
    );
    assert_eq!(placed.load_of_rod, [9]);
    let items = &placed.loading.items;
    assert_eq!((items[0].vertebra, items[0].timing), (14, Timing::Proportional));
    assert_eq!((items[1].vertebra, items[1].timing), (8, Timing::Constant));
    assert_eq!(items[6].timing, Timing::Constant, "gravity is held unless told otherwise");
    let BodyLoad::ForceAtPoint { force_n, .. } = items[19].load else { panic!("a slice") };
    assert!(force_n.z < 0.0 && force_n.x == 0.0, "down is caudal");
    let rod = &placed.loading.rods[0];
    assert_eq!((rod.inferior, rod.superior), (4, 10));
    assert!((rod.turn_rad - Vec3::new(Angle::from_deg(90.0).rad(), 0.0, 0.0)).norm() < 1e-15);
}

#[test]
fn pads_straps_and_rods_say_how_far_they_move() {
    let loads = r#"[
      {"kind":"pad","level":"T9","direction":[0,0.6,0.8],"force_per_mm":2,"advance_mm":10},
      {"kind":"strap","level":"T4","anchor_mm":[0,-200,300],"force_per_mm":1.5,"shortening_mm":5},
      {"kind":"rod","inferior":"L1","superior":"T6","turn_deg":[-5,0,0],"shift_mm":[0,-3,0],"timing":"held"},
      {"kind":"rod","inferior":"L1","superior":"T6","turn_deg":[5,0,0]},
      {"kind":"rod","inferior":"L1","superior":"T6"}
    ]"#;
    let read = parse_load(&file(loads)).expect("sound");
    let words =
        |unit: &str| -> Vec<String> { read.loads.iter().map(|load| load.words(unit)).collect() };
    assert_eq!(
        words("N"),
        [
            "pad on T9: 6.0 mm to the left, 8.0 mm cranial, spring 2 N/mm",
            "strap on T4: shortened by 5 mm, spring 1.5 N/mm",
            "rod from L1 to T6: moves T6 from its erect pose by 5.0° bending left and 3.0 mm to the right (constant)",
            "rod from L1 to T6: moves T6 from its erect pose by 5.0° bending right",
            "rod from L1 to T6: keeps their erect pose",
        ]
    );
    let relative = words(model().force_unit());
    assert!(relative[1].ends_with("spring 1.5 relative units per mm"), "{}", relative[1]);
}

#[test]
fn loads_round_trip() {
    let read = parse_load(&file(EVERY_KIND)).expect("sound");
    let text = to_text(&read);
    assert_eq!(parse_load(&text).expect("our own file"), read);
    assert_eq!(to_text(&LoadFile::new(read.loads)), text);
}

#[test]
fn unknown_keys_are_reported_with_the_nearest_name_and_kinds_with_all() {
    let error = refused(
        r#"[{"kind":"pad","level":"T8","directon":[0,1,0],"force_per_mm":1,"advance_mm":1}]"#,
    );
    assert!(
        error.to_string().contains("`loads[0]`: unknown key `directon`; did you mean `direction`"),
        "{error}"
    );
    assert!(error.help().contains("load"));
    let error = refused(r#"[{"kind":"padd","level":"T8"}]"#);
    let text = error.to_string();
    assert!(text.contains("`pad`") && !text.contains("did you mean"), "{text}");
    let error = refused(r#"[{"kind":"moment","level":"T8"}]"#);
    assert!(error.to_string().contains("the key `moment` is missing"), "{error}");
    assert!(matches!(refused("[]"), FileError::NoLoads));
    let bare = parse_load(r#"{"format":"spineline-load","version":1,"load":[]}"#);
    assert!(bare.expect_err("a misspelt key").to_string().contains("did you mean `loads`"));
    assert!(matches!(parse_load(&model_text()), Err(FileError::Format { .. })));
}

#[test]
fn an_inapplicable_load_is_reported_with_number_kind_and_vertebra() {
    let sound = r#"{"kind":"gravity","body_weight":40}"#;
    for (load, words) in [
        (r#"{"kind":"moment","level":"T1","moment":[1,2,3]}"#, ["(moment, T1)", "from L4 to T2"]),
        (r#"{"kind":"moment","level":"L4","moment":[1,2,3]}"#, ["(moment, L4)", "fixed"]),
        (
            r#"{"kind":"pad","level":"T8","direction":[0,2,0],"force_per_mm":1,"advance_mm":1}"#,
            ["(pad, T8)", "length 2"],
        ),
        (
            r#"{"kind":"pad","level":"T8","direction":[0,1,0],"force_per_mm":-1,"advance_mm":1}"#,
            ["(pad, T8)", "-1 per mm"],
        ),
        (
            r#"{"kind":"rod","inferior":"T6","superior":"T12"}"#,
            ["(rod, T6 to T12)", "T6 is not below T12"],
        ),
        (
            r#"{"kind":"rod","inferior":"T12","superior":"T6","turn_deg":[200,0,0]}"#,
            ["(rod, T12 to T6)", "180°"],
        ),
        (r#"{"kind":"gravity","body_weight":-4}"#, ["gravity", "-4"]),
        (r#"{"kind":"gravity","body_weight":4,"down":[0,0,-2]}"#, ["gravity", "length 2"]),
        (sound, ["load 2 (gravity", "load 1 is gravity with the same timing"]),
    ] {
        let error = refused(&format!("[{sound},{load}]")).to_string();
        assert!(
            error.starts_with("load 2 (") && words.iter().all(|word| error.contains(word)),
            "{error}"
        );
    }
    let growing = r#"{"kind":"gravity","body_weight":40,"timing":"growing"}"#;
    let both = parse_load(&file(&format!("[{sound},{growing}]"))).expect("loads");
    assert!(both.place(&model()).is_ok(), "a held and a growing weight");
}

#[test]
fn a_stored_model_gives_the_angles_of_its_analysis() {
    // Oracle: the analysis, which measures the film itself.
    let phantom = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists");
    let analysis = analyze(&phantom.case, &AnalysisOptions::default()).expect("a phantom");
    let places = model().curves.expect("regions are written");
    let measured = measure_angles(&erect_shape(&model().spine), &places);
    for (curve, expected) in measured.curves.iter().zip(&analysis.movement.clinical) {
        assert_eq!(curve.region, expected.region);
        assert!((curve.ends.size() - expected.erect_size()).rad().abs() < 1e-12);
        assert!((curve.ferguson - expected.ferguson[0].1).rad().abs() < 1e-12);
    }
}

#[test]
fn models_without_regions_and_coupled_springs_are_read() {
    let mut json: serde_json::Value = serde_json::from_str(&model_text()).expect("JSON");
    json.as_object_mut().expect("an object").remove("regions");
    let plain = parse_model(&json.to_string()).expect("a file without regions").model;
    assert_eq!(plain.curves, None);
    let diagonal = Mat3::from_diagonal(&Vec3::from(plain.stiffness_nmm_per_rad[3]));
    assert_eq!(plain.stiffness[3], diagonal);
    let rows = [[5e4, 1e3, 0.0], [1e3, 6e4, 2e3], [0.0, 2e3, 7e4]];
    json["joints"][3]["stiffness_matrix"] = serde_json::json!(rows);
    let coupled = parse_model(&json.to_string()).expect("a matrix").model;
    assert_eq!(coupled.stiffness[3], Mat3::from_fn(|i, k| rows[i][k]));
    assert_eq!(coupled.stiffness_nmm_per_rad, plain.stiffness_nmm_per_rad);
    json["regions"] = serde_json::json!([{ "region": "main_thoracic", "inferior": "T6", "apex": "T9",
        "superior": "T12", "cobb_inferior": "T12", "cobb_superior": "T6" }]);
    assert!(matches!(parse_model(&json.to_string()), Err(FileError::RegionOrder { .. })));
}

#[test]
fn a_simulation_file_is_read_by_its_type() {
    let loads = parse_load(&file(r#"[{"kind":"force_at_point","level":"T2","force":[0,20,0]}]"#))
        .expect("sound");
    let simulated = Simulated::at_full_load(model(), loads).expect("sound loads");
    let (text, response) = (to_text(&simulated.file("test")), &simulated.response);
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    // Full precision: the number in the file is the number of the solver.
    let top = json["equilibria"][0]["midpoints_mm"]["T2"][1].as_f64().expect("a number");
    assert!((top - response.equilibria[0].equilibrium.deformed.midpoints_mm[14].y).abs() == 0.0);
    let names: Vec<&String> =
        json["equilibria"][0]["hinges_rad"].as_object().expect("joints").keys().collect();
    assert_eq!((names[0].as_str(), names[13].as_str()), ("L4/L3", "T3/T2"));
}

#[test]
fn a_joint_in_the_wrong_order_is_refused() {
    let mut json: serde_json::Value = serde_json::from_str(&model_text()).expect("JSON");
    json["joints"].as_array_mut().expect("joints").swap(3, 4);
    let error = parse_model(&json.to_string()).expect_err("joints out of order");
    assert_eq!(error.to_string(), "found joint T12/T11 where joint L1/T12 is expected");
}

#[test]
fn axes_that_do_not_form_a_rotation_are_refused() {
    let refused = |factor: f64| {
        let mut json: serde_json::Value = serde_json::from_str(&model_text()).expect("JSON");
        for number in json["vertebrae"][5]["axes"][1].as_array_mut().expect("an axis") {
            *number = (number.as_f64().expect("a number") * factor).into();
        }
        parse_model(&json.to_string()).expect_err("no rotation").to_string()
    };
    assert!(refused(1.001).starts_with("T11: its axes depart"), "{}", refused(1.001));
    assert!(refused(-1.0).contains("left-handed"), "{}", refused(-1.0));
}

#[test]
fn a_model_file_that_claims_too_much_is_refused() {
    let sound: serde_json::Value = serde_json::from_str(&model_text()).expect("JSON");
    let refused = |key: &str, value: serde_json::Value| {
        let mut file = sound.clone();
        file[key] = value;
        parse_model(&file.to_string()).expect_err(key).to_string()
    };
    assert!(refused("absolute", true.into()).contains("only a known force gives newtons"));
    assert!(refused("case_id", "../../x\n\u{1b}".into()).contains("`case_id`"));
    let mut empty = sound.clone();
    (empty["vertebrae"], empty["joints"]) = (serde_json::json!([]), serde_json::json!([]));
    let error = parse_model(&empty.to_string()).expect_err("no vertebrae").to_string();
    assert!(error.contains("at least two vertebrae"), "{error}");
}

#[test]
fn vertebrae_where_no_body_has_them_are_refused_with_their_distance() {
    // Oracle: neighbouring midpoints lie centimetres apart, the upper one cranial.
    let changed = |change: fn(&mut serde_json::Value)| {
        let mut value: serde_json::Value = serde_json::from_str(&model_text()).expect("JSON");
        value["vertebrae"].as_array_mut().expect("a list").iter_mut().for_each(change);
        parse_model(&value.to_string()).expect_err("no body")
    };
    for (error, sign) in [
        (changed(|vertebra| scale(vertebra, 0.001)), 1.0),
        (changed(|vertebra| scale(vertebra, 10.0)), 1.0),
        (changed(|vertebra| scale(vertebra, -1.0)), -1.0),
    ] {
        let text = error.to_string();
        let FileError::ModelPlace { cranial_mm, .. } = error else { panic!("{text}") };
        assert!(cranial_mm * sign > 0.0, "{text}");
        assert!(text.contains("L3 lies") && text.contains("2 mm to 90 mm"), "{text}");
    }
}

fn scale(vertebra: &mut serde_json::Value, factor: f64) {
    for place in vertebra["midpoint_mm"].as_array_mut().expect("a place") {
        *place = (place.as_f64().expect("a number") * factor).into();
    }
}
