//! `spineline report`: files of every form, for one patient and for a cohort.

use std::fs;
use std::path::Path;

use serde_json::Value;
use spineline_report::embedded;

use crate::program::{CASE, assert_says, folder, json, with_phantom, with_phantoms};

fn analysis_in(report: &Path) -> Value {
    let bytes = fs::read(report).expect("the report is written");
    json(&embedded(&bytes).expect("an analysis is within"))
}

#[test]
fn a_folder_with_one_case_gives_a_patient_report_with_its_name() {
    let here = with_phantom(&[]);
    let (said, error, code) = here.run(&["report", "cases"]);
    assert!(code == 0 && said.contains("phantom-rod-01.html"), "{code} {said} {error}");
    let report = here.path("phantom-rod-01.html");
    let analysis = analysis_in(&report);
    assert_eq!(analysis["case_id"], "phantom-rod-01");
    assert_eq!(analysis["format"], "spineline-analysis");
    let text = fs::read_to_string(report).expect("it is text");
    assert!(text.contains("Synthetic data") && !text.contains("src=\"http"));
}

#[test]
fn markdown_figures_are_written_beside_it() {
    let here = with_phantom(&[]);
    let arguments = ["report", "cases", "--to", "md", "--out", "out/a.md", "--figures", "pictures"];
    here.done(&arguments);
    let report = here.path("out/a.md");
    assert_eq!(analysis_in(&report)["case_id"], "phantom-rod-01");
    let text = fs::read_to_string(&report).expect("it is text");
    let mut figures = 0;
    for (_, rest) in text.match_indices("](").map(|(at, _)| text.split_at(at + 2)) {
        let (name, _) = rest.split_once(')').expect("a link ends");
        let svg = here.text(format!("out/{name}"));
        assert!(svg.starts_with("<svg "), "{name}");
        figures += 1;
    }
    assert!(figures > 10, "{figures} figures");
    let count = |ending: &str| {
        let files = fs::read_dir(here.path("pictures")).expect("the folder is there");
        let names = files.map(|file| file.expect("it can be read").file_name());
        names.filter(|name| name.to_string_lossy().ends_with(ending)).count()
    };
    assert_eq!((count(".svg"), count(".png")), (figures, figures));
}

#[cfg(not(feature = "pdf"))]
#[test]
fn a_program_without_typesetter_says_how_to_build_it_before_any_work() {
    let here = with_phantom(&[]);
    for form in [["--to", "pdf"], ["--out", "r.pdf"]] {
        let (_, error, code) = here.run(&[&["report", "no-such-case"], &form[..]].concat());
        assert!(code == 2 && error.contains("--features pdf"), "{form:?}: {code} {error}");
    }
    here.write("report.pdf", "%PDF-1.7");
    let (_, error, code) = here.run(&["rerun", "report.pdf"]);
    assert!(code == 2 && error.contains("--features pdf"), "{code} {error}");
}

#[cfg(feature = "pdf")]
#[test]
fn a_typeset_report_contains_its_analysis_and_is_repeated_from_itself() {
    let here = with_phantom(&[]);
    let (said, error, code) = here.run(&["report", "cases", "--to", "pdf"]);
    assert!(code == 0 && said.contains("phantom-rod-01.pdf"), "{code} {said} {error}");
    let bytes = fs::read(here.path("phantom-rod-01.pdf")).expect("the report is written");
    assert!(bytes.starts_with(b"%PDF-"));
    let text = spineline_pdf::embedded(&bytes).expect("an analysis is within");
    assert_eq!(json(&text)["case_id"], "phantom-rod-01");
    fs::remove_dir_all(here.path("cases")).expect("the case goes");
    let (said, error, code) = here.run(&["rerun", "phantom-rod-01.pdf"]);
    assert!(code == 0 && said.contains("Nothing differs"), "{code} {said} {error}");
}

#[test]
fn a_case_with_the_name_of_a_person_or_markup_as_its_identifier_is_refused() {
    let here = with_phantom(&[]);
    for name in ["Doe^Jane", "Doe, Jane", "Jane Doe", "../<script>病例", "", &"x".repeat(65)] {
        here.change(CASE, |case| case["case_id"] = name.into());
        for command in ["report", "analyze", "check"] {
            let error = here.refused(&[command, "cases"], 3);
            assert!(error.contains(&format!("`case_id` is `{name}`")), "{error}");
            assert!(error.contains("pseudonym"), "{error}");
        }
    }
    here.change(CASE, |case| case["case_id"] = "P-07_a.2".into());
    here.done(&["report", "cases"]);
}

#[test]
fn a_cohort_counts_refused_cases_and_does_not_depend_on_threads() {
    let here = with_phantoms("rod", &["1", "2"]);
    here.write("cases/odd.json", "{\"format\": \"spineline-case\"}");
    let mut reports = Vec::new();
    for threads in ["1", "3"] {
        let arguments = ["report", "cases", "--threads", threads];
        let error = here.refused(&arguments, 3);
        assert!(error.contains("odd.json"), "{error}");
        let report = here.path("cohort.html");
        let mut analyses = analysis_in(&report);
        // Names the command, which is another one.
        for analysis in analyses.as_array_mut().expect("a list") {
            assert!(analysis["provenance"].take().is_object());
        }
        let text = fs::read_to_string(report).expect("it is text");
        let (page, rest) = text.split_once("<script type=\"application/json\"").expect("within");
        let (_, end) = rest.split_once("</script>").expect("it ends");
        reports.push((page.to_owned(), end.to_owned(), analyses));
    }
    assert!(reports[0] == reports[1], "threads change the report");
    let (text, _, analyses) = reports.swap_remove(0);
    assert_eq!(analyses.as_array().map(Vec::len), Some(2));
    let said = ["odd.json", "the file could not be read", "2 patients", "case files read"];
    assert_says(&text, &said);
    let arguments = ["report", "cases", "--replicates", "10"];
    let (_, error, code) = here.run(&arguments);
    assert!(code == 2 && error.contains("one patient"), "{code} {error}");
}

#[test]
fn a_report_is_repeated_from_itself() {
    let here = with_phantom(&[]);
    for (form, name) in [("html", "a.html"), ("md", "a.md")] {
        let written = here.run(&["report", "cases", "--to", form, "--out", name]);
        assert_eq!(written.2, 0, "{}", written.1);
    }
    fs::remove_dir_all(here.path("cases")).expect("the case goes");
    for name in ["a.html", "a.md"] {
        let (said, error, code) = here.run(&["rerun", name]);
        assert!(code == 0 && said.contains("Nothing differs"), "{code} {said} {error}");
    }
}

#[test]
fn the_extension_of_the_output_chooses_the_format() {
    let here = with_phantom(&[]);
    here.done(&["report", "cases", "--out", "r.md"]);
    let text = here.text("r.md");
    assert!(text.contains("](r-figures/"), "Markdown with figures beside it");
    let contradiction = ["report", "cases", "--to", "html", "--out", "r.pdf"];
    let (_, error, code) = here.run(&contradiction);
    assert!(code == 2 && error.contains("contradicts the extension"), "{code} {error}");
    assert!(!here.path("r.pdf").exists());
}

#[test]
fn a_name_that_ends_like_another_format_is_refused() {
    let here = folder();
    // Refused before the case is read, which does not exist.
    let (_, error, code) = here.run(&["report", CASE, "--out", "x.docx"]);
    assert!(code == 2 && error.contains(".html, .md or .pdf"), "{code} {error}");
    assert!(!here.path("x.docx").exists());
}
