//! An analysis again from nothing but its file, and where outputs say that they come from.

use std::fs;

use spineline_files::Content;

use crate::program::{CASE, assert_says, finish, json, spineline, split, succeeded, with_phantom};

#[test]
fn an_analysis_is_repeated_from_its_file() {
    let here = with_phantom(&[]);
    let at = |name: &str| here.path(name);
    let stiffness = here.done(&["stiffness"]).replace("132.0", "131.9");
    here.write("springs.json", stiffness);
    let asked = split(
        "--json a.json --fit ferguson --stiffness springs.json --compare-models couple \
         --replicates 3 --noise 2.5 --seed 7 --identifiability --min-curve 4.1",
    );
    here.done(&[&["analyze", CASE], &asked[..]].concat());
    fs::create_dir(at("elsewhere")).expect("a folder");
    fs::rename(at("a.json"), at("elsewhere/a.json")).expect("moved");
    let again = ["rerun", "a.json", "--json", "b.json", "--tolerance", "0"];
    let text = succeeded(finish(spineline(&at("elsewhere")).args(again)));
    assert_says(
        &text,
        &["SYNTHETIC", "Nothing differs", "2026-01-02T03:04:05Z", "not here", "--min-curve"],
    );
    let (mut a, mut b) = (here.json("elsewhere/a.json"), here.json("elsewhere/b.json"));
    assert_eq!(a["provenance"]["inputs"].as_array().map(Vec::len), Some(2), "case and springs");
    for file in [&mut a, &mut b] {
        let provenance = file["provenance"].as_object_mut().expect("an object");
        provenance.retain(|key, _| !["command", "content_sha256"].contains(&key.as_str()));
    }
    assert_eq!(a, b);
}

#[test]
fn changes_are_listed_with_their_place_and_set_the_exit_code() {
    let here = with_phantom(&[]);
    // The case lies elsewhere, where only its whole path finds it.
    here.done(&["analyze", CASE, "--json", "a.json", "--full-paths"]);
    let mut file = here.json("a.json");
    let length = file["chain"]["segment_mm"].as_f64().expect("a number");
    file["chain"]["segment_mm"] = (length * (1.0 + 1e-6)).into();
    file["sagittal_profile"] = "measured".into();
    file["provenance"]["program"] = "spineline 0.0.1".into();
    here.write("a.json", file.to_string());
    here.write(CASE, "{}");
    let (text, _, code) = here.run(&["rerun", "a.json"]);
    assert_eq!(code, 4, "{text}");
    assert_says(
        &text,
        &[
            "chain.segment_mm",
            "1.0e−6",
            "sagittal_profile",
            "\"measured\"",
            "CHANGED",
            "then spineline 0.0.1",
        ],
    );
    let (text, _, code) = here.run(&["rerun", "a.json", "--tolerance", "1e-5"]);
    assert!(code == 4 && !text.contains("chain.segment_mm"), "a text has no tolerance: {text}");
    here.write("a.json", "%PDF-1.7 and no analysis");
    let (_, error, code) = here.run(&["rerun", "a.json"]);
    // A build without typesetter reads no PDF, and says so.
    let (expected, words) = if cfg!(feature = "pdf") {
        (3, "this file has no analysis")
    } else {
        (2, "--features pdf")
    };
    assert!(code == expected && error.contains(words), "{error}");
    here.write("a.json", "{\"format\": \"spineline-analysis\", ");
    let (_, error, code) = here.run(&["rerun", "a.json"]);
    assert!(code == 3 && error.contains("not JSON"), "{error}");
}

#[test]
fn a_key_that_stands_twice_is_refused() {
    let here = with_phantom(&[]);
    here.done(&["analyze", CASE, "--json", "a.json"]);
    let text = here.text("a.json");
    let case = here.text(CASE);
    let other = case.replace("phantom-rod-01", "phantom-rod-02");
    let within = text.replacen("\"chain\": {", "\"chain\": {\"segment_mm\": 1.0,", 1);
    for (twice, key) in [
        (text.replacen("\"case\":", &format!("\"case\": {other}, \"case\":"), 1), "key case is"),
        (within, "key segment_mm is"),
    ] {
        assert_ne!(twice, text, "the test means something");
        here.write("a.json", &twice);
        for command in ["rerun", "check", "analyze"] {
            let (_, error, code) = here.run(&[command, "a.json"]);
            let said = error.contains(key) && error.contains("given twice");
            assert!(code == 3 && said, "{command}: {code} {error}");
        }
    }
}

#[test]
fn a_report_with_another_printed_number_is_found() {
    let here = with_phantom(&[]);
    for name in ["r.html", "r.md"] {
        here.done(&["report", CASE, "--out", name]);
        let (text, _, code) = here.run(&["rerun", name]);
        assert!(code == 0 && text.contains("Page: as it was written"), "{text}");
        let page = here.text(name);
        let at = page.find('°').expect("an angle");
        let digit = page[..at].rfind(|c: char| c.is_ascii_digit()).expect("a number");
        let other = if &page[digit..=digit] == "7" { "8" } else { "7" };
        let changed = [&page[..digit], other, &page[digit + 1..]].concat();
        here.write(name, changed);
        let (text, error, code) = here.run(&["rerun", name]);
        assert!(code == 4 && text.contains("Page: CHANGED"), "{text}{error}");
        assert!(text.contains("Nothing differs"), "the analysis in it is as it was: {text}");
        let without = page.replace("content_sha256", "content");
        here.write(name, without);
        let (text, ..) = here.run(&["rerun", name]);
        assert!(text.contains("Page: NOT CHECKED"), "{text}");
    }
}

#[test]
fn figures_are_made_from_the_analysis_and_a_cohort_is_a_list() {
    let here = with_phantom(&[]);
    here.add_phantom(&["--subject", "2"]);
    let asked =
        ["analyze", "cases", "--json", "all.json", "--figures", "first", "--support", "frontal"];
    here.done(&asked);
    fs::remove_dir_all(here.path("cases")).expect("gone");
    let (text, error, code) = here.run(&["rerun", "all.json", "--figures", "second"]);
    assert_eq!(code, 0, "{error}");
    assert!(text.contains("phantom-rod-01") && text.contains("phantom-rod-02"), "{text}");
    let picture = |folder: &str, name: &str| {
        let svg = here.text(format!("{folder}/{name}"));
        let (before, rest) = svg.split_once("<metadata>").expect("where it comes from");
        let (metadata, after) = rest.split_once("</metadata>").expect("an end");
        let provenance = json(metadata);
        assert_eq!(provenance["options"]["support"], "frontal");
        assert_eq!(Content::of(svg.as_bytes()), Content::AsWritten);
        format!("{before}{after}")
    };
    for entry in fs::read_dir(here.path("first")).expect("figures") {
        let name = entry.expect("a figure").file_name().into_string().expect("a name");
        assert_eq!(picture("first", &name), picture("second", &name), "{name}");
    }
}

#[test]
fn a_case_is_read_from_an_analysis_and_other_options_are_reported() {
    let here = with_phantom(&[]);
    let analyse = |asked: &[&str]| here.run(&[&["analyze"], asked].concat());
    assert_eq!(analyse(&[CASE, "--json", "a.json", "--fit", "ferguson"]).2, 0);
    let (of_case, _, _) = analyse(&[CASE]);
    let (of_analysis, error, code) = analyse(&["a.json"]);
    assert_eq!((code, &of_analysis), (0, &of_case));
    assert!(error.contains("[other_options]"), "{error}");
    let (_, error, _) = analyse(&["a.json", "--fit", "ferguson"]);
    assert!(!error.contains("[other_options]"), "{error}");
    let (_, error, code) = analyse(&["a.json", CASE]);
    assert!(code == 3 && error.contains("was given already"), "{error}");
    // A patient counts once under any identifier.
    let text = here.text(CASE);
    for (id, words) in [("other", "has the landmarks of"), ("PHANTOM-rod-01", "given already as")] {
        let renamed = text.replace("\"phantom-rod-01\"", &format!("\"{id}\""));
        here.write("renamed.json", renamed);
        let (_, error, code) = analyse(&["renamed.json", CASE]);
        assert!(code == 3 && error.contains(words), "{error}");
    }
    // Also without one of its films.
    let mut fewer = json(&text);
    fewer["case_id"] = "fewer".into();
    assert_ne!(fewer["films"].as_array_mut().expect("films").pop(), None);
    here.write("fewer.json", fewer.to_string());
    let (_, error, code) = analyse(&["fewer.json", CASE]);
    let words = "has the landmarks of a film of the case fewer";
    assert!(code == 3 && error.contains(words), "{error}");
    here.done(&["check", "a.json"]);
}

#[test]
fn every_file_of_an_analysis_has_provenance() {
    let here = with_phantom(&[]);
    let outputs = split(
        "--json a.json --csv errors.csv --chain chain.csv --cohort cohort.json --model model.json",
    );
    here.done(&[&["analyze", CASE], &outputs[..]].concat());
    let simulate =
        ["simulate", "model.json", "--push", "left", "--force", "20", "--json", "s.json"];
    here.done(&simulate);
    here.done(&["reliability", CASE, "--json", "r.json"]);
    let hash = spineline_files::sha256_hex(&fs::read(here.path(CASE)).expect("the case"));
    for name in [
        "a.json",
        "errors.csv.provenance.json",
        "chain.csv.provenance.json",
        "cohort.json",
        "model.json",
        "s.json",
        "r.json",
    ] {
        let provenance = &here.json(name)["provenance"];
        assert_eq!(provenance["date_utc"], "2026-01-02T03:04:05Z", "{name}");
        assert_eq!(provenance["films"], "synthetic", "{name}");
        assert_eq!(provenance["command"][0], "spineline", "{name}");
        assert!(provenance["program"].as_str().is_some_and(|text| text.contains('.')), "{name}");
        if name != "s.json" {
            assert_eq!(provenance["inputs"][0]["name"], "phantom-rod-01.json", "{name}");
            assert_eq!(provenance["inputs"][0]["sha256"], hash.as_str(), "{name}");
        }
    }
    let model = fs::read(here.path("model.json")).expect("the model");
    let input = &here.json("s.json")["provenance"]["inputs"][0];
    assert_eq!(input["sha256"], spineline_files::sha256_hex(&model).as_str());
    let table = fs::read(here.path("errors.csv")).expect("the table");
    let of = &here.json("errors.csv.provenance.json")["of"][0];
    assert_eq!(of["sha256"], spineline_files::sha256_hex(&table).as_str());
    let mut wrong = spineline(here.folder());
    wrong.env("SOURCE_DATE_EPOCH", "soon").args(["analyze", CASE, "--json", "-"]);
    assert_eq!(finish(&mut wrong).2, 2);
}
