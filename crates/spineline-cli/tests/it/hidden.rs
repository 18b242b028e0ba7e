//! A patient with hidden vertebrae, from case to report.

use std::fs;

use serde_json::Value;

use crate::program;

/// A phantom's case with T8 removed from the left bend and T2 from the neutral film.
fn write_partial_case(folder: &std::path::Path) {
    program::add_phantom(folder, &["--subject", "1"]);
    let read = |entry: std::io::Result<fs::DirEntry>| -> Option<Value> {
        let text = fs::read_to_string(entry.expect("a file").path()).ok()?;
        serde_json::from_str(&text).ok()
    };
    let files = fs::read_dir(folder.join("cases")).expect("a folder");
    let mut all = files.filter_map(read);
    let mut case = all.find(|file| file["format"] == "spineline-case").expect("a case");
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
    fs::write(folder.join("case.json"), case.to_string()).expect("written");
}

#[test]
fn hidden_vertebrae_reach_terminal_tables_and_report() {
    let here = tempfile::tempdir().expect("a place for files");
    write_partial_case(here.path());
    let text = program::done(here.path(), &["check", "case.json"]);
    assert!(text.contains("L4-T3"), "{text}");
    for part in ["left bending film: T8: T8 is not marked", "missing on: neutral"] {
        let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(flat.contains(part), "`{part}` is not in {flat}");
    }
    let arguments =
        ["analyze", "case.json", "--tables", "t", "--tables-format", "csv", "--model", "m.json"];
    program::done(here.path(), &arguments);
    let table = fs::read_to_string(here.path().join("t/vertebrae.csv")).expect("a table");
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
    let (text, error, code) = program::run(here.path(), &push);
    assert_eq!(code, 0, "{text}{error}");
    program::done(here.path(), &["report", "case.json", "--out", "r.html"]);
    let report = fs::read_to_string(here.path().join("r.html")).expect("a report");
    for part in ["Interpolated, not marked: left bending: T8", "without interpolated", "L4–T3"] {
        assert!(report.contains(part), "`{part}` is not in the report");
    }
    let arguments = ["analyze", "case.json", "--figures", "figures"];
    program::done(here.path(), &arguments);
    let figures = fs::read_dir(here.path().join("figures")).expect("a folder");
    let marked = figures.filter(|figure| {
        let path = figure.as_ref().expect("a file").path();
        fs::read_to_string(path).is_ok_and(|svg| svg.contains("not marked on this film"))
    });
    assert!(marked.count() > 0, "the overview marks interpolated vertebrae");
}
