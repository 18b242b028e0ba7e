//! `reproduce`: the paper's numbers on phantoms and on given cases.

use std::fs;

use crate::commands::options_of;
use crate::program::{assert_says, folder, with_phantom};
use crate::results::results;

#[test]
fn reproduce_sets_given_cases_beside_the_paper_by_its_method() {
    let here = with_phantom(&[]);
    let paper = options_of(&here, &["--method", "paper"]);
    let screen = here.done(&["reproduce", "cases", "--out", "out"]);
    assert!(screen.lines().count() <= 45, "{screen}");
    assert!(screen.lines().all(|line| line.chars().count() <= 100), "{screen}");
    assert_says(&screen, &["1 patient · SYNTHETIC", "Patients", "Method: the paper's."]);
    assert!(!screen.contains("scenario"), "{screen}");
    let name = fs::read_dir(here.path("out/analyses")).expect("analyses").find_map(|file| {
        let name = file.expect("a file").file_name().into_string().expect("text");
        name.ends_with("-free.json").then_some(name)
    });
    let analysis = here.json(format!("out/analyses/{}", name.expect("free support")));
    assert_eq!(analysis["provenance"]["options"], paper);
    // Figures of films that are not synthetic do not say so.
    let figures = |out: &str| -> String {
        let files = fs::read_dir(here.path(out).join("figures")).expect("figures");
        files.map(|file| fs::read_to_string(file.expect("a file").path()).expect("text")).collect()
    };
    assert!(figures("out").contains("synthetic data"));
    let case = fs::read_dir(here.path("cases")).expect("a folder");
    for path in case.map(|file| file.expect("a file").path()) {
        let text = fs::read_to_string(&path).expect("a case");
        fs::write(&path, text.replacen("\"synthetic\": true", "\"synthetic\": false", 1))
            .expect("written");
    }
    let screen = here.done(&["reproduce", "cases", "--out", "real"]);
    for text in [screen, here.text("real/summary.txt"), figures("real")] {
        assert!(!text.contains("SYNTHETIC") && !text.contains("synthetic data"), "{text}");
    }
    here.write("cases/bad.json", "{}");
    let (text, error, code) = here.run(&["reproduce", "cases", "--out", "again"]);
    assert_eq!(code, 3, "{text}\n{error}");
    assert!(error.contains("bad.json") && text.contains("1 patient"), "{text}\n{error}");
}

#[test]
fn reproduce_answers_on_one_screen_and_writes_the_same_bytes_for_any_number_of_threads() {
    let here = folder();
    let with = |threads: &str, out: &str, more: &[&str]| {
        let line = ["reproduce", "--threads", threads, "--out", out];
        here.done(&[&line[..], more].concat())
    };
    let screen = with("1", "a", &[]);
    assert!(screen.lines().count() <= 45, "{} lines:\n{screen}", screen.lines().count());
    assert!(screen.lines().all(|line| line.chars().count() <= 100), "{screen}");
    assert_says(
        &screen,
        &["SYNTHETIC", "Answer: No.", "does not hold", "Holm's p", "What this cannot show"],
    );
    let all = here.text("a/summary.txt");
    assert_says(
        &all,
        &[
            "0.0418 ± 0.0353",
            "Table 2",
            "HELD OUT",
            "free support",
            "frontal support",
            "→",
            "3.3 %",
        ],
    );
    assert!(all.lines().all(|line| line.chars().count() <= 120), "{all}");
    for fault in ["not given", "-0.", "−0.00", "1/1."] {
        assert!(!all.contains(fault), "{fault} in\n{all}");
    }
    // A second run replaces what has its provenance beside it.
    assert!(here.path("a/summary.txt.provenance.json").exists());
    let printed = with("2", "b", &["--full"]);
    assert!(printed.starts_with(&all), "--full prints summary.txt");
    for name in [
        "summary.csv",
        "summary.json",
        "figures/figure-06-inflections.svg",
        "errors/errors-rod-free.csv",
    ] {
        let read = |out: &str| results(&here.text(format!("{out}/{name}")));
        assert!(read("a") == read("b"), "{name} depends on the threads");
    }
    let figures = fs::read_dir(here.path("a/figures")).expect("figures").count();
    assert!(figures >= 20, "{figures}");
    for scenario in ["rod", "bend", "pull"] {
        let patient = here.path(format!("a/reports/patient-{scenario}.html"));
        assert!(
            patient.exists() && patient.with_extension("pdf").exists() == cfg!(feature = "pdf")
        );
        let report = |out: &str| {
            let name = format!("{out}/reports/cohort-{scenario}.html");
            let bytes = fs::read(here.path(name)).expect("a report");
            results(&spineline_report::embedded(&bytes).expect("its analyses are within"))
        };
        assert!(report("a") == report("b"), "the report of {scenario} depends on the threads");
    }
}
