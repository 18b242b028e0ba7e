//! Names that docs/vocabulary.md calls "not to be called" are absent from documents, help, messages and comments.
//!
//! Names of several words are checked, which have only one meaning, and the [`WORDS`]. A name with a condition in
//! brackets, such as `agreement (alone)`, is left to people, and so are single words that are right elsewhere.

use std::path::Path;

use super::documents::{documents, lines_of_prose};
use super::{read, sources};

const LIST: &str = "docs/vocabulary.md";

/// Single words of the list that are wrong everywhere.
const WORDS: [&str; 5] = ["lean", "slant", "lobe", "roughness", "oddity"];

/// Names in stored files, by file, that are kept so that old files can be read.
const STORED: [(&str, &str); 2] = [
    ("crates/spineline-landmarks/src/sr/codes.rs", "lean"),
    ("crates/spineline-tables/src/models.rs", "lean"),
];

pub fn check(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let names = avoided(&read(&root.join(LIST))?);
    if let Some(word) = WORDS.iter().find(|word| !names.contains(&(**word).to_owned())) {
        faults.push(format!("{LIST}: `{word}` is not listed"));
    }
    for document in documents(root)? {
        let place = place(root, &document);
        if place == LIST {
            continue;
        }
        let text = read(&document)?;
        for (number, line) in lines_of_prose(&text) {
            let prose: String = line.split('`').step_by(2).collect::<Vec<_>>().join("`");
            find(&names, &prose, |name| faults.push(fault(&place, number, name)));
        }
    }
    for file in sources(&root.join("crates"))? {
        let place = place(root, &file);
        if !place.contains("/src/") {
            continue;
        }
        for (index, line) in read(&file)?.lines().enumerate() {
            // Old names of keys and flags, which are still read.
            if line.contains("alias = \"") {
                continue;
            }
            find(&names, line, |name| {
                if !STORED.contains(&(place.as_str(), name)) {
                    faults.push(fault(&place, index + 1, name));
                }
            });
        }
    }
    Ok(())
}

fn place(root: &Path, file: &Path) -> String {
    file.strip_prefix(root).unwrap_or(file).display().to_string()
}

fn fault(place: &str, number: usize, name: &str) -> String {
    format!("{place}:{number}: `{name}` is a name to avoid; {LIST} has the term")
}

/// The names that are checked, from the last column of the tables, in alphabetical order.
fn avoided(list: &str) -> Vec<String> {
    let rows = list.lines().filter(|line| line.starts_with('|'));
    let rows: Vec<Vec<&str>> =
        rows.map(|row| row.trim_matches('|').split('|').map(str::trim).collect()).collect();
    // `Cobb angle` is listed at the tilt range, but it is a term itself.
    let terms: Vec<&str> = rows.iter().flat_map(|cells| cells[0].split(", ")).collect();
    let names =
        rows.iter().filter_map(|cells| cells.get(2)).flat_map(|cell| cell.split([',', ';']));
    let checked = |name: &&str| {
        *name != "not to be called"
            && !name.contains(['(', ')'])
            && !terms.contains(name)
            && (name.contains(' ') || WORDS.contains(name))
    };
    let mut names: Vec<String> = names.map(str::trim).filter(checked).map(str::to_owned).collect();
    names.sort();
    names.dedup();
    names
}

/// Reports every name that a text contains as whole words, in the singular or with an `s`.
fn find<'a>(names: &'a [String], text: &str, mut report: impl FnMut(&'a str)) {
    let text = text.to_lowercase();
    let of_word = |c: char| c.is_alphanumeric() || c == '_';
    for name in names {
        let is_whole = |(at, _): (usize, &str)| {
            let before = text[..at].chars().next_back();
            let after = &text[at + name.len()..];
            let after = after.strip_prefix('s').unwrap_or(after).chars().next();
            !before.is_some_and(of_word) && !after.is_some_and(of_word)
        };
        if text.match_indices(name.as_str()).any(is_whole) {
            report(name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "\
| term | meaning | not to be called |
|---|---|---|
| tilt | of a vertebra | lean, slant |
| tilt range | of a curve | Cobb angle |
| Cobb angle | by endplates | curve angle |
| given line | of the user | own line; Model-1 (outside of the paper) |
| journal | list of changes | history |";

    fn found(text: &str) -> Vec<String> {
        let names = avoided(TABLE);
        let mut found = Vec::new();
        find(&names, text, |name| found.push(name.to_owned()));
        found
    }

    #[test]
    fn names_of_several_words_and_listed_words_are_avoided() {
        assert_eq!(avoided(TABLE), ["curve angle", "lean", "own line", "slant"]);
    }

    #[test]
    fn whole_words_are_found_in_singular_and_plural() {
        assert_eq!(found("It leans along its Own Line."), ["lean", "own line"]);
        assert!(found("clean booleans of a `lean_deg` by its own lines_of_text").is_empty());
        assert!(found("a Cobb angle, and the history of Model-1").is_empty());
    }
}
