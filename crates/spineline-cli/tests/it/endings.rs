//! What an exit code promises, and what is refused before any work.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{CASE, Here, folder, unwrapped, with_phantom, with_phantoms};

/// The ending of the simulations of one line.
fn statuses(analysis: &Value, line: &str) -> Vec<String> {
    let postures = analysis["models"][line]["postures"].as_object().expect("films");
    postures.values().map(|film| film["status"].as_str().expect("a status").to_owned()).collect()
}

#[test]
fn a_model_in_addition_that_has_no_result_does_not_fail_the_analysis() {
    let here = with_phantom(&["--scenario", "bend", "--subject", "2", "--noise", "5"]);
    let case = "cases/phantom-bend-02.json";
    // The estimated line bends out of the plane, where nothing holds it.
    let free = ["analyze", case, "--support", "free", "--json", "a.json"];
    let (text, error, code) = here.run(&free);
    let analysis = here.json("a.json");
    assert!(
        statuses(&analysis, "estimated_line").iter().any(|status| status != "converged"),
        "the test means something: {analysis}"
    );
    assert!(statuses(&analysis, "inflection_line").iter().all(|status| status == "converged"));
    assert_eq!(code, 0, "{text}{error}");
    let codes = analysis["warnings"].as_array().expect("a list");
    assert!(codes.iter().any(|warning| warning["code"] == "force_not_found"), "it is still said");
    let report = ["report", case, "--support", "free", "--out", "a.html"];
    here.done(&report);
    // The model that is asked for by name counts.
    let named = ["--model", "m.json", "--model-line", "estimated"];
    assert_eq!(here.run(&[&free[..4], &named].concat()).2, 4);
}

#[test]
fn a_fit_without_a_bend_that_did_not_converge_is_said_and_does_not_fail_the_analysis() {
    let here = with_phantom(&["--scenario", "random", "--subject", "6"]);
    let case = "cases/phantom-random-06.json";
    let (text, error, code) = here.run(&["analyze", case, "--method", "paper", "--json", "a.json"]);
    let analysis = here.json("a.json");
    let left_out = &analysis["comparison"]["left_out_bends"]["right_bending"]["inflection_line"];
    assert_eq!(left_out["fit"]["status"], "stalled", "the test means something");
    let predicted = &left_out["postures"]["right_bending"];
    assert_eq!(predicted["status"], "fit_not_converged", "{predicted}");
    assert!(predicted["location_error_mm"].is_null(), "{predicted}");
    let warnings = analysis["warnings"].as_array().expect("a list");
    let said = |warning: &&Value| {
        warning["code"] == "fit_not_converged" && warning["posture"] == "right_bending"
    };
    assert_eq!(warnings.iter().filter(said).count(), 1, "{warnings:?}");
    assert!(
        unwrapped(&text).contains("Without the right bend the fit of the inflection line"),
        "{text}"
    );
    assert_eq!(code, 0, "{error}");
}

#[test]
fn a_known_force_is_in_its_range_and_belongs_to_a_film_with_a_force() {
    let here = with_phantom(&[]);
    let with = |gauge: &str| here.run(&["analyze", CASE, "--gauge", gauge]);
    for (gauge, words) in [
        ("known-force:erect=120", "the erect film has no force"),
        ("known-force:traction=-120", "-120 N, and must be from 1 to 2000 N"),
        ("known-force:traction=0", "0 N, and must be from 1 to 2000 N"),
        ("known-force:traction=1e12", "1000000000000 N, and must be from 1 to 2000 N"),
    ] {
        let (_, error, code) = with(gauge);
        assert!(code == 2 && error.contains(words), "{gauge}: {code} {error}");
    }
    here.change(CASE, |file| {
        let films = file["films"].as_array_mut().expect("films");
        films.retain(|film| film["posture"] != "traction");
    });
    let (_, error, code) = with("known-force:traction=120");
    assert!(code == 2 && error.contains("which this case lacks"), "{code} {error}");
}

#[test]
fn outputs_beside_the_cases_of_a_folder_are_passed_over_and_named() {
    let here = with_phantom(&[]);
    let outputs = ["--json", "cases/a.json", "--model", "cases/m.json", "--cohort", "cases/c.json"];
    here.done(&[&["analyze", CASE], &outputs[..]].concat());
    for command in ["analyze", "check"] {
        let (text, error, code) = here.run(&[command, "cases"]);
        assert_eq!(code, 0, "{text}{error}");
        for name in ["a.json", "m.json", "c.json"] {
            assert!(error.contains(&format!("{name} is passed over")), "{name}: {error}");
        }
    }
    // A folder of analyses alone is read as their cases; one without any case says so.
    fs::remove_file(here.path(CASE)).expect("a file");
    let (text, error, code) = here.run(&["check", "cases"]);
    assert!(code == 0 && text.contains("phantom-rod-01"), "{text}{error}");
    fs::remove_file(here.path("cases/a.json")).expect("a file");
    let (_, error, code) = here.run(&["analyze", "cases"]);
    assert!(code == 3 && error.contains("no case file in this folder"), "{error}");
}

#[test]
fn a_case_of_a_folder_is_never_left_out_silently() {
    let here = with_phantom(&[]);
    let names = ["cases/B.JSON", "cases/P06.truth.json"];
    names.iter().for_each(|name| here.write(name, here.text(CASE)));
    fs::create_dir(here.path("cases/more")).expect("a folder");
    here.write("cases/more/c.json", here.text(CASE));
    let (text, error, code) = here.run(&["check", "cases"]);
    assert_eq!(code, 0, "{text}{error}");
    for name in [CASE, names[0], names[1]] {
        assert!(text.contains(name), "{name}: {text}");
    }
    assert!(error.contains("not read: 1 folder with .json files inside cases"), "{error}");
    assert!(!text.contains("rod-01.truth"), "true values are not a case: {text}");
}

#[test]
fn a_file_that_is_not_ours_or_not_utf_8_is_named_as_such() {
    let here = folder();
    for (bytes, said) in [
        (&b"{\"a\": 1}"[..], "not a Spineline file"),
        (b"{\"format\": \"other\"}", "not a Spineline file: its format is `other`"),
        (b"{\"case_id\": \"M\xfcller\"}", "save the file as UTF-8"),
    ] {
        here.write("x.json", bytes);
        let (_, error, code) = here.run(&["check", "x.json"]);
        assert!(code == 3 && unwrapped(&error).contains(said), "{said}: {error}");
    }
}

#[test]
fn the_line_that_predicts_best_gives_the_model() {
    let here = with_phantom(&["--scenario", "pull", "--subject", "2", "--noise", "0"]);
    let case = "cases/phantom-pull-02.json";
    // Without `--model-line`, the program chooses.
    let auto = ["analyze", case, "--json", "a.json", "--model", "m.json"];
    let (_, error, code) = here.run(&auto);
    assert_eq!(code, 0, "{error}");
    assert!(error.contains("the model of the iliac line is written"), "{error}");
    let error = unwrapped(&error);
    assert_eq!(here.json("m.json")["line"], "iliac_line");
    let compared = &here.json("a.json")["comparison"];
    let left_out = |line: &str| {
        compared["lines"][line]["errors"]["left_out_bend"]["location_mm"].as_f64().expect("a mean")
    };
    assert!(left_out("iliac_line") < left_out("inflection_line"), "{compared}");
    // Why, in numbers: the chosen line, the next one, and the best that needs no mechanics.
    let baselines = compared["baselines_mm"].as_object().expect("baselines");
    let without = baselines
        .iter()
        .filter(|(name, _)| !["rotation_prior_with_tilt", "cubic"].contains(&name.as_str()));
    let without = without.filter_map(|(_, errors)| errors["left_out_bend"].as_f64());
    for said in [
        format!(
            "the iliac line has the smallest error on bends left out of the fit: {:.1} mm",
            left_out("iliac_line")
        ),
        format!("the inflection line follows with {:.1} mm", left_out("inflection_line")),
        format!(") has {:.1} mm.", without.fold(f64::INFINITY, f64::min)),
    ] {
        assert!(error.contains(&said), "{said}: {error}");
    }
}

#[test]
fn a_patient_without_an_inflection_line_has_a_model() {
    let here = with_phantom(&["--scenario", "bend", "--subject", "2"]);
    let case = "cases/phantom-bend-02.json";
    // No curve is so large, so the case lacks inflections.
    let analyze = ["analyze", case, "--min-curve", "80", "--json", "a.json", "--model", "m.json"];
    let (text, error, code) = here.run(&analyze);
    assert_eq!(code, 0, "{error}{text}");
    assert!(
        here.json("a.json")["models"]["inflection_line"].is_null(),
        "a line without inflections"
    );
    let model = here.json("m.json");
    let line = model["line"].as_str().expect("a line").replace('_', " ");
    let error = unwrapped(&error);
    assert!(
        error.contains(&format!("the model of the {line} is written. Of the lines")),
        "{error}"
    );
    here.done(&["simulate", "m.json", "--push", "left", "--force", "10"]);
}

#[test]
fn results_that_cannot_be_written_are_shown() {
    let here = with_phantom(&[]);
    let full = Path::new("/dev/full");
    if !full.exists() {
        return;
    }
    here.done(&["analyze", CASE, "--model", "m.json"]);
    for command in [
        &["analyze", CASE, "--json", "/dev/full"][..],
        &["simulate", "m.json", "--push", "left", "--force", "10", "--json", "/dev/full"],
    ] {
        let (text, error, code) = here.run(command);
        assert!(code == 3 && error.contains("/dev/full could not be written"), "{code} {error}");
        assert!(text.contains("phantom-rod-01"), "{text}");
    }
}

#[test]
fn a_model_that_cannot_be_written_says_what_would_give_one() {
    let here = with_phantom(&[]);
    let case = here.json(CASE);
    let mut no_scale = case.clone();
    for film in no_scale["films"].as_array_mut().expect("films") {
        let image = film["image"].as_object_mut().expect("a picture");
        image.retain(|key, _| !key.contains("spacing"));
    }
    let mut no_bend = case.clone();
    let films = no_bend["films"].as_array_mut().expect("films");
    films.retain(|film| !film["posture"].as_str().is_some_and(|name| name.contains("bending")));
    for (name, case, line, expected) in [
        ("scale.json", no_scale, "inflection", "column_spacing_mm"),
        ("bend.json", no_bend, "inflection", "a bending film"),
        ("given.json", case, "given", "--model-line inflection"),
    ] {
        here.write(name, case.to_string());
        let analyze =
            ["analyze", name, "--model", "m.json", "--model-line", line, "--json", "a.json"];
        let (text, error, code) = here.run(&analyze);
        let error = unwrapped(&error);
        assert!(code == 4 && error.contains(expected), "{name}: {code} {error}");
        // What was found is shown and written nevertheless, and what is missing is named last.
        assert!(text.contains("phantom-rod-01"), "{name}: {text}");
        assert_eq!(here.json("a.json")["case_id"], "phantom-rod-01");
        assert!(!here.path("m.json").exists());
        let last = error.rfind("error: ").expect("an error");
        assert!(error[last..].starts_with("error: m.json is not written"), "{name}: {error}");
        fs::remove_file(here.path("a.json")).expect("it was written");
        // Another line helps only where it has a model.
        assert_eq!(error.contains("--model-line"), line == "given", "{name}: {error}");
    }
}

/// A folder where a file is to be written: known only when the file is made.
fn block(here: &Here, file: &str) {
    fs::create_dir_all(here.path(file)).expect("a folder");
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<fs::DirEntry>| entry.expect("an entry").file_name();
    let mut names: Vec<String> =
        entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn an_output_that_cannot_be_made_does_not_stop_the_others() {
    let here = with_phantom(&[]);
    let at = |name: &str| here.path(name);
    let (figure, table) = ("figures/phantom-rod-01-overview.svg", "tables/joints.csv");
    block(&here, figure);
    block(&here, table);
    let outputs = [
        ["--figures", "figures"],
        ["--tables", "tables"],
        ["--json", "a.json"],
        ["--csv", "e.csv"],
        ["--chain", "c.csv"],
        ["--cohort", "cohort.json"],
        ["--model", "m.json"],
    ];
    let analyze = [&["analyze", CASE][..], outputs.as_flattened()].concat();
    let (text, error, code) = here.run(&analyze);
    assert_eq!(code, 3, "{text}{error}");
    assert!(text.contains("phantom-rod-01"), "{text}");
    for blocked in [figure, table] {
        assert!(error.contains(&format!("error: {blocked} could not be written")), "{error}");
    }
    assert_eq!(error.matches("help: ").count(), 2, "{error}");
    for made in ["a.json", "e.csv", "e.csv.provenance.json", "c.csv", "cohort.json", "m.json"] {
        assert!(at(made).is_file(), "{made}: {error}");
    }
    // A folder of results is complete or as it was.
    assert_eq!(names(&at("figures")), ["phantom-rod-01-overview.svg"]);
    assert_eq!(names(&at("tables")), ["joints.csv"]);
    let rerun = ["rerun", "a.json", "--figures", "figures", "--json", "again.json"];
    let (text, error, code) = here.run(&rerun);
    assert!(code == 3 && error.contains(figure), "{error}");
    assert!(text.contains("Nothing differs") && at("again.json").is_file(), "{text}{error}");
}

#[test]
fn a_report_is_made_although_its_figures_cannot_be() {
    let here = with_phantom(&[]);
    let at = |name: &str| here.path(name);
    let report = ["report", CASE, "--out", "r.html", "--figures", "figures"];
    here.done(&report);
    let first = names(&at("figures")).remove(0);
    fs::remove_dir_all(at("figures")).expect("a folder");
    fs::remove_file(at("r.html")).expect("a report");
    block(&here, &format!("figures/{first}"));
    let (text, error, code) = here.run(&report);
    assert!(code == 3 && error.contains(&first), "{code} {error}");
    assert!(at("r.html").is_file() && text.contains("r.html"), "{text}{error}");
    assert_eq!(names(&at("figures")), [first]);
}

#[test]
fn figures_of_one_patient_do_not_stop_those_of_the_next() {
    let here = with_phantoms("rod", &["1", "2"]);
    block(&here, "figures/phantom-rod-01-overview.svg");
    let analyze = ["analyze", "cases", "--figures", "figures", "--json", "all.json"];
    let (text, error, code) = here.run(&analyze);
    assert!(code == 3 && error.contains("phantom-rod-01-overview.svg"), "{code} {error}");
    assert!(text.contains("2 patients"), "{text}");
    assert_eq!(here.json("all.json").as_array().map(Vec::len), Some(2));
    let names = names(&here.path("figures"));
    assert!(names.iter().any(|name| name == "phantom-rod-02-overview.svg"), "{names:?}");
    assert_eq!(names.iter().filter(|name| name.starts_with("phantom-rod-01")).count(), 1);
}
