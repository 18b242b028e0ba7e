//! A patient with hidden vertebrae, from case to report.

use std::fs;

use crate::program::{CASE, Here, assert_says, unwrapped, with_phantom};

/// A folder with a phantom's case without T8 on the left bend and T2 on the neutral film, `case.json`.
fn with_partial_case() -> Here {
    let here = with_phantom(&[]);
    let mut case = here.json(CASE);
    for film in case["films"].as_array_mut().expect("films") {
        let hidden = match film["posture"].as_str() {
            Some("left_bending") => "T8",
            Some("neutral") => "T2",
            _ => continue,
        };
        for reading in film["readings"].as_array_mut().expect("readings") {
            reading["vertebrae"].as_object_mut().expect("vertebrae").remove(hidden);
        }
    }
    here.write("case.json", case.to_string());
    here
}

#[test]
fn hidden_vertebrae_reach_terminal_tables_and_report() {
    let here = with_partial_case();
    let text = here.done(&["check", "case.json"]);
    assert!(text.contains("L4-T3"), "{text}");
    assert_says(
        &unwrapped(&text),
        &["left bending film: T8: T8 is not marked", "missing on: neutral"],
    );
    let arguments =
        ["analyze", "case.json", "--tables", "t", "--tables-format", "csv", "--model", "m.json"];
    here.done(&arguments);
    let table = here.text("t/vertebrae.csv");
    let mut lines = table.lines();
    let heading: Vec<&str> = lines.next().expect("a heading").split(',').collect();
    let column = |name: &str| heading.iter().position(|own| *own == name).expect("a column");
    let (posture, level) = (column("posture"), column("level"));
    let (interpolated, location_error) = (column("interpolated"), column("location_error_mm"));
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let hidden = cells[posture] == "left_bending" && cells[level] == "T8";
        assert_eq!(cells[interpolated], hidden.to_string(), "{line}");
        assert!(!hidden || cells[location_error].is_empty(), "{line}");
        assert_ne!(cells[level], "T2");
    }
    // The default of a push is the top of this model.
    let push = ["simulate", "m.json", "--push", "left", "--force", "10"];
    here.done(&push);
    here.done(&["report", "case.json", "--out", "r.html"]);
    let report = here.text("r.html");
    let parts = ["Interpolated, not marked: left bending: T8", "without interpolated", "L4–T3"];
    assert_says(&report, &parts);
    let arguments = ["analyze", "case.json", "--figures", "figures"];
    here.done(&arguments);
    let figures = fs::read_dir(here.path("figures")).expect("a folder");
    let marked = figures.filter(|figure| {
        let path = figure.as_ref().expect("a file").path();
        fs::read_to_string(path).is_ok_and(|svg| svg.contains("not marked on this film"))
    });
    assert!(marked.count() > 0, "the overview marks interpolated vertebrae");
}
