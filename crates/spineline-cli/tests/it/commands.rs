//! Commands from first to last: phantom, check, analyze and export.

use std::fs;

use serde_json::Value;

use crate::program::{CASE, Here, assert_says, folder, json, split, unwrapped, with_phantom};
use crate::results::results;

#[test]
fn every_command_has_a_help_text() {
    let here = folder();
    let text = here.done(&["--help"]);
    assert_says(
        &text,
        &[
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
        ],
    );
    assert_eq!(here.run(&["analyze"]).2, 2, "nothing to analyse is a wrong call");
    assert_eq!(here.run(&["analyse"]).2, 2, "an unknown word is a wrong call");
    assert!(here.run(&["completions", "bash"]).0.contains("spineline"));
}

#[test]
fn every_command_has_a_manual_page() {
    let here = folder();
    let page = here.done(&["manual"]);
    assert!(page.contains(".TH spineline 1") && page.contains("Validate case files"), "{page}");
    let page = here.done(&["manual", "study", "add"]);
    assert_says(&page, &[".TH spineline-study-add 1", "spineline study add", "\\-\\-accept"]);
    let error = here.refused(&["manual", "study", "ad"], 2);
    assert!(error.contains("`study ad`") && error.contains("give one of"), "{error}");
}

/// The options in the file of an analysis.
pub fn options_of(here: &Here, more: &[&str]) -> Value {
    here.done(&[&["analyze", "cases", "--json", "a.json", "--overwrite"], more].concat());
    here.json("a.json")["provenance"]["options"].clone()
}

#[test]
fn the_papers_method_is_one_option_that_others_replace() {
    let here = with_phantom(&[]);
    let given = ["--tilt=axis", "--amplitude=t1-l5", "--order-rule=paper"];
    let given =
        [&given[..], &["--film-lengths=as-marked", "--support=free", "--fit=ferguson"]].concat();
    let paper = options_of(&here, &["--method", "paper"]);
    assert_eq!(paper, options_of(&here, &given));
    let mut frontal = paper;
    frontal["support"] = "frontal".into();
    for line in [["--support=frontal", "--method=paper"], ["--method=paper", "--support=frontal"]] {
        assert_eq!(options_of(&here, &line), frontal);
    }
    here.done(&["report", "cases", "--method", "paper", "--out", "paper.md"]);
    let text = here.text("paper.md");
    assert!(text.contains("Method: the paper's."), "{text}");
}

#[test]
fn a_phantom_is_made_checked_and_analysed() {
    let here = with_phantom(&[]);
    let text = here.done(&["check", "cases"]);
    assert!(text.contains("phantom-rod-01 · SYNTHETIC"), "{text}");
    let text = here.done(&["analyze", "cases", "--support", "frontal", "--full"]);
    assert_says(
        &unwrapped(&text),
        &[
            "SYNTHETIC",
            "inflection line",
            "held out",
            "A single force through the inflections is kept by the bending films",
            "only ratios are identified",
        ],
    );
}

#[test]
fn the_json_has_its_documented_keys() {
    let here = with_phantom(&[]);
    let (text, _, _) = here.run(&["analyze", CASE, "--json", "-"]);
    let json = json(&text);
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
    let with = |more: &[&str]| here.run(&[&["analyze", case], more].concat());
    // More than one block, so that their order counts.
    let asked = ["--replicates", "300", "--seed", "4", "--noise", "2.5"];
    let on = |threads: &str| with(&[&asked[..], &["--json", "-", "--threads", threads]].concat());
    let (one, _, code) = on("1");
    assert_eq!(code, 0);
    assert_eq!(results(&one), results(&on("2").0), "the same bytes for one thread and two");
    let json = json(&one);
    assert_eq!(json["uncertainty"]["done"], 300);
    assert_eq!(json["uncertainty"]["noise"]["neutral"]["corner_sd_px"][1], 2.5);

    let (text, _, _) = with(&["--replicates", "20", "--full"]);
    let counted = "20 replicates, seed 1; 0 of them failed";
    assert_says(
        &unwrapped(&text),
        &[counted, "readings of this case", "95 % interval", "Cobb angle"],
    );
    assert!(!with(&[]).0.contains("replicates, seed"));
    assert_eq!(with(&["--noise", "2"]).2, 2, "noise without replicates does nothing");
    assert_eq!(with(&["--replicates", "20", "--noise", "-2"]).2, 2);
    let help = here.run(&["analyze", "--help"]).0;
    assert!(help.contains("--replicates") && help.contains("measured|PX"), "{help}");
}

#[test]
fn identifiability_is_reported_on_request_with_and_without_a_prior() {
    let here = with_phantom(&["--scenario", "rod", "--subject", "2"]);
    let case = "cases/phantom-rod-02.json";
    let with = |more: &[&str]| here.run(&[&["analyze", case, "--full"], more].concat()).0;
    let plain = with(&[]);
    assert!(!plain.contains("Identifiability of the multipliers"), "{plain}");
    // Heads of columns may be broken; a test of `spineline-report` reads them whole.
    assert_says(&plain, &["Line of best fit to the rotations", "p: through", "p: parallel"]);
    let asked = with(&["--identifiability"]);
    assert_says(
        &asked,
        &["Identifiability of the multipliers", "the films identify", "Least known"],
    );
    let prior = ["--identifiability", "--multipliers", "per-joint", "--prior", "in-vivo"];
    assert!(with(&prior).contains("share"));
    let json = json(&with(&[&prior[..], &["--json", "-"]].concat()));
    assert_eq!(json["provenance"]["options"]["prior"], "in-vivo");
    let joint = &json["models"]["inflection_line"]["identifiability"]["multipliers"]["L4/L3"];
    let [films, both] = ["log_sd", "log_sd_with_prior"].map(|key| joint[key].as_f64());
    assert!(both < films && both < Some(0.5), "{joint}");
    let wrong = here.run(&["analyze", case, "--prior", "9"]);
    assert!(wrong.2 == 2 && wrong.1.contains("0.01 to 5"), "{}", wrong.1);
}

#[test]
fn other_loads_are_compared_on_request() {
    let here = with_phantom(&["--scenario", "couple", "--subject", "2"]);
    let case = "cases/phantom-couple-02.json";
    let asked = ["analyze", case, "--compare-models", "inflection-line,couple"];
    let (text, error, code) = here.run(&asked);
    assert!(code == 0 && text.contains("couple"), "{code} {error}\n{text}");
    let (text, _, _) = here.run(&[&asked[..], &["--json", "-"]].concat());
    let json = json(&text);
    assert!(json["hypotheses"]["couple"].is_object(), "{}", json["hypotheses"]);
    assert!(here.run(&["analyze", case, "--compare-models", "magic"]).1.contains("couple"));
}

#[test]
fn tables_models_and_figures_are_written_completely() {
    let here = with_phantom(&["--scenario", "rod", "--subject", "3"]);
    let arguments = split(
        "analyze cases/phantom-rod-03.json --csv out/rows.csv --model out/model.json \
         --model-line estimated --figures out/figures --json out/analysis.json",
    );
    here.wrote(&arguments);
    assert!(here.text("out/model.json").contains("\"line\": \"estimated_line\""));
    let rows = here.text("out/rows.csv");
    assert!(rows.starts_with("case_id,synthetic,posture,level,measured_y_mm"), "{rows}");
    assert!(rows.lines().count() > 15 * 5);
    assert!(here.text("out/figures/phantom-rod-03-overview.svg").contains("</svg>"));
    assert!(!here.path("out/model.json.part").exists());
    assert!(here.text("out/analysis.json").contains("\"spineline-analysis\""));
}

#[test]
fn bad_input_ends_with_3_and_names_file_film_and_vertebra() {
    let here = with_phantom(&[]);
    let mut case = here.json(CASE);
    // Two corners of T7 exchanged in one reading.
    let t7 = &mut case["films"][1]["readings"][0]["vertebrae"]["T7"];
    let (left, right) = (t7["superior_left"].clone(), t7["superior_right"].clone());
    t7["superior_left"] = right;
    t7["superior_right"] = left;
    here.write("crossed.json", case.to_string());
    let error = here.refused(&["analyze", "crossed.json"], 3);
    assert_says(&error, &["crossed.json", "left bending film", "T7", "diagonals", "help:"]);
    let error = here.refused(&["analyze", "nowhere.json"], 3);
    assert!(error.contains("nowhere.json"), "{error}");
    // In a cohort the other cases are still analysed.
    fs::copy(here.path("crossed.json"), here.path("cases/a.json")).expect("copied");
    let (text, error, code) = here.run(&["analyze", "cases"]);
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
        (["analyze", "x.json", "--given-line", "erect=0,0,0"], "erect film has no line"),
        (["analyze", "x.json", "--given-line", "traction=0,0,720"], "from -180 to 180"),
        (["analyze", "x.json", "--model-line", "iliac"], "--model"),
        (["analyze", "x.json", "--min-curve", "-5"], "0 to 90 degrees"),
        (["analyze", "x.json", "--threads", "-1"], "0 (all cores) to 1024"),
        (["phantom", "--out=x", "--noise", "-1"], "from 0 to 10"),
        (["import", "--list", "--spacing", "-1,1,patient"], "both must be from 0.01 to 5 mm"),
        (["serve", "x.spineline", "--host", "not a host"], "host name"),
        (["serve", "x.spineline", "--host", ""], "host name"),
        (["study", "log", "x.spineline", "--by=X"], "makes none"),
        (["account", "list", "x.spineline", "--by=X"], "makes none"),
        (["analyze", "x.json", "--support", "table"], "frontal"),
        (["phantom", "--subject", "19", "--seed=1"], "1 to 18"),
    ] {
        let error = here.refused(&arguments, 2);
        assert!(error.contains(word), "{word} is missing in {error}");
    }
}

#[test]
fn an_option_without_effect_is_refused_or_noted() {
    let here = with_phantom(&[]);
    let by_hand = ["analyze", CASE, "--inflections", "L1/T12,T6", "--min-curve", "20"];
    assert!(here.refused(&by_hand, 2).contains("give one of both"));
    let coupled = ["analyze", CASE, "--stiffness", "coupled"];
    for (support, is_noted) in [("frontal", true), ("free", false)] {
        let error = here.run(&[&coupled[..], &["--support", support]].concat()).1;
        assert_eq!(error.contains("--support free only"), is_noted, "{error}");
    }
    // Phantoms have neither L5 nor T1.
    let amplitude = ["analyze", CASE, "--amplitude", "t1-l5"];
    let error = unwrapped(&here.run(&amplitude).1);
    assert!(error.contains("erect film, left bending film"), "{error}");
}

#[test]
fn a_known_force_makes_forces_absolute() {
    let here = with_phantom(&[]);
    let arguments =
        split("analyze cases --json - --gauge known-force:traction=120 --support frontal");
    let (text, _, _) = here.run(&arguments);
    let json = json(&text);
    let model = &json["models"]["inflection_line"];
    let force = model["postures"]["traction"]["force"].as_f64().expect("a force");
    assert!((force - 120.0).abs() < 1e-9, "{force}");
    assert_eq!(model["absolute"], true);
}

#[test]
fn a_given_line_and_given_inflections_are_used() {
    let here = with_phantom(&["--scenario", "pull", "--subject", "1"]);
    let arguments =
        split("analyze cases --json - --inflections L1/T12,T6 --given-line left_bending=0,300,-90");
    let (text, error, _) = here.run(&arguments);
    let json = json(&text);
    assert!(error.contains("chosen by hand"), "{error}");
    let line = &json["models"]["given_line"]["postures"]["left_bending"]["line"];
    assert!((line["direction"][0].as_f64().expect("y") - 1.0).abs() < 1e-12, "{line}");
    let [disc, vertebra] = [&json["inflections"][0], &json["inflections"][1]];
    assert!(disc["between"][1] == "T12" && disc["vertebra"].is_null(), "{disc}");
    assert_eq!(vertebra["vertebra"], "T6");
    let by_hand = ["analyze", "cases", "--inflections", "L1/T12,T6"];
    let shown = here.run(&by_hand).0;
    assert!(unwrapped(&shown).contains("Inflections: L1/T12 and T6."), "{shown}");
    here.done(&[&by_hand[..], &["--tables", "tables"]].concat());
    let patients = here.text("tables/patients.csv");
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
    here.done(&["analyze", CASE, "--model", "model.json"]);
    for (format, root) in [("mjcf", "<mujoco "), ("osim", "<OpenSimDocument "), ("urdf", "<robot ")]
    {
        let text = here.done(&["export", "model.json", "--to", format]);
        assert!(text.contains(root) && text.contains("SYNTHETIC"), "{format}");
        let out = format!("spine.{format}");
        here.run(&["export", "model.json", "--to", format, "--out", &out]);
        assert_eq!(here.text(out), text);
    }
    let error = here.refused(&["export", "model.json", "--to", "sdf"], 2);
    assert!(error.contains("sdf") && error.contains("mjcf, osim, sto, loads, urdf"), "{error}");
    let error = here.refused(&["export", CASE, "--to", "mjcf"], 3);
    assert!(error.contains(CASE) && error.contains("spineline-model"), "{error}");
    let text = here.text("model.json");
    let wrong = text.replacen("\"case_id\": \"", "\"case_id\": \"\\u0007", 1);
    here.write("wrong.json", wrong);
    let error = here.refused(&["export", "wrong.json", "--to", "urdf"], 3);
    assert!(error.contains("wrong.json: `case_id`") && error.contains("help:"), "{error}");
}

#[test]
fn films_of_a_phantom_are_written_beside_their_case() {
    let here = folder();
    let command = ["phantom", "--subject", "5", "--films", "--pixel-size", "4", "--out", "cases"];
    let text = here.done(&command);
    assert!(text.contains("5 synthetic films beside the cases"), "{text}");
    let case = here.json("cases/phantom-rod-05.json");
    let truth = here.json("cases/phantom-rod-05.truth.json");
    for film in case["films"].as_array().expect("a list") {
        let file = film["image"]["file"].as_str().expect("text");
        let bytes = fs::read(here.path("cases").join(file)).expect("the film");
        assert_eq!(&bytes[128..132], b"DICM");
        let stated = &truth["films"][film["posture"].as_str().expect("text")];
        assert_eq!(stated["file"], file);
        assert_eq!(stated["vertebrae_px"].as_object().expect("an object").len(), 17);
    }
    here.done(&["check", "cases/phantom-rod-05.json"]);
}

#[test]
fn landmarks_are_exported_for_image_programs() {
    let here = with_phantom(&["--scenario", "rod", "--subject", "3"]);
    let case = "cases/phantom-rod-03.json";
    let table = here.done(&["export", case, "--to", "csv"]);
    assert!(
        table.starts_with("posture,observer,repeat,vertebra,superior_left_column_px"),
        "{table}"
    );
    let list = here.done(&["export", case, "--to", "slicer", "--posture", "erect"]);
    assert!(list.contains("\"coordinateSystem\": \"LPS\""), "{list}");
    let (_, error, code) = here.run(&["export", case, "--to", "slicer"]);
    assert!(code == 2 && error.contains("folder"), "{error}");
    let out = ["export", case, "--to", "slicer", "--out", "lists"];
    here.done(&out);
    assert!(here.path("lists/left_bending.mrk.json").exists());
    let keypoints = here.done(&["export", case, "--to", "coco"]);
    assert!(keypoints.contains("\"file_name\": \"left_bending.png\""), "{keypoints}");
    let out = ["export", case, "--to", "labelme", "--posture", "erect", "--out", "points"];
    here.done(&out);
    assert!(here.path("points/erect-1.json").exists());
    // Phantoms have no pictures, which a report needs.
    let out = ["export", case, "--to", "dicom-sr", "--out", "reports"];
    let (_, error, code) = here.run(&out);
    assert!(code == 3 && error.contains("DICOM file"), "{error}");
}

#[test]
fn a_model_has_no_landmarks_and_a_case_no_springs() {
    let here = with_phantom(&["--scenario", "rod", "--subject", "3"]);
    let case = "cases/phantom-rod-03.json";
    here.done(&["analyze", case, "--model", "model.json"]);
    let (_, error, code) = here.run(&["export", "model.json", "--to", "slicer"]);
    assert!(
        code == 3
            && error.contains("spineline-model")
            && error.contains("landmarks belong to a case"),
        "{error}"
    );
    let (_, error, code) = here.run(&["export", case, "--to", "mjcf"]);
    assert!(code == 3 && error.contains("takes a model"), "{error}");
}
