//! `analyze --shard` and `merge`: parts of a cohort, and their tables as one.

use std::fs;
use std::path::Path;

use parquet::file::reader::{FileReader, SerializedFileReader};

use crate::program::{self, Here};

/// Three patients, analysed as a whole into `whole` and by shards into `part1` and `part2`.
fn analysed() -> Here {
    let here = program::with_phantoms("rod", &["1", "2", "3"]);
    here.done(&["analyze", "cases", "--tables", "whole"]);
    for (shard, folder) in [("1/2", "part1"), ("2/2", "part2")] {
        here.done(&["analyze", "cases", "--shard", shard, "--tables", folder]);
    }
    here
}

fn rows(path: &Path) -> Vec<String> {
    let file = fs::File::open(path).expect("a table");
    let reader = SerializedFileReader::new(file).expect("Parquet");
    reader.get_row_iter(None).expect("rows").map(|row| row.expect("a row").to_string()).collect()
}

#[test]
fn merged_shards_are_the_tables_of_one_run() {
    let here = analysed();
    let said = here.done(&["merge", "part2", "part1", "--out", "merged"]);
    assert!(said.starts_with("3 cases of 2 parts in "), "{said}");
    let (whole, merged) = (here.path("whole"), here.path("merged"));
    let mut tables = 0;
    for entry in fs::read_dir(&whole).expect("a folder") {
        let name = entry.expect("a file").file_name().into_string().expect("a name");
        if name.ends_with(".csv") {
            let [one, other] = [&whole, &merged]
                .map(|folder| fs::read_to_string(folder.join(&name)).expect("a table"));
            assert!(one == other, "{name}");
            tables += 1;
        } else if name.ends_with(".parquet") {
            assert!(rows(&whole.join(&name)) == rows(&merged.join(&name)), "{name}");
            tables += 1;
        }
    }
    assert!(tables > 20, "{tables}");
    let list = here.json("merged/provenance.json");
    assert_eq!(list["provenance"]["inputs"].as_array().expect("inputs").len(), 3);
    assert_eq!(list["provenance"]["films"], "synthetic");
    let metadata =
        SerializedFileReader::new(fs::File::open(merged.join("joints.parquet")).expect("a table"));
    let metadata = metadata.expect("Parquet").metadata().file_metadata().clone();
    let origin = metadata.key_value_metadata().expect("metadata").iter();
    let origin: Vec<_> = origin.filter(|pair| pair.key == "spineline.provenance").collect();
    assert_eq!(origin.len(), 1, "only the one of the merged file");
    assert!(origin[0].value.as_ref().expect("provenance").contains("\"merge\""));
    // Merged tables can be merged again, and are replaced when the command is repeated.
    here.done(&["merge", "part1", "part2", "--out", "merged"]);
    here.done(&["merge", "merged", "--out", "again"]);
}

#[test]
fn parts_that_do_not_go_together_are_refused_and_named() {
    let here = analysed();
    let merge = |parts: &[&str]| {
        let arguments: Vec<&str> =
            ["merge"].iter().chain(parts).chain(&["--out", "merged"]).copied().collect();
        here.refused(&arguments, 3)
    };
    let text = merge(&["part1"]);
    assert!(text.contains("1 shard missing: 2/2"), "{text}");
    let text = merge(&["part1", "part1"]);
    assert!(text.contains("shard 1/2, as is part1"), "{text}");
    let text = merge(&["part1", "whole"]);
    assert!(text.contains("whole: it is not one of 2 shards"), "{text}");
    let text = merge(&["cases"]);
    assert!(text.contains("cases: it has no provenance.json"), "{text}");
    here.done(&["analyze", "cases", "--tables", "other", "--support", "free"]);
    let text = merge(&["whole", "other"]);
    assert!(text.contains("another version or other options than whole"), "{text}");
    here.done(&["analyze", program::CASE, "--tables", "one"]);
    let text = merge(&["whole", "one"]);
    assert!(text.contains("is in whole too"), "{text}");
    here.write("part2/joints.csv", "case_id\nx\n");
    let text = merge(&["part1", "part2"]);
    assert!(text.contains("part2/joints.csv: it is not as the analysis wrote it"), "{text}");
    assert!(!here.path("merged").exists(), "nothing is left of a merge that failed");
    let text = here.refused(&["merge", "whole", "--out", "whole"], 3);
    assert!(text.contains("input of this command"), "{text}");
}

#[test]
fn a_shard_writes_lists_and_needs_a_case() {
    let here = program::with_phantoms("rod", &["1", "2"]);
    here.done(&["analyze", "cases", "--json", "whole.json"]);
    here.done(&["analyze", "cases", "--shard", "2/2", "--json", "part.json"]);
    let (whole, part) = (here.json("whole.json"), here.json("part.json"));
    assert_eq!(part.as_array().expect("a list").len(), 1);
    assert_eq!(part[0]["case_id"], whole[1]["case_id"]);
    let text = here.refused(&["analyze", "cases", "--shard", "1/3"], 2);
    assert!(text.contains("this part has no case, since there are 2 cases"), "{text}");
    let text = here.refused(&["analyze", "cases", "--shard", "4/3"], 2);
    assert!(text.contains("expected a part and the number of parts"), "{text}");
}

#[test]
fn a_shard_without_a_usable_case_is_merged_too() {
    let here = program::with_phantoms("rod", &["1", "2"]);
    here.write("cases/a.json", "{}");
    here.refused(&["analyze", "cases", "--shard", "1/3", "--tables", "1"], 3);
    for (shard, folder) in [("2/3", "2"), ("3/3", "3")] {
        here.done(&["analyze", "cases", "--shard", shard, "--tables", folder]);
    }
    let said = here.done(&["merge", "1", "2", "3", "--out", "merged"]);
    assert!(said.starts_with("3 cases of 3 parts"), "{said}");
}
