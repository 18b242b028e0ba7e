//! Lines of action compared: what `analyze` prints and writes of one patient and of a cohort.

use serde_json::{Value, json};

use crate::program::{self, assert_says, split, unwrapped, with_phantom, with_phantoms};
use crate::results::results;

/// The case of the second patient.
const SECOND: &str = "cases/phantom-rod-02.json";

#[test]
fn one_patient_shows_every_line_by_kind_of_film_and_a_conclusion() {
    let here = with_phantom(&["--scenario", "bend", "--subject", "1"]);
    let (text, error, _) = here.run(&["analyze", "cases/phantom-bend-01.json", "--full"]);
    let text = unwrapped(&text);
    for word in [
        "Every line on the films with a result",
        "fitted bends inflection line",
        "bends left out iliac line",
        "2 + 2 + 0 = 4 fitted",
        "2 + 2 + 4 = 8 fitted",
        "1 per film",
        "3 per film",
        "A small fit error is not evidence for a line.",
    ] {
        assert!(text.contains(word), "{word} is missing in\n{text}\n{error}");
    }
    let text = text.to_lowercase().replace("line of best fit to the rotations", "");
    assert!(!text.contains("best"), "one patient's films prove no line the best\n{text}");
    let (text, _, _) = here.run(&["analyze", "cases/phantom-bend-01.json", "--json", "-"]);
    let json = program::json(&text);
    for pointer in [
        "/comparison/same_data",
        "/comparison/lines/iliac_line/numbers/fitted",
        "/comparison/lines/inflection_line/errors/fitted/location_mm",
        "/comparison/compatibility/inflection_line/bends/0/weight",
        "/comparison/compatibility/inflection_line/bends/0/joints_p_holm",
        "/comparison/left_out_bends/left_bending/iliac_line/multipliers/main_thoracic",
        "/comparison/verdict/0",
    ] {
        assert!(json.pointer(pointer).is_some_and(|value| !value.is_null()), "{pointer}");
    }
    let left_out = &json["comparison"]["left_out_bends"]["left_bending"]["iliac_line"]["postures"];
    assert_eq!(left_out["left_bending"]["fitted"], false);
    assert_eq!(left_out["right_bending"]["fitted"], true);
    let films = json["comparison"]["films"].as_array().expect("films");
    let roles = |role: &str| films.iter().filter(|film| film["role"] == role).count();
    assert_eq!([roles("fitted"), roles("left_out_bend"), roles("held_out")], [2, 2, 2]);
}

#[test]
fn a_cohort_is_tested_by_patient_with_its_family_of_tests() {
    let here = with_phantoms("pull", &["1", "2", "3", "4"]);
    let arguments = ["analyze", "cases", "--cohort", "all.json", "--threads", "2", "--full"];
    let text = here.wrote(&arguments);
    // Heads and names of rows may be broken; a test of `spineline-report` reads them whole.
    let text = unwrapped(&text);
    assert_says(
        &text,
        &[
            "Every pair of lines, compared",
            "First minus",
            "inflection –",
            "Sign-",
            "flip p",
            "Holm p",
            "Pooled p",
            "Use the interval over patients",
            "Holm's correction covers",
        ],
    );
    let json = here.json("all.json");
    assert_eq!(json["format"], "spineline-cohort");
    assert_eq!(
        (&json["synthetic"], json["case_ids"].as_array().map(Vec::len)),
        (&Value::Bool(true), Some(4))
    );
    let tests = json["tests"].as_array().expect("tests");
    assert_eq!(tests.len(), 18, "three pairs, three kinds of films, two errors");
    for test in tests {
        // Four patients cannot reach 0.05, so that nothing is tested.
        assert!(test["sign_flip_p"].as_f64().is_none_or(|p| p >= 0.125), "{test}");
        assert!(test["predicts_better"].is_null() && test["holm_p"].is_null(), "{test}");
    }
    assert!(tests.iter().any(|test| test["sign_flip_p"].is_number()));
    let family = tests.iter().filter(|test| test["sign_flip_p"].is_number()).count() as f64;
    let enough = (2..20).find(|&n| family * 2.0 / 2.0_f64.powi(n) < 0.05).expect("few tests");
    let few = format!(
        "Too few patients to test which line predicts better: {family} tests need {enough} patients with films that both predict; at most "
    );
    assert!(text.contains(&few), "{few}\n{text}");
    assert!(!text.contains("predicts significantly better"), "{text}");
    here.run(&["analyze", "cases", "--cohort", "all.csv", "--threads", "1"]);
    let csv = here.text("all.csv");
    let against = json["baseline_tests"].as_array().expect("tests against no mechanics").len();
    assert!(against > 0);
    assert_eq!(csv.lines().count(), 1 + tests.len() + against, "{csv}");
    assert!(csv.starts_with("first_line,second_line,synthetic,films,error,unit,patients"));
    here.run(&["analyze", "cases", "--cohort", "again.json", "--threads", "1"]);
    assert_eq!(
        results(&here.text("again.json")),
        results(&here.text("all.json")),
        "the bytes depend on the threads"
    );
}

#[test]
fn films_without_a_result_are_named_with_line_and_reason() {
    let here = with_phantoms("rod", &["1", "2"]);
    here.change(SECOND, |case| {
        for film in case["films"].as_array_mut().expect("films") {
            let image = film["image"].as_object_mut().expect("a picture");
            image.retain(|key, _| !key.contains("spacing"));
        }
    });
    let text = here.wrote(&["analyze", "cases", "--cohort", "all.json", "--full"]);
    assert!(unwrapped(&text).contains("Films on which a line has no result"), "{text}");
    let json = here.json("all.json");
    let left_out = json["films_without_result"].as_array().expect("films");
    assert_eq!(left_out.len(), 18, "three lines on two films of three kinds: {left_out:?}");
    for film in left_out {
        assert_eq!(
            (&film["case_id"], &film["reason"]),
            (&"phantom-rod-02".into(), &"no_model".into())
        );
    }
    let errors = json["errors"].as_array().expect("errors");
    assert!(errors.iter().all(|error| error["films_without_result"] == 2), "{errors:?}");
    assert_eq!(json["chains"], json!([{ "base": "L4", "top": "T2", "patients": 2 }]));
    assert_eq!(json["doubted_films"], json!([]));
}

#[test]
fn a_doubted_film_and_a_shorter_chain_are_named_in_the_files_of_a_cohort() {
    let here = with_phantoms("rod", &["1", "2"]);
    let mut case = here.json(SECOND);
    let films = case["films"].as_array_mut().expect("films");
    for film in films.iter_mut() {
        for reading in film["readings"].as_array_mut().expect("readings") {
            let vertebrae = reading["vertebrae"].as_object_mut().expect("vertebrae");
            vertebrae.retain(|level, _| !["T1", "T2", "T3"].contains(&level.as_str()));
        }
    }
    // A bend that is the erect film, a little lower on the picture.
    let mut readings = films[0]["readings"].clone();
    shift_rows(&mut readings, 5.0);
    films[1]["readings"] = readings;
    let posture = films[1]["posture"].clone();
    here.write(SECOND, case.to_string());
    let arguments = split("analyze cases --full --cohort all.json --tables tables --threads 1");
    let text = here.wrote(&arguments);
    let text = unwrapped(&text);
    let counts = "1 patient from L4 to T2 and 1 patient from L4 to T4";
    assert!(text.contains(counts) && text.contains("Films of 1 of 2 patients"), "{text}");
    let json = here.json("all.json");
    let chains = json!([
        { "base": "L4", "top": "T2", "patients": 1 }, { "base": "L4", "top": "T4", "patients": 1 },
    ]);
    assert_eq!(json["chains"], chains);
    let doubted = json["doubted_films"].as_array().expect("films");
    assert!(!doubted.is_empty());
    for film in doubted {
        assert_eq!(film["case_id"], "phantom-rod-02", "{film}");
        assert_eq!(film["posture"], posture, "{film}");
    }
    let code = doubted[0]["code"].as_str().expect("a code");
    for (table, rows, expected) in
        [("postures", 10, code), ("patients", 2, posture.as_str().expect("a posture"))]
    {
        let csv = here.text(format!("tables/{table}.csv"));
        let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let head = lines.next().expect("a head");
        let place = head.iter().position(|name| *name == "doubted").expect("a column");
        let cells: Vec<&str> = lines.map(|cells| cells[place]).collect();
        assert_eq!(cells.len(), rows, "{csv}");
        let filled: Vec<&&str> = cells.iter().filter(|cell| !cell.is_empty()).collect();
        assert!(filled.len() == 1 && filled[0].contains(expected), "{filled:?}");
    }
}

/// Moves every point of readings down.
fn shift_rows(value: &mut Value, rows: f64) {
    match value {
        Value::Object(of) => of.values_mut().for_each(|one| shift_rows(one, rows)),
        Value::Array(of) if of.len() == 2 && of.iter().all(Value::is_number) => {
            of[1] = (of[1].as_f64().expect("a number") + rows).into();
        }
        Value::Array(of) => of.iter_mut().for_each(|one| shift_rows(one, rows)),
        _ => {}
    }
}

#[test]
fn a_refused_patient_is_named_with_its_reason_in_every_output() {
    let here = with_phantoms("rod", &["1", "2"]);
    here.change(SECOND, |case| {
        case["films"].as_array_mut().expect("films").retain(|film| film["posture"] != "erect");
    });
    here.write("cases/torn.json", "{ \"format\": \"spineline-case\",");
    let arguments = split(
        "analyze cases --json all.json --cohort cohort.json --csv all.csv --chain chain.csv --tables tables",
    );
    let (text, _, code) = here.run(&arguments);
    assert_eq!(code, 3, "a case was refused");
    let (refused, rest) = text.split_once("Which line?").expect("the first answer");
    assert!(refused.contains("2 of 3 cases refused"), "{text}");
    for named in ["phantom-rod-02", "torn.json", "erect"] {
        assert!(
            refused.contains(named),
            "{named} is missing before the findings:\n{refused}{rest}"
        );
    }
    let analyses = here.json("all.json");
    let items = analyses.as_array().expect("a list");
    let formats: Vec<&Value> = items.iter().map(|item| &item["format"]).collect();
    assert_eq!(formats, ["spineline-analysis", "spineline-refused-case", "spineline-refused-case"]);
    let listed = &here.json("cohort.json")["refused"];
    for (place, step, id) in [(0, "analysis", json!("phantom-rod-02")), (1, "reading", Value::Null)]
    {
        let one = &listed[place];
        assert_eq!((&one["step"], &one["case_id"]), (&json!(step), &id));
        assert!(one["reason"].as_str().is_some_and(|reason| !reason.is_empty()), "{one}");
        assert_eq!(&items[place + 1]["refused"], one);
    }
    for table in ["all.csv", "chain.csv", "tables/patients.csv"] {
        let rows = here.text(table);
        for named in ["phantom-rod-02,", "torn.json,"] {
            let row = rows.lines().find(|row| row.starts_with(named));
            let row = row.unwrap_or_else(|| panic!("{named} is missing in {table}"));
            assert!(row.contains("could not be"), "{table}: {row}");
        }
    }
    here.refused(&["report", "cases", "--out", "report.md"], 3);
    let report = here.text("report.md");
    let place = |text: &str| report.find(text).unwrap_or_else(|| panic!("{text} is missing"));
    assert!(place("2 of 3 cases refused") < place("1 patient (synthetic)"));
}
