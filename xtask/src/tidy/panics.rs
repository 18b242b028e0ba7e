//! No panic from outside data: in crates that read such data, code that may panic is in a list, and macros that panic
//! on a full stream are forbidden.

use std::collections::BTreeSet;
use std::path::Path;

use crate::files::{read, sources};

/// Crates that read files, requests or streams.
const READERS: [&str; 11] = [
    "spineline-cli",
    "spineline-dicomweb",
    "spineline-files",
    "spineline-films",
    "spineline-landmarks",
    "spineline-pdf",
    "spineline-py",
    "spineline-report",
    "spineline-server",
    "spineline-store",
    "spineline-tables",
];

/// Panics known to be impossible, each with the reason in its message: `file: code`.
const KNOWN: &str = include_str!("panics.txt");

const PANICKING: [&str; 9] = [
    ".unwrap()",
    ".expect(",
    ".expect_err(",
    "panic!(",
    "unreachable!(",
    "todo!(",
    "unimplemented!(",
    "assert!(",
    "assert_eq!(",
];

const PRINTING: [&str; 5] = ["println!(", "eprintln!(", "print!(", "eprint!(", "dbg!("];

pub fn check(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let mut unused: BTreeSet<&str> = KNOWN.lines().collect();
    for reader in READERS {
        let folder = root.join("crates").join(reader).join("src");
        let files = sources(&folder)?;
        let mut test_files = BTreeSet::new();
        let mut texts = Vec::new();
        for file in &files {
            let text = read(file)?;
            test_files.extend(test_modules(&text).map(|name| file.with_file_name(name + ".rs")));
            texts.push((file, text));
        }
        for (file, text) in texts.iter().filter(|(file, _)| !test_files.contains(*file)) {
            let place = file.strip_prefix(root).unwrap_or(file).display().to_string();
            check_file(&place, text, &mut unused, faults);
        }
    }
    let gone =
        |line: &&str| format!("xtask/src/tidy/panics.txt: `{line}` is not in the code any more");
    faults.extend(unused.iter().map(gone));
    Ok(())
}

fn check_file(place: &str, text: &str, unused: &mut BTreeSet<&str>, faults: &mut Vec<String>) {
    for (number, line) in program_lines(text) {
        if let Some(word) = PRINTING.iter().find(|word| is_called(line, word)) {
            faults.push(format!(
                "{place}:{number}: `{word}` panics where the stream is full; write without a panic"
            ));
        }
        if PANICKING.iter().any(|word| is_called(line, word)) {
            let known = format!("{place}: {}", line.trim());
            if !KNOWN.lines().any(|line| line == known) {
                faults.push(format!(
                    "{place}:{number}: it may panic: return an error, or, where it is impossible, say why there and add the line \
                     to xtask/src/tidy/panics.txt"
                ));
            }
            unused.remove(known.as_str());
        }
    }
}

/// Whether a line has a macro or method as a whole name, unlike `debug_assert!`.
fn is_called(line: &str, word: &str) -> bool {
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        word.starts_with('.') || !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
    })
}

/// Modules that are compiled only for tests.
fn test_modules(text: &str) -> impl Iterator<Item = String> {
    let pairs = text.lines().zip(text.lines().skip(1));
    pairs.filter(|(first, _)| first.trim() == "#[cfg(test)]").filter_map(|(_, second)| {
        Some(second.trim().strip_prefix("mod ")?.strip_suffix(';')?.to_owned())
    })
}

/// Lines of the program with their numbers: without comments, and without code that is compiled only for tests.
fn program_lines(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((number, line)) = lines.next() {
        if line.trim() == "#[cfg(test)]" {
            let indent = line.len() - line.trim_start().len();
            let ends = |line: &str| {
                line.len() - line.trim_start().len() <= indent
                    && line.trim_end().ends_with(['}', ';'])
            };
            lines.by_ref().find(|(_, line)| ends(line));
            continue;
        }
        let code = line.trim_start();
        if !code.starts_with("//") {
            found.push((number + 1, line));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_panic_is_found_outside_of_tests_and_comments() {
        let text = "\
fn read() {
    // a.expect(\"in a comment\");
    debug_assert!(true);
    a.expect(\"why\");
    eprintln!(\"x\");
}

#[cfg(test)]
mod tests {
    fn test() {
        a.unwrap();
    }
}
";
        let mut faults = Vec::new();
        check_file("a.rs", text, &mut BTreeSet::new(), &mut faults);
        assert_eq!(faults.len(), 2, "{faults:#?}");
        assert!(faults[0].starts_with("a.rs:4: it may panic"), "{faults:#?}");
        assert!(faults[1].starts_with("a.rs:5: `eprintln!(`"), "{faults:#?}");
        assert_eq!(
            test_modules("#[cfg(test)]\nmod full_disk;\n").next().as_deref(),
            Some("full_disk")
        );
    }

    #[test]
    fn the_program_keeps_the_rule() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a workspace");
        let mut faults = Vec::new();
        check(root, &mut faults).expect("readable");
        assert!(faults.is_empty(), "{faults:#?}");
    }
}
