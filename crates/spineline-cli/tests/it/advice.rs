//! Every command and option that a message or a document of the code names exists.

use std::collections::BTreeSet;
use std::path::Path;

use crate::program::folder;

/// Options of other programs.
const OF_OTHERS: [&str; 6] = ["--release", "--features", "--raw", "--mjcf", "--exact", "--ignored"];

/// The options that a text names.
fn options(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (place, _) in text.match_indices("--") {
        let before = text[..place].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '-' || c == '/') {
            continue;
        }
        let letter = |c: char| c.is_ascii_lowercase() || c == '-';
        let name: String = text[place + 2..].chars().take_while(|c| letter(*c)).collect();
        let name = name.trim_end_matches('-');
        if name.len() > 1 && !text[place + 2..].starts_with('-') {
            found.insert(format!("--{name}"));
        }
    }
    found
}

/// Commands in backticks, such as `spineline export CASE --to csv`, in words.
fn commands(text: &str) -> Vec<Vec<String>> {
    let quoted = text.split('`').skip(1).step_by(2);
    let calls = quoted.filter_map(|call| call.strip_prefix("spineline "));
    calls.map(|call| call.split_whitespace().map(str::to_owned).collect()).collect()
}

fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (mut all, mut files) = (Vec::new(), Vec::new());
    for folder in ["crates", "python/spineline"] {
        files.extend(walkdir::WalkDir::new(root.join(folder)).sort_by_file_name());
    }
    for entry in files {
        let path = entry.expect("readable").into_path();
        let name = path.to_string_lossy().replace('\\', "/");
        let is_source = name.contains("/src/") && name.ends_with(".rs") || name.ends_with(".py");
        if is_source && !name.contains("/target/") {
            all.push((name, std::fs::read_to_string(&path).expect("text")));
        }
    }
    all
}

#[test]
fn every_option_and_command_that_a_message_names_exists() {
    let here = folder();
    let help = |words: &[&str]| here.run(&[words, &["--help"]].concat());
    let known = options(&here.run(&["completions", "bash"]).0);
    assert!(known.contains("--landmarks") && known.contains("--reading"), "{known:?}");
    let mut wrong = BTreeSet::new();
    for (file, text) in sources() {
        for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
            for option in options(line) {
                if !known.contains(&option) && !OF_OTHERS.contains(&option.as_str()) {
                    wrong.insert(format!("{file}: {option}"));
                }
            }
            for call in commands(line) {
                let words = call.iter().map(String::as_str);
                let is_name =
                    |word: &&str| word.chars().all(|c| c.is_ascii_lowercase() || c == '-');
                let names: Vec<&str> = words
                    .take(2)
                    .take_while(|word| is_name(word) && !word.starts_with("--"))
                    .collect();
                let Some((first, _)) = names.split_first() else { continue };
                let nested = ["study", "account"].contains(first);
                let command = if nested { &names[..] } else { &names[..1] };
                let (shown, error, code) = help(command);
                if code != 0 {
                    wrong.insert(format!("{file}: {call:?}: {error}"));
                }
                let of_command = options(&shown);
                for option in options(&call.join(" ")) {
                    if !of_command.contains(&option) && option != "--help" {
                        wrong.insert(format!("{file}: {call:?} has no {option}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn options_and_commands_are_found_in_texts() {
    let text =
        "give `--patient-left image-left`; `spineline export CASE --to csv` writes a--b and ---";
    assert_eq!(options(text).into_iter().collect::<Vec<_>>(), ["--patient-left", "--to"]);
    assert_eq!(commands(text), [["export", "CASE", "--to", "csv"]]);
}
