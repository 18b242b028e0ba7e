//! `reproduce`: the paper's numbers on phantoms and on given cases.

use std::fs;

use crate::commands::options_of;
use crate::program::{done, folder, run, with_phantom};
use crate::results::results;

#[test]
fn reproduce_sets_given_cases_beside_the_paper_by_its_method() {
    let here = with_phantom(&[]);
    let paper = options_of(here.path(), &["--method", "paper"]);
    let screen = done(here.path(), &["reproduce", "cases", "--out", "out"]);
    assert!(screen.lines().count() <= 45, "{screen}");
    assert!(screen.lines().all(|line| line.chars().count() <= 100), "{screen}");
    for word in ["1 patient · SYNTHETIC", "Patients", "Method: the paper's."] {
        assert!(screen.contains(word), "{word} is missing in\n{screen}");
    }
    assert!(!screen.contains("scenario"), "{screen}");
    let read = |name: &str| fs::read_to_string(here.path().join(name)).expect("it was written");
    let name = fs::read_dir(here.path().join("out/analyses")).expect("analyses").find_map(|file| {
        let name = file.expect("a file").file_name().into_string().expect("text");
        name.ends_with("-free.json").then_some(name)
    });
    let analysis = read(&format!("out/analyses/{}", name.expect("free support")));
    let analysis: serde_json::Value = serde_json::from_str(&analysis).expect("JSON");
    assert_eq!(analysis["provenance"]["options"], paper);
    // Figures of films that are not synthetic do not say so.
    let figures = |out: &str| -> String {
        let files = fs::read_dir(here.path().join(out).join("figures")).expect("figures");
        files.map(|file| fs::read_to_string(file.expect("a file").path()).expect("text")).collect()
    };
    assert!(figures("out").contains("synthetic data"));
    let case = fs::read_dir(here.path().join("cases")).expect("a folder");
    for path in case.map(|file| file.expect("a file").path()) {
        let text = fs::read_to_string(&path).expect("a case");
        fs::write(&path, text.replacen("\"synthetic\": true", "\"synthetic\": false", 1))
            .expect("written");
    }
    let screen = done(here.path(), &["reproduce", "cases", "--out", "real"]);
    for text in [screen, read("real/summary.txt"), figures("real")] {
        assert!(!text.contains("SYNTHETIC") && !text.contains("synthetic data"), "{text}");
    }
    fs::write(here.path().join("cases/bad.json"), "{}").expect("a file");
    let (text, error, code) = run(here.path(), &["reproduce", "cases", "--out", "again"]);
    assert_eq!(code, 3, "{text}\n{error}");
    assert!(error.contains("bad.json") && text.contains("1 patient"), "{text}\n{error}");
}

#[test]
fn reproduce_answers_on_one_screen_and_writes_the_same_bytes_for_any_number_of_threads() {
    let here = folder();
    let with = |threads: &str, out: &str, more: &[&str]| {
        let line = ["reproduce", "--threads", threads, "--out", out];
        done(here.path(), &[&line[..], more].concat())
    };
    let screen = with("1", "a", &[]);
    assert!(screen.lines().count() <= 45, "{} lines:\n{screen}", screen.lines().count());
    assert!(screen.lines().all(|line| line.chars().count() <= 100), "{screen}");
    for word in ["SYNTHETIC", "Answer: No.", "does not hold", "Holm's p", "What this cannot show"] {
        assert!(screen.contains(word), "{word} is missing in\n{screen}");
    }
    let all = fs::read_to_string(here.path().join("a/summary.txt")).expect("it was written");
    for word in
        ["0.0418 ± 0.0353", "Table 2", "HELD OUT", "free support", "frontal support", "→", "3.3 %"]
    {
        assert!(all.contains(word), "{word} is missing in\n{all}");
    }
    assert!(all.lines().all(|line| line.chars().count() <= 120), "{all}");
    for fault in ["not given", "-0.", "−0.00", "1/1."] {
        assert!(!all.contains(fault), "{fault} in\n{all}");
    }
    // A second run replaces what has its provenance beside it.
    assert!(here.path().join("a/summary.txt.provenance.json").exists());
    let printed = with("2", "b", &["--full"]);
    assert!(printed.starts_with(&all), "--full prints summary.txt");
    for name in [
        "summary.csv",
        "summary.json",
        "figures/figure-06-inflections.svg",
        "errors/errors-rod-free.csv",
    ] {
        let read = |out: &str| {
            let path = here.path().join(out).join(name);
            results(&fs::read_to_string(path).expect("it was written"))
        };
        assert!(read("a") == read("b"), "{name} depends on the threads");
    }
    let figures = fs::read_dir(here.path().join("a/figures")).expect("figures").count();
    assert!(figures >= 20, "{figures}");
    for scenario in ["rod", "bend", "pull"] {
        let patient = here.path().join(format!("a/reports/patient-{scenario}.html"));
        assert!(
            patient.exists() && patient.with_extension("pdf").exists() == cfg!(feature = "pdf")
        );
        let report = |out: &str| {
            let name = format!("{out}/reports/cohort-{scenario}.html");
            let bytes = fs::read(here.path().join(name)).expect("a report");
            results(&spineline_report::embedded(&bytes).expect("its analyses are within"))
        };
        assert!(report("a") == report("b"), "the report of {scenario} depends on the threads");
    }
}
