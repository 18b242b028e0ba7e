//! `analyze --tables`: which files there are, and that they say where they come from.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::program::{split, with_phantom};

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    entries.map(|e| e.expect("a file").file_name().into_string().expect("a name")).collect()
}

#[test]
fn every_table_is_written_in_both_formats_with_its_hash() {
    let here = with_phantom(&[]);
    here.done(&["analyze", "cases", "--tables", "t", "--threads", "1"]);
    let folder = here.path("t");
    let json = here.json("t/provenance.json");
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
    let dictionary = here.text("t/dictionary.csv");
    assert!(dictionary.starts_with("table,column,unit,type,meaning\n"));
    assert!(!dictionary.contains("\nuncertainty,"), "not requested");
}

#[test]
fn formats_are_chosen_and_requests_add_tables() {
    let here = with_phantom(&[]);
    let asked = split(
        "analyze cases --tables t --tables-format csv --replicates 2 --compare-models couple",
    );
    here.done(&asked);
    let found = names(&here.path("t"));
    assert!(found.contains("uncertainty.csv") && found.contains("hypotheses.csv"), "{found:?}");
    assert!(!found.iter().any(|name| name.ends_with(".parquet")), "{found:?}");
    let error = here.refused(&["analyze", "cases", "--tables-format", "csv"], 2);
    assert!(error.contains("--tables"), "{error}");
}
