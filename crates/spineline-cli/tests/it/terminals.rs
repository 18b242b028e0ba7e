//! What others wrote, in files or in names of files, does not steer the terminal.

use std::fs;

use crate::program::{CASE, Here, with_phantom};

/// Clears the screen, sets a title, turns the direction of writing, and pretends to be a message.
const HOSTILE: &str =
    "a\u{1b}[2J\u{1b}]0;x\u{7}\u{9b}31m\u{202e}\u{2066}\u{200b}\nerror: fake\r\u{85}fake\u{2028}b";

/// Every stream of a command, which holds nothing that is hidden, and no line that is not its own.
fn plain(here: &Here, arguments: &[&str]) -> String {
    let (output, error, code) = here.run(arguments);
    let text = output + &error;
    let hidden = |c: char| {
        (c.is_control() && c != '\n')
            || matches!(c, '\u{200b}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let found = text.chars().find(|&c| hidden(c));
    assert_eq!(found, None, "{arguments:?}: {code} {text:?}");
    let own = |line: &str| !line.starts_with("error: fake") && !line.starts_with("fake");
    assert!(text.lines().all(own), "{arguments:?}: {text:?}");
    text
}

/// The phantom with one value replaced.
fn changed(here: &Here, name: &str, change: impl FnOnce(&mut serde_json::Value)) -> String {
    let mut case = here.json(CASE);
    change(&mut case);
    here.write(name, case.to_string());
    name.to_owned()
}

#[test]
fn values_of_a_case_are_shown_and_not_obeyed() {
    let here = with_phantom(&[]);
    let cases = [
        changed(&here, "id.json", |case| case["case_id"] = HOSTILE.into()),
        changed(&here, "posture.json", |case| case["films"][0]["posture"] = HOSTILE.into()),
        changed(&here, "key.json", |case| case[HOSTILE] = 1.into()),
        changed(&here, "format.json", |case| case["format"] = HOSTILE.into()),
        changed(&here, "observer.json", |case| {
            case["films"][0]["readings"][0]["observer"] = HOSTILE.into();
        }),
        changed(&here, "file.json", |case| {
            case["films"][0]["image"]["file"] = HOSTILE.into();
        }),
    ];
    here.done(&["study", "create", "s.db"]);
    for case in &cases {
        for command in [
            vec!["check", case],
            vec!["analyze", case],
            vec!["report", case, "--out", "r.html"],
            vec!["rerun", case],
            vec!["export", case, "--to", "csv", "--out", "l.csv"],
            vec!["study", "add", "s.db", case],
            vec!["simulate", case],
            vec!["reliability", case],
        ] {
            plain(&here, &command);
        }
    }
}

#[test]
fn an_analysis_is_repeated_without_obeying_its_words() {
    let here = with_phantom(&[]);
    here.done(&["analyze", CASE, "--json", "a.json"]);
    let mut analysis = here.json("a.json");
    let provenance = &mut analysis["provenance"];
    for key in ["program", "date_utc"] {
        assert!(provenance[key].is_string(), "{provenance}");
        provenance[key] = HOSTILE.into();
    }
    provenance["command"][0] = HOSTILE.into();
    provenance["inputs"][0]["name"] = HOSTILE.into();
    analysis[HOSTILE] = 1.into();
    here.write("a.json", analysis.to_string());
    plain(&here, &["rerun", "a.json"]);
    plain(&here, &["report", "a.json", "--out", "r.html"]);
}

#[test]
#[cfg(unix)]
fn names_of_files_are_shown_and_not_obeyed() {
    let here = with_phantom(&[]);
    let odd = format!("{HOSTILE}.json");
    fs::copy(here.path(CASE), here.path(&odd)).expect("copied");
    here.done(&["study", "create", "s.db"]);
    let folder = format!("d{HOSTILE}");
    fs::create_dir(here.path(&folder)).expect("a folder");
    here.write(format!("{folder}/{odd}"), "{}");
    let dashed = format!("--{HOSTILE}");
    let missing = format!("{HOSTILE}.missing");
    for command in [
        vec!["check", &odd],
        vec!["check", &folder],
        vec!["check", &missing],
        vec!["check", &dashed],
        vec!["check", CASE, "--films", &odd],
        vec!["analyze", &odd, "--window", &odd],
        vec!["analyze", &odd, "--json", &folder],
        vec!["report", &odd, "--out", &missing],
        vec!["rerun", &odd],
        vec!["film", &odd],
        vec!["import", &folder, "--list"],
        vec!["import", &folder, "--case-id", &odd, "--out", "o"],
        vec!["study", "add", "s.db", &odd],
        vec!["study", "create", &missing],
        vec!["study", "plan", "s.db", &odd, "--observers", &odd],
        vec!["account", "add", &odd, "s.db"],
        vec!["merge", &folder, "--out", "o"],
        vec!["phantom", "--out", &folder],
        vec!["schema", &odd],
        vec![&odd],
    ] {
        plain(&here, &command);
    }
}

#[test]
fn a_value_of_60_mb_is_named_in_a_line_of_two_thousand_letters() {
    let here = with_phantom(&[]);
    for (name, change) in [
        ("case_id", "/case_id"),
        ("format", "/format"),
        ("posture", "/films/0/posture"),
        ("observer", "/films/0/readings/0/observer"),
    ] {
        let name = changed(&here, &format!("{name}.json"), |case| {
            *case.pointer_mut(change).expect("a place") = "é".repeat(2_000_000).into();
        });
        let text = plain(&here, &["check", &name]);
        assert!(text.lines().all(|line| line.chars().count() < 2100), "{name}: {}", text.len());
        assert!(text.contains("  help: "), "{name}: {text}");
    }
    let key = changed(&here, "key.json", |case| case["k".repeat(5_000_000)] = 1.into());
    assert!(plain(&here, &["check", &key]).len() < 10_000);
}

#[test]
fn tables_of_odd_names_hold_no_formula() {
    let here = with_phantom(&[]);
    let case = changed(&here, "-A1.json", |case| {
        case["case_id"] = "-A1".into();
        for film in case["films"].as_array_mut().expect("films") {
            film["readings"][0]["observer"] = "-2".into();
        }
    });
    fs::create_dir(here.path("all")).expect("a folder");
    fs::rename(here.path(&case), here.path("all").join(&case)).expect("moved");
    here.write("all/=cmd.json", "{}");
    let outputs = ["--csv", "v.csv", "--chain", "c.csv", "--cohort", "t.csv", "--tables", "t"];
    here.refused(&[&["analyze", "all"], &outputs[..]].concat(), 3);
    let inside = fs::read_dir(here.path("t")).expect("a folder");
    let mut files: Vec<_> = inside.map(|entry| entry.expect("an entry").path()).collect();
    files.extend(["v.csv", "c.csv", "t.csv"].map(|name| here.path(name)));
    files.retain(|file| file.extension().is_some_and(|end| end == "csv"));
    assert!(files.len() > 10, "{files:?}");
    let mut guarded = 0;
    for file in files {
        let mut reader = csv::Reader::from_path(&file).expect("CSV");
        for row in reader.records() {
            for cell in &row.expect("CSV") {
                let is_formula = cell.starts_with(['=', '+', '-', '@']);
                assert!(!is_formula || cell.parse::<f64>().is_ok(), "{}: {cell}", file.display());
                guarded += usize::from(cell == "'-A1" || cell.starts_with("'=cmd"));
            }
        }
    }
    assert!(guarded > 20, "{guarded}");
}
