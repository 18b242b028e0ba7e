use serde_json::Value;
use spineline::analysis::Case;
use spineline::measure::Film;
use spineline_phantom::{Readers, Scenario, generate};

use super::server::{add_read_study, add_study, assert_numbers, phantom, serve};

#[test]
fn the_cohort_has_a_row_per_study_and_reasons_for_exclusions() {
    let two = generate(1, Scenario::Rod, &Readers::exact(), 1).expect("subject 2 exists").case;
    let running = serve(|store| {
        add_read_study(store, "S1", &phantom().case);
        add_read_study(store, "S2", &two);
        add_study(store, "S3", &phantom().case);
    });
    let cohort = running.get("/api/cohort");
    let rows = cohort["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 3);
    let headings = |row: &Value| -> Vec<String> {
        let cells = row["cells"].as_array().expect("cells");
        cells.iter().map(|cell| cell["heading"].as_str().expect("words").to_owned()).collect()
    };
    assert!(rows.iter().all(|row| headings(row) == headings(&rows[0])));
    assert_eq!((&rows[0]["excluded"], &rows[0]["synthetic"]), (&Value::Null, &true.into()));
    assert!(rows[2]["excluded"].as_str().is_some_and(|why| !why.is_empty()));
    assert!(cohort["verdict"][0].as_str().is_some_and(|text| text.starts_with("2 patients")));
    for chart in cohort["charts"].as_array().expect("charts") {
        assert_numbers(chart, "chart");
        for five in chart["boxes"].as_array().expect("boxes").iter().map(|b| &b["five"]) {
            let five: [f64; 5] = serde_json::from_value(five.clone()).expect("five numbers");
            assert!(five.windows(2).all(|pair| pair[0] <= pair[1]), "{five:?}");
        }
    }
}

#[test]
fn a_second_study_of_a_patient_counts_nowhere() {
    // Oracle: the cohort without it.
    let case =
        |index| generate(index, Scenario::Rod, &Readers::default(), 1).expect("a subject").case;
    let cohort = |has_second: bool| {
        let running = serve(|store| {
            add_read_study(store, "S1", &case(0));
            add_read_study(store, "S2", &case(1));
            let films = case(1).films;
            let mut add = |study, films: &[Film]| {
                add_read_study(store, study, &Case { films: films.to_vec(), ..case(1) });
            };
            if has_second {
                add("S3", &films[..4]);
                // Earlier in the list, and without a result: it takes no place.
                add("S0", &films[1..]);
            }
        });
        running.get("/api/cohort")
    };
    let (with, without) = (cohort(true), cohort(false));
    let rows = with["rows"].as_array().expect("rows");
    let names: Vec<&str> = rows.iter().filter_map(|row| row["study"].as_str()).collect();
    assert_eq!(names, ["S0", "S1", "S2", "S3"]);
    let why = |study: &str| {
        let row = rows.iter().find(|row| row["study"] == study).expect("its row");
        row["excluded"].as_str().unwrap_or_default().to_owned()
    };
    assert!(why("S2").is_empty() && !why("S0").is_empty(), "{rows:?}");
    let why = why("S3");
    assert!(why.contains("has the landmarks of a film of the case S2; a patient counts"), "{why}");
    let pooled = |cohort: &Value| -> Vec<Value> {
        let all = cohort["reliability"].as_array().expect("a list").iter();
        all.filter(|one| one["scope"] == "all studies").cloned().collect()
    };
    assert!(!pooled(&without).is_empty(), "two observers read the films");
    assert_eq!(pooled(&with), pooled(&without));
    assert_eq!((&with["verdict"], &with["charts"]), (&without["verdict"], &without["charts"]));
}

#[test]
fn synthetic_studies_are_pooled_with_real_ones_only_on_request() {
    let real = |index| {
        let case = generate(index, Scenario::Rod, &Readers::exact(), 1).expect("a subject").case;
        Case { synthetic: false, ..case }
    };
    let running = serve(|store| {
        add_read_study(store, "made", &phantom().case);
        add_read_study(store, "R1", &real(1));
        add_read_study(store, "R2", &real(2));
    });
    let counted = |path: &str| {
        let cohort = running.get(path);
        assert_eq!(cohort["mixed"], true);
        let rows = cohort["rows"].as_array().expect("rows").iter();
        let names: Vec<Value> =
            rows.filter(|row| row["excluded"].is_null()).map(|row| row["study"].clone()).collect();
        let codes: Vec<Value> = cohort["notices"]
            .as_array()
            .expect("notices")
            .iter()
            .map(|notice| notice["code"].clone())
            .collect();
        (names, codes.contains(&"synthetic_mixed".into()), cohort["verdict"][0].clone())
    };
    let (names, is_warned, verdict) = counted("/api/cohort");
    assert_eq!((names, is_warned), (vec!["R1".into(), "R2".into()], false));
    assert!(verdict.as_str().is_some_and(|text| text.starts_with("2 patients")), "{verdict}");
    let (names, is_warned, verdict) = counted("/api/cohort/pooled");
    assert_eq!((names.len(), is_warned), (3, true));
    assert!(verdict.as_str().is_some_and(|text| text.starts_with("3 patients")), "{verdict}");
}

#[test]
fn readings_of_two_observers_give_agreement_statistics() {
    let readers = Readers { observers: 2, repeats: 1, ..Readers::default() };
    let case = generate(0, Scenario::Rod, &readers, 1).expect("subject 1 exists").case;
    let running = serve(|store| add_read_study(store, "S1", &case));
    let views = running.get("/api/studies/S1/reliability");
    assert_numbers(&views, "reliability");
    let tilts =
        views.as_array().expect("views").iter().filter(|view| {
            view["quantity"].as_str().is_some_and(|name| name.starts_with("tilt_step"))
        });
    let plots: Vec<&Value> =
        tilts.map(|view| &view["bland_altman"]).filter(|p| !p.is_null()).collect();
    assert!(!plots.is_empty());
    for plot in plots {
        assert_eq!(plot["unit"], "deg");
        let numbers =
            |key: &str| -> Vec<f64> { serde_json::from_value(plot[key].clone()).expect("numbers") };
        // The bias, computed independently.
        let differences = numbers("differences");
        let mean = differences.iter().sum::<f64>() / differences.len() as f64;
        assert!((mean - plot["bias"].as_f64().expect("a number")).abs() < 1e-12);
        assert_eq!(numbers("means").len(), differences.len());
    }
}
