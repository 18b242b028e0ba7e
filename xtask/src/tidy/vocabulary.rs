//! Names that docs/vocabulary.md calls "not to be called", and the constructions that it lists to avoid, are absent from
//! documents, help, messages and comments.
//!
//! Names of several words are checked, which have only one meaning, and the [`WORDS`]. A name with a condition in
//! brackets, such as `agreement (alone)`, is left to people, and so are single words that are right elsewhere and
//! constructions with `…`.

use std::path::Path;

use crate::files::{read, sources};

use super::documents::{documents, lines_of_prose};

const LIST: &str = "docs/vocabulary.md";

/// The heading of the constructions.
const CONSTRUCTIONS: &str = "## Constructions to avoid";

/// Single words of the list that are wrong everywhere.
const WORDS: [&str; 5] = ["lean", "slant", "lobe", "roughness", "oddity"];

/// Folders of sources whose comments and texts are checked; of crates, only `src`.
const FOLDERS: [&str; 4] = ["crates", "xtask/src", "web/src", "python/spineline"];

/// Files that quote the list, and files that a program writes.
const FREE: [&str; 3] = [LIST, "web/src/api/", "xtask/src/tidy/vocabulary.rs"];

/// What is right in a file: a text of DICOM, names in stored files that are kept so that old files can be read, and a
/// selector of CSS.
const RIGHT: [(&str, &str); 5] = [
    ("crates/spineline-films/src/write.rs", "is no"),
    ("crates/spineline-films/src/write.rs", "there is no"),
    ("crates/spineline-landmarks/src/sr/codes.rs", "lean"),
    ("crates/spineline-tables/src/models.rs", "lean"),
    ("web/src/plan/PlanPicture.svelte", "force line"),
];

/// Lines with their numbers from 1.
type Lines = Vec<(usize, String)>;

pub fn check(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let list = read(&root.join(LIST))?;
    let mut avoided = names(&list);
    if let Some(word) = WORDS.iter().find(|word| !avoided.contains(&(**word).to_owned())) {
        faults.push(format!("{LIST}: `{word}` is not listed"));
    }
    avoided.extend(constructions(&list));
    for file in documents(root)? {
        check_text(root, &file, &avoided, prose, faults)?;
    }
    for folder in FOLDERS {
        for file in sources(&root.join(folder))? {
            if folder != "crates" || place(root, &file).contains("/src/") {
                check_text(root, &file, &avoided, source, faults)?;
            }
        }
    }
    Ok(())
}

fn check_text(
    root: &Path,
    file: &Path,
    avoided: &[String],
    lines: fn(&str) -> Lines,
    faults: &mut Vec<String>,
) -> Result<(), String> {
    let place = place(root, file);
    if FREE.iter().any(|free| place.starts_with(free)) {
        return Ok(());
    }
    for (number, words) in find(avoided, &lines(&read(file)?)) {
        if !RIGHT.contains(&(place.as_str(), words)) {
            faults.push(format!("{place}:{number}: avoid `{words}`; {LIST} has better words"));
        }
    }
    Ok(())
}

fn place(root: &Path, file: &Path) -> String {
    file.strip_prefix(root).unwrap_or(file).display().to_string()
}

/// A document without code.
fn prose(text: &str) -> Lines {
    let without_code = |line: &str| line.split('`').step_by(2).collect::<Vec<_>>().join("`");
    lines_of_prose(text).map(|(number, line)| (number, without_code(line))).collect()
}

/// A source without old names of keys and flags, which are still read.
fn source(text: &str) -> Lines {
    let lines = text.lines().enumerate().filter(|(_, line)| !line.contains("alias = \""));
    lines.map(|(index, line)| (index + 1, line.to_owned())).collect()
}

/// The words before the colon in the first column of the constructions.
fn constructions(list: &str) -> Vec<String> {
    let table = list.split(CONSTRUCTIONS).nth(1).unwrap_or_default();
    let table = table.split("\n## ").next().unwrap_or_default();
    let cells = table.lines().filter_map(|row| row.strip_prefix('|')?.split_once(':'));
    let words = cells.flat_map(|(words, _)| words.split(',')).map(str::trim);
    words.filter(|words| !words.contains(['…', '|'])).map(str::to_owned).collect()
}

/// The names that are checked, from the last column of the tables, in alphabetical order.
fn names(list: &str) -> Vec<String> {
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

/// All words that lines contain as whole words, in the singular or with an `s`, also over the end of a line.
fn find<'a>(avoided: &'a [String], lines: &[(usize, String)]) -> Vec<(usize, &'a str)> {
    let margin = |c: char| c.is_whitespace() || "/!*>".contains(c);
    let lines_of_words: Vec<_> = lines.iter().map(|(_, line)| line.trim_matches(margin)).collect();
    let text = lines_of_words.join("\n").to_lowercase();
    let flat = text.replace('\n', " ");
    let of_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = Vec::new();
    for words in avoided {
        for (at, _) in flat.match_indices(words.as_str()) {
            let before = flat[..at].chars().next_back();
            let after = &flat[at + words.len()..];
            let after = after.strip_prefix('s').unwrap_or(after).chars().next();
            if !before.is_some_and(of_word) && !after.is_some_and(of_word) {
                let (number, _) = lines[text[..at].matches('\n').count()];
                found.push((number, words.as_str()));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const LISTED: &str = "\
## Constructions to avoid
| avoid | write |
|---|---|
| is no, are no: \"A spring that is no spring.\" | \"It is not positive: 0.\" |
| what … of: \"what films show of it\" | \"the part that films show\" |
## Spine
| term | meaning | not to be called |
|---|---|---|
| tilt | of a vertebra: its axis | lean, slant |
| tilt range | of a curve | Cobb angle |
| Cobb angle | by endplates | curve angle |
| given line | of the user | own line; Model-1 (outside of the paper) |
| journal | list of changes | history |";

    fn found(lines: fn(&str) -> Lines, text: &str) -> Vec<(usize, String)> {
        let mut avoided = names(LISTED);
        avoided.extend(constructions(LISTED));
        let found = find(&avoided, &lines(text));
        found.into_iter().map(|(number, words)| (number, words.to_owned())).collect()
    }

    #[test]
    fn names_of_several_words_and_listed_words_are_avoided() {
        assert_eq!(names(LISTED), ["curve angle", "lean", "own line", "slant"]);
    }

    #[test]
    fn constructions_are_the_words_before_the_colon_without_gaps() {
        assert_eq!(constructions(LISTED), ["is no", "are no"]);
    }

    #[test]
    fn whole_words_are_found_in_singular_and_plural() {
        let text = "It leans along its\nOwn Line.";
        assert_eq!(found(source, text), [(1, "lean".to_owned()), (2, "own line".to_owned())]);
        assert!(
            found(source, "clean booleans of a `lean_deg` by its own lines_of_text").is_empty()
        );
        assert!(found(source, "a Cobb angle, and the history of Model-1").is_empty());
    }

    #[test]
    fn a_construction_is_found_in_prose_and_over_the_end_of_a_line_of_a_comment() {
        let construction = |number| vec![(number, "is no".to_owned())];
        assert_eq!(found(source, "use a;\n/// A spring that is\n/// no spring."), construction(2));
        assert_eq!(found(prose, "Films.\n\nThis Is no film."), construction(3));
        assert!(found(prose, "It `is no` film, is not\n```\nis no\n```").is_empty());
        assert!(found(source, "fn there_is_no_film() { is_no }").is_empty());
    }
}
