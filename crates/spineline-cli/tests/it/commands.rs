//! Commands from first to last: phantom, check, analyze and export.

use std::fs;

use crate::program::{add_phantom, done, folder, refused, run, with_phantom, words};
use crate::results::results;

#[test]
fn every_command_has_a_help_text() {
    let here = folder();
    let (text, _, code) = run(here.path(), &["--help"]);
    assert_eq!(code, 0);
    for word in [
        "reproduce",
        "analyze",
        "check",
        "phantom",
        "simulate",
        "schema",
        "completions",
        "Validate case files and list warnings",
        "Manage user accounts and study permissions",
        "not a medical device",
    ] {
        assert!(text.contains(word), "{word}");
    }
    assert_eq!(run(here.path(), &["analyze"]).2, 2, "nothing to analyse is a wrong call");
    assert_eq!(run(here.path(), &["analyse"]).2, 2, "an unknown word is a wrong call");
    assert!(run(here.path(), &["completions", "bash"]).0.contains("spineline"));
}

#[test]
fn every_command_has_a_manual_page() {
    let here = folder();
    let (page, _, code) = run(here.path(), &["manual"]);
    assert_eq!(code, 0);
    assert!(page.contains(".TH spineline 1") && page.contains("Validate case files"), "{page}");
    let (page, _, code) = run(here.path(), &["manual", "study", "add"]);
    assert_eq!(code, 0);
    for word in [".TH spineline-study-add 1", "spineline study add", "\\-\\-accept"] {
        assert!(page.contains(word), "{word} is missing in\n{page}");
    }
    let (_, error, code) = run(here.path(), &["manual", "study", "ad"]);
    assert_eq!(code, 2);
    assert!(error.contains("`study ad`") && error.contains("give one of"), "{error}");
}

/// The options in the file of an analysis.
pub fn options_of(here: &std::path::Path, more: &[&str]) -> serde_json::Value {
    let line = [&["analyze", "cases", "--json", "a.json", "--overwrite"], more].concat();
    let (text, error, code) = run(here, &line);
    assert_eq!(code, 0, "{text}\n{error}");
    let text = fs::read_to_string(here.join("a.json")).expect("it was written");
    let file: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    file["provenance"]["options"].clone()
}

#[test]
fn the_papers_method_is_one_option_that_others_replace() {
    let here = with_phantom(&[]);
    let given = ["--tilt=axis", "--amplitude=t1-l5", "--order-rule=paper"];
    let given =
        [&given[..], &["--film-lengths=as-marked", "--support=free", "--fit=ferguson"]].concat();
    let paper = options_of(here.path(), &["--method", "paper"]);
    assert_eq!(paper, options_of(here.path(), &given));
    let mut frontal = paper;
    frontal["support"] = "frontal".into();
    for line in [["--support=frontal", "--method=paper"], ["--method=paper", "--support=frontal"]] {
        assert_eq!(options_of(here.path(), &line), frontal);
    }
    done(here.path(), &["report", "cases", "--method", "paper", "--out", "paper.md"]);
    let text = fs::read_to_string(here.path().join("paper.md")).expect("it was written");
    assert!(text.contains("Method: the paper's."), "{text}");
}

#[test]
fn a_phantom_is_made_checked_and_analysed() {
    let here = with_phantom(&[]);
    let (text, error, code) = run(here.path(), &["check", "cases"]);
    assert_eq!(code, 0, "{error}");
    assert!(text.contains("phantom-rod-01 · SYNTHETIC"), "{text}");
    let (text, _, code) = run(here.path(), &["analyze", "cases", "--support", "frontal", "--full"]);
    assert_eq!(code, 0, "{text}");
    for word in [
        "SYNTHETIC",
        "inflection line",
        "held out",
        "A single force through the inflections is kept by the bending films",
        "only ratios are identified",
    ] {
        assert!(words(&text).contains(word), "{word} is missing in\n{text}");
    }
}

#[test]
fn the_json_has_its_documented_keys() {
    let here = with_phantom(&[]);
    let (text, _, _) = run(here.path(), &["analyze", "cases/phantom-rod-01.json", "--json", "-"]);
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON and nothing else");
    for pointer in [
        "/chain/segments",
        "/chain/segment_mm",
        "/inflections/0/segment",
        "/inflections/0/between/0",
        "/inflections/1/erect_mm/1",
        "/postures/erect/curve/order",
        "/postures/erect/curve/rmse_mm",
        "/postures/left_bending/curve/rmse_deg",
        "/postures/traction/locations_mm/T2/0",
        "/postures/neutral/tilts_deg/L4",
        "/postures/neutral/mean_rotation_deg",
        "/postures/right_bending/inflection_mm/1/1",
        "/models/inflection_line/multipliers/main_thoracic",
        "/models/iliac_line/multipliers/thoracolumbar_lumbar",
        "/models/estimated_line/postures/left_bending/status",
        "/models/inflection_line/postures/left_bending/force",
        "/models/inflection_line/postures/left_bending/line/point_mm/0",
        "/models/inflection_line/postures/left_bending/line/direction/1",
        "/models/inflection_line/postures/left_bending/ferguson_error_deg/main_thoracic",
        "/models/inflection_line/postures/left_bending/location_error_mm/mean",
        "/models/inflection_line/postures/left_bending/location_error_mm/levels/T2",
        "/models/inflection_line/postures/neutral/fitted",
        "/models/inflection_line/postures/neutral/contradicted_joints",
        "/warnings",
    ] {
        assert!(json.pointer(pointer).is_some_and(|value| !value.is_null()), "{pointer}");
    }
    assert_eq!(json["synthetic"], true);
    assert_eq!(json["models"]["inflection_line"]["postures"]["neutral"]["fitted"], false);
}

#[test]
fn replicates_give_intervals_that_do_not_depend_on_threads() {
    let here = with_phantom(&["--scenario", "rod", "--subject", "2"]);
    let case = "cases/phantom-rod-02.json";
    let with = |more: &[&str]| run(here.path(), &[&["analyze", case], more].concat());
    // More than one block, so that their order counts.
    let asked = ["--replicates", "300", "--seed", "4", "--noise", "2.5"];
    let json = |threads: &str| with(&[&asked[..], &["--json", "-", "--threads", threads]].concat());
    let (one, _, code) = json("1");
    assert_eq!(code, 0);
    assert_eq!(results(&one), results(&json("2").0), "the same bytes for one thread and two");
    let json: serde_json::Value = serde_json::from_str(&one).expect("JSON and nothing else");
    assert_eq!(json["uncertainty"]["done"], 300);
    assert_eq!(json["uncertainty"]["noise"]["neutral"]["corner_sd_px"][1], 2.5);

    let (text, _, _) = with(&["--replicates", "20", "--full"]);
    let counted = "20 replicates, seed 1; 0 of them failed";
    for word in [counted, "readings of this case", "95 % interval", "Cobb angle"] {
        assert!(words(&text).contains(word), "{word} is missing in\n{text}");
    }
    assert!(!with(&[]).0.contains("replicates"));
    assert_eq!(with(&["--noise", "2"]).2, 2, "noise without replicates does nothing");
    assert_eq!(with(&["--replicates", "20", "--noise", "-2"]).2, 2);
    let help = run(here.path(), &["analyze", "--help"]).0;
    assert!(help.contains("--replicates") && help.contains("measured|PX"), "{help}");
}

#[test]
fn identifiability_is_reported_on_request_with_and_without_a_prior() {
    let here = with_phantom(&["--scenario", "rod", "--subject", "2"]);
    let case = "cases/phantom-rod-02.json";
    let with = |more: &[&str]| run(here.path(), &[&["analyze", case, "--full"], more].concat()).0;
    let plain = with(&[]);
    assert!(!plain.contains("Identifiability of the multipliers"), "{plain}");
    // Heads of columns may be broken; a test of `spineline-report` reads them whole.
    for word in ["Line of best fit to the rotations", "p: through", "p: parallel"] {
        assert!(plain.contains(word), "{word} is missing in\n{plain}");
    }
    let asked = with(&["--identifiability"]);
    for word in ["Identifiability of the multipliers", "the films identify", "Least known"] {
        assert!(asked.contains(word), "{word} is missing in\n{asked}");
    }
    let prior = ["--identifiability", "--multipliers", "per-joint", "--prior", "in-vivo"];
    assert!(with(&prior).contains("share"));
    let json = with(&[&prior[..], &["--json", "-"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON and nothing else");
    assert_eq!(json["provenance"]["options"]["prior"], "in-vivo");
    let joint = &json["models"]["inflection_line"]["identifiability"]["multipliers"]["L4/L3"];
    let [films, both] = ["log_sd", "log_sd_with_prior"].map(|key| joint[key].as_f64());
    assert!(both < films && both < Some(0.5), "{joint}");
    let wrong = run(here.path(), &["analyze", case, "--prior", "9"]);
    assert!(wrong.2 == 2 && wrong.1.contains("0.01 to 5"), "{}", wrong.1);
}

#[test]
fn other_loads_are_compared_on_request() {
    let here = with_phantom(&["--scenario", "couple", "--subject", "2"]);
    let case = "cases/phantom-couple-02.json";
    let asked = ["analyze", case, "--compare-models", "inflection-line,couple"];
    let (text, error, code) = run(here.path(), &asked);
    assert!(code == 0 && text.contains("couple"), "{code} {error}\n{text}");
    let (text, _, _) = run(here.path(), &[&asked[..], &["--json", "-"]].concat());
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON and nothing else");
    assert!(json["hypotheses"]["couple"].is_object(), "{}", json["hypotheses"]);
    assert!(run(here.path(), &["analyze", case, "--compare-models", "magic"]).1.contains("couple"));
}

#[test]
fn a_cohort_is_the_same_for_any_number_of_threads() {
    let here = folder();
    for subject in ["1", "5", "11"] {
        add_phantom(here.path(), &["--scenario", "pull", "--subject", subject]);
    }
    let with = |threads: &str| {
        run(here.path(), &["analyze", "cases", "--json", "-", "--threads", threads])
    };
    assert_eq!(results(&with("1").0), results(&with("3").0));
    let (text, _, _) = run(here.path(), &["analyze", "cases"]);
    assert!(text.contains("3 patients · SYNTHETIC") && text.contains("phantom-pull-11"), "{text}");
}

#[test]
fn tables_models_and_figures_are_written_completely() {
    let here = with_phantom(&["--scenario", "rod", "--subject", "3"]);
    let arguments = [
        "analyze",
        "cases/phantom-rod-03.json",
        "--csv",
        "out/rows.csv",
        "--model",
        "out/model.json",
        "--model-line",
        "estimated",
        "--figures",
        "out/figures",
        "--json",
        "out/analysis.json",
    ];
    let (_, error, code) = run(here.path(), &arguments);
    assert!(code == 0 || code == 4, "{error}");
    let read = |name: &str| fs::read_to_string(here.path().join(name)).expect("it was written");
    assert!(read("out/model.json").contains("\"line\": \"estimated_line\""));
    let rows = read("out/rows.csv");
    assert!(rows.starts_with("case_id,synthetic,posture,level,measured_y_mm"), "{rows}");
    assert!(rows.lines().count() > 15 * 5);
    assert!(read("out/figures/phantom-rod-03-overview.svg").contains("</svg>"));
    assert!(!here.path().join("out/model.json.part").exists());
    assert!(read("out/analysis.json").contains("\"spineline-analysis\""));
}

#[test]
fn bad_input_ends_with_3_and_names_file_film_and_vertebra() {
    let here = with_phantom(&[]);
    let path = here.path().join("cases/phantom-rod-01.json");
    let mut case: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(&path).expect("the case")).expect("JSON");
    // Two corners of T7 exchanged in one reading.
    let t7 = &mut case["films"][1]["readings"][0]["vertebrae"]["T7"];
    let (left, right) = (t7["superior_left"].clone(), t7["superior_right"].clone());
    t7["superior_left"] = right;
    t7["superior_right"] = left;
    fs::write(here.path().join("crossed.json"), case.to_string()).expect("written");
    let error = refused(here.path(), &["analyze", "crossed.json"], 3);
    for word in ["crossed.json", "left bending film", "T7", "diagonals", "help:"] {
        assert!(error.contains(word), "{word} is missing in {error}");
    }
    let error = refused(here.path(), &["analyze", "nowhere.json"], 3);
    assert!(error.contains("nowhere.json"), "{error}");
    // In a cohort the other cases are still analysed.
    fs::copy(here.path().join("crossed.json"), here.path().join("cases/a.json")).expect("copied");
    let (text, error, code) = run(here.path(), &["analyze", "cases"]);
    assert_eq!(code, 3);
    assert!(error.contains("a.json") && text.contains("phantom-rod-01"), "{text}{error}");
}

#[test]
fn wrong_options_are_refused_with_the_valid_ones() {
    let here = folder();
    for (arguments, word) in [
        (["analyze", "x.json", "--order-rule", "3"], "4 to 12"),
        (["analyze", "x.json", "--gauge", "known-force:sitting=3"], "unknown posture `sitting`"),
        (["analyze", "x.json", "--inflections", "T6"], "two sites"),
        (["analyze", "x.json", "--given-line", "neutral=1,2"], "POSTURE=Y,Z,TILT"),
        (["analyze", "x.json", "--support", "table"], "frontal"),
        (["phantom", "--subject", "19", "--seed=1"], "1 to 18"),
    ] {
        let error = refused(here.path(), &arguments, 2);
        assert!(error.contains(word), "{word} is missing in {error}");
    }
}

#[test]
fn a_known_force_makes_forces_absolute() {
    let here = with_phantom(&[]);
    let arguments = [
        "analyze",
        "cases",
        "--json",
        "-",
        "--gauge",
        "known-force:traction=120",
        "--support",
        "frontal",
    ];
    let (text, _, _) = run(here.path(), &arguments);
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let model = &json["models"]["inflection_line"];
    let force = model["postures"]["traction"]["force"].as_f64().expect("a force");
    assert!((force - 120.0).abs() < 1e-9, "{force}");
    assert_eq!(model["absolute"], true);
}

#[test]
fn a_given_line_and_given_inflections_are_used() {
    let here = with_phantom(&["--scenario", "pull", "--subject", "1"]);
    let arguments = [
        "analyze",
        "cases",
        "--json",
        "-",
        "--inflections",
        "L1/T12,T6",
        "--given-line",
        "left_bending=0,300,-90",
    ];
    let (text, error, _) = run(here.path(), &arguments);
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert!(error.contains("chosen by hand"), "{error}");
    let line = &json["models"]["given_line"]["postures"]["left_bending"]["line"];
    assert!((line["direction"][0].as_f64().expect("y") - 1.0).abs() < 1e-12, "{line}");
    let [disc, vertebra] = [&json["inflections"][0], &json["inflections"][1]];
    assert!(disc["between"][1] == "T12" && disc["vertebra"].is_null(), "{disc}");
    assert_eq!(vertebra["vertebra"], "T6");
    let by_hand = ["analyze", "cases", "--inflections", "L1/T12,T6"];
    let shown = run(here.path(), &by_hand).0;
    assert!(words(&shown).contains("Inflections: L1/T12 and T6."), "{shown}");
    done(here.path(), &[&by_hand[..], &["--tables", "tables"]].concat());
    let patients = fs::read_to_string(here.path().join("tables/patients.csv")).expect("a table");
    let rows: Vec<Vec<&str>> = patients.lines().map(|row| row.split(',').collect()).collect();
    for (column, place) in [("caudal", "L1/T12"), ("cranial", "T6")] {
        let name = format!("inflection_{column}_between");
        let at = rows[0].iter().position(|found| *found == name).expect("a column");
        assert_eq!(rows[1][at], place);
    }
}

#[test]
fn a_model_is_exported_for_three_engines_and_unknown_formats_are_refused() {
    let here = with_phantom(&[]);
    let case = "cases/phantom-rod-01.json";
    done(here.path(), &["analyze", case, "--model", "model.json"]);
    for (format, root) in [("mjcf", "<mujoco "), ("osim", "<OpenSimDocument "), ("urdf", "<robot ")]
    {
        let text = done(here.path(), &["export", "model.json", "--to", format]);
        assert!(text.contains(root) && text.contains("SYNTHETIC"), "{format}");
        let out = format!("spine.{format}");
        run(here.path(), &["export", "model.json", "--to", format, "--out", &out]);
        assert_eq!(fs::read_to_string(here.path().join(out)).expect("a file"), text);
    }
    let error = refused(here.path(), &["export", "model.json", "--to", "sdf"], 2);
    assert!(error.contains("sdf") && error.contains("mjcf, osim, sto, loads, urdf"), "{error}");
    let error = refused(here.path(), &["export", case, "--to", "mjcf"], 3);
    assert!(error.contains(case) && error.contains("spineline-model"), "{error}");
    let text = fs::read_to_string(here.path().join("model.json")).expect("a file");
    let wrong = text.replacen("\"case_id\": \"", "\"case_id\": \"\\u0007", 1);
    fs::write(here.path().join("wrong.json"), wrong).expect("a file");
    let error = refused(here.path(), &["export", "wrong.json", "--to", "urdf"], 3);
    assert!(error.contains("wrong.json: `case_id`") && error.contains("help:"), "{error}");
}

#[test]
fn films_of_a_phantom_are_written_beside_their_case() {
    let here = folder();
    let command = ["phantom", "--subject", "5", "--films", "--pixel-size", "4", "--out", "cases"];
    let (text, _, code) = run(here.path(), &command);
    assert_eq!(code, 0);
    assert!(text.contains("5 synthetic films beside the cases"), "{text}");
    let cases = here.path().join("cases");
    let json = |name: &str| -> serde_json::Value {
        let text = std::fs::read_to_string(cases.join(name)).expect("a file");
        serde_json::from_str(&text).expect("JSON")
    };
    let (case, truth) = (json("phantom-rod-05.json"), json("phantom-rod-05.truth.json"));
    for film in case["films"].as_array().expect("a list") {
        let file = film["image"]["file"].as_str().expect("text");
        let bytes = std::fs::read(cases.join(file)).expect("the film");
        assert_eq!(&bytes[128..132], b"DICM");
        let stated = &truth["films"][film["posture"].as_str().expect("text")];
        assert_eq!(stated["file"], file);
        assert_eq!(stated["vertebrae_px"].as_object().expect("an object").len(), 17);
    }
    let (_, _, code) = run(here.path(), &["check", "cases/phantom-rod-05.json"]);
    assert_eq!(code, 0);
}

#[test]
fn landmarks_are_exported_for_image_programs() {
    let here = with_phantom(&["--scenario", "rod", "--subject", "3"]);
    let case = "cases/rod-03.json";
    let case = if here.path().join(case).exists() { case } else { "cases/phantom-rod-03.json" };
    let table = done(here.path(), &["export", case, "--to", "csv"]);
    assert!(
        table.starts_with("posture,observer,repeat,vertebra,superior_left_column_px"),
        "{table}"
    );
    let list = done(here.path(), &["export", case, "--to", "slicer", "--posture", "erect"]);
    assert!(list.contains("\"coordinateSystem\": \"LPS\""), "{list}");
    let (_, error, code) = run(here.path(), &["export", case, "--to", "slicer"]);
    assert!(code == 2 && error.contains("folder"), "{error}");
    let out = ["export", case, "--to", "slicer", "--out", "lists"];
    done(here.path(), &out);
    assert!(here.path().join("lists/left_bending.mrk.json").exists());
    let keypoints = done(here.path(), &["export", case, "--to", "coco"]);
    assert!(keypoints.contains("\"file_name\": \"left_bending.png\""), "{keypoints}");
    let out = ["export", case, "--to", "labelme", "--posture", "erect", "--out", "points"];
    done(here.path(), &out);
    assert!(here.path().join("points/erect-1.json").exists());
    // Phantoms have no pictures, which a report needs.
    let out = ["export", case, "--to", "dicom-sr", "--out", "reports"];
    let (_, error, code) = run(here.path(), &out);
    assert!(code == 3 && error.contains("DICOM file"), "{error}");
}

#[test]
fn a_model_has_no_landmarks_and_a_case_no_springs() {
    let here = with_phantom(&["--scenario", "rod", "--subject", "3"]);
    let case = "cases/rod-03.json";
    let case = if here.path().join(case).exists() { case } else { "cases/phantom-rod-03.json" };
    done(here.path(), &["analyze", case, "--model", "model.json"]);
    let (_, error, code) = run(here.path(), &["export", "model.json", "--to", "slicer"]);
    assert!(
        code == 3
            && error.contains("spineline-model")
            && error.contains("landmarks belong to a case"),
        "{error}"
    );
    let (_, error, code) = run(here.path(), &["export", case, "--to", "mjcf"]);
    assert!(code == 3 && error.contains("takes a model"), "{error}");
}
