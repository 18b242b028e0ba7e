//! The list of faults is complete, and each test that it names exists.

use std::collections::BTreeSet;
use std::path::Path;

use crate::files::read;

const LIST: &str = "validation/faults.md";

/// Number of faults at the project's start.
const FAULTS: u32 = 75;

pub fn check(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let text = read(&root.join(LIST))?;
    let rows = text.lines().filter(|line| line.starts_with("| F"));
    let mut listed = BTreeSet::new();
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [first, .., tests] = cells[..] else { continue };
        let words = first.split([' ', ',']);
        listed.extend(words.filter_map(|word| word.strip_prefix('F')?.parse::<u32>().ok()));
        check_tests(root, first, tests, faults)?;
    }
    for number in (1..=FAULTS).filter(|number| !listed.contains(number)) {
        faults.push(format!("{LIST}: F{number} is not listed"));
    }
    Ok(())
}

/// A cell names files, and after each file its tests; `f1_…` matches all names that begin so.
fn check_tests(
    root: &Path,
    fault: &str,
    cell: &str,
    faults: &mut Vec<String>,
) -> Result<(), String> {
    let mut source = None;
    let mut named = 0;
    for word in cell.split('`').skip(1).step_by(2) {
        if word.contains('/') {
            let folder = if word.starts_with("spineline") { "crates" } else { "" };
            let path = root.join(folder).join(word);
            source = path.exists().then(|| read(&path)).transpose()?;
            if source.is_none() {
                faults.push(format!("{LIST}: {fault}: no file `{word}`"));
            }
        } else if let Some(source) = &source {
            named += 1;
            if !has_test(source, word) {
                faults.push(format!("{LIST}: {fault}: no test `{word}` in the file before it"));
            }
        }
    }
    if named == 0 {
        faults.push(format!("{LIST}: {fault}: no test is named"));
    }
    Ok(())
}

fn has_test(source: &str, name: &str) -> bool {
    match name.strip_suffix('…') {
        Some(start) => {
            source.contains(&format!("fn {start}")) || source.contains(&format!("\"{start}"))
        }
        None => source.contains(&format!("fn {name}(")) || source.contains(&format!("\"{name}\"")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_is_found_by_its_name_or_its_beginning() {
        let source = "fn f1_a_film() {}\ntest(\"a page opens\", async () => {});";
        for (name, is_there) in [
            ("f1_a_film", true),
            ("f1_…", true),
            ("a page opens", true),
            ("f1_a", false),
            ("f2_…", false),
        ] {
            assert_eq!(has_test(source, name), is_there, "{name}");
        }
    }
}
