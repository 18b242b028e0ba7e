//! `analyze --tables`: which files there are, and that they say where they come from.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program;

fn run(folder: &Path, arguments: &[&str]) -> (String, i32) {
    let (_, error, code) = program::run(folder, arguments);
    (error, code)
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    entries.map(|e| e.expect("a file").file_name().into_string().expect("a name")).collect()
}

#[test]
fn every_table_is_written_in_both_formats_with_its_hash() {
    let here = program::with_phantom(&[]);
    let (error, code) = run(here.path(), &["analyze", "cases", "--tables", "t", "--threads", "1"]);
    assert_eq!(code, 0, "{error}");
    let folder = here.path().join("t");
    let text = fs::read_to_string(folder.join("provenance.json")).expect("where they come from");
    let json: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(json["provenance"]["films"], "synthetic");
    let listed = json["of"].as_array().expect("files");
    for file in listed {
        let bytes = fs::read(folder.join(file["name"].as_str().expect("a name"))).expect("a file");
        assert_eq!(
            file["sha256"],
            spineline_files::sha256_hex(&bytes).as_str(),
            "{}",
            file["name"]
        );
    }
    let found = names(&folder);
    assert_eq!(found.len(), listed.len() + 1);
    for name in ["patients", "postures", "vertebrae", "joints", "lines", "clinical", "warnings"] {
        for end in ["csv", "parquet"] {
            assert!(found.contains(&format!("{name}.{end}")), "{name}.{end}");
        }
    }
    let dictionary = fs::read_to_string(folder.join("dictionary.csv")).expect("meanings");
    assert!(dictionary.starts_with("table,column,unit,type,meaning\n"));
    assert!(!dictionary.contains("\nuncertainty,"), "not requested");
}

#[test]
fn formats_are_chosen_and_requests_add_tables() {
    let here = program::with_phantom(&[]);
    let asked = [
        "analyze",
        "cases",
        "--tables",
        "t",
        "--tables-format",
        "csv",
        "--replicates",
        "2",
        "--compare-models",
        "couple",
    ];
    let (error, code) = run(here.path(), &asked);
    assert_eq!(code, 0, "{error}");
    let found = names(&here.path().join("t"));
    assert!(found.contains("uncertainty.csv") && found.contains("hypotheses.csv"), "{found:?}");
    assert!(!found.iter().any(|name| name.ends_with(".parquet")), "{found:?}");
    let (error, code) = run(here.path(), &["analyze", "cases", "--tables-format", "csv"]);
    assert!(code == 2 && error.contains("--tables"), "{error}");
}
