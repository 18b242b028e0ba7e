//! Files, folders and items that documents name in backquotes exist.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::files::{entries, read, sources};

/// Folders of documents; only what lies directly in them counts.
const FOLDERS_OF_DOCUMENTS: [&str; 5] =
    ["", "docs", "docs/decisions", "docs/guide/src", "validation"];

/// Folders of the repository: a name that starts with one of them and a slash is a path.
const FOLDERS: [&str; 11] = [
    "benchmarks",
    "crates",
    "docs",
    "fuzz",
    "integrations",
    "packaging",
    "python",
    "training",
    "validation",
    "web",
    "xtask",
];

/// A name with one of these endings is a path too; users' files may have other endings.
const ENDINGS: [&str; 5] = [".rs", ".ts", ".svelte", ".pyi", ".bib"];

/// Folders that a build makes.
const BUILT: [&str; 1] = ["web/dist"];

/// Folders without written files.
const UNWRITTEN: [&str; 5] = ["target", "node_modules", "dist", "out", "__pycache__"];

/// All documents whose text is checked.
pub fn documents(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    for folder in FOLDERS_OF_DOCUMENTS {
        for path in entries(&root.join(folder))? {
            if path.extension().is_some_and(|end| end == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// Lines of a document outside of blocks of code, with their numbers from 1.
pub fn lines_of_prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_code = false;
    text.lines().enumerate().filter_map(move |(index, line)| {
        let is_fence = line.trim_start().starts_with("```");
        in_code ^= is_fence;
        (!in_code && !is_fence).then_some((index + 1, line))
    })
}

pub fn check(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let mut paths = Vec::new();
    list(root, "", &mut paths)?;
    let mut words = BTreeSet::new();
    for file in sources(&root.join("crates"))? {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        words.extend(read(&file)?.split(|c| !is_word(c)).map(str::to_owned));
    }
    for document in documents(root)? {
        let place = document.strip_prefix(root).unwrap_or(&document).display().to_string();
        let text = read(&document)?;
        for (number, line) in lines_of_prose(&text) {
            for name in line.split('`').skip(1).step_by(2) {
                let is_there = match path_of(name) {
                    Some(path) => BUILT.contains(&path) || paths.iter().any(|p| ends_in(p, path)),
                    None => items_of(name).iter().all(|item| words.contains(*item)),
                };
                if !is_there {
                    faults.push(format!("{place}:{number}: `{name}` does not exist"));
                }
            }
        }
    }
    Ok(())
}

/// Adds all files and folders below a folder, as paths from the root with slashes.
fn list(folder: &Path, at: &str, paths: &mut Vec<String>) -> Result<(), String> {
    for path in entries(folder)? {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with('.') || UNWRITTEN.contains(&name.as_str()) {
            continue;
        }
        let inside = if at.is_empty() { name } else { format!("{at}/{name}") };
        if path.is_dir() {
            list(&path, &inside, paths)?;
        }
        paths.push(inside);
    }
    Ok(())
}

/// The repository path of a name in backquotes, without `…/`, which replaces a folder named before.
fn path_of(name: &str) -> Option<&str> {
    let of_path = |c: char| c.is_ascii_alphanumeric() || "_-./*".contains(c);
    let rest = name.strip_prefix("…/");
    let path = rest.unwrap_or(name).trim_end_matches('/');
    let in_folder = path.split_once('/').is_some_and(|(first, _)| FOLDERS.contains(&first));
    let is_path = rest.is_some() || in_folder || ENDINGS.iter().any(|end| path.ends_with(end));
    (is_path && path.chars().all(of_path)).then_some(path)
}

/// The words of a path of the library, such as `measure::Corners::{width, height}`; empty for other names.
fn items_of(name: &str) -> Vec<&str> {
    let of_item = |c: char| c.is_ascii_alphanumeric() || "_:{}, ".contains(c);
    if !name.contains("::") || !name.chars().all(of_item) {
        return Vec::new();
    }
    name.split([':', '{', '}', ',', ' ']).filter(|word| !word.is_empty()).collect()
}

/// Whether a path ends in the named one; `*` matches any part of a name.
fn ends_in(path: &str, named: &str) -> bool {
    let tails = path.match_indices('/').map(|(at, _)| &path[at + 1..]);
    std::iter::once(path).chain(tails).any(|tail| matches(tail, named))
}

fn matches(name: &str, pattern: &str) -> bool {
    match pattern.split_once('*') {
        None => name == pattern,
        Some((start, end)) => name.strip_prefix(start).is_some_and(|rest| {
            let tails = rest.char_indices().map(|(at, _)| &rest[at..]).chain([""]);
            tails.into_iter().any(|tail| matches(tail, end))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_and_folders_are_paths() {
        assert_eq!(path_of("crates/spineline/"), Some("crates/spineline"));
        assert_eq!(path_of("…/general/wrench.rs"), Some("general/wrench.rs"));
        assert_eq!(path_of("faults*.rs"), Some("faults*.rs"));
        for other in ["model.json", "crates", "crates/<name>.rs", "out/phantoms", "p < 0.05"] {
            assert_eq!(path_of(other), None, "{other}");
        }
    }

    #[test]
    fn a_path_is_found_by_its_end_and_by_a_pattern() {
        let path = "crates/spineline/tests/it/faults_lines.rs";
        for named in [path, "it/faults_lines.rs", "faults_lines.rs", "faults*.rs", "*_lines.rs"] {
            assert!(ends_in(path, named), "{named}");
        }
        for named in ["lines.rs", "faults.rs", "crates", "faults*.ts"] {
            assert!(!ends_in(path, named), "{named}");
        }
    }

    #[test]
    fn items_are_the_words_of_a_path_of_the_library() {
        assert_eq!(
            items_of("measure::Corners::{width_mm, height_mm}"),
            ["measure", "Corners", "width_mm", "height_mm"]
        );
        assert!(items_of("k·Δθ = d·F").is_empty());
        assert!(items_of("--film-lengths").is_empty());
    }

    #[test]
    fn blocks_of_code_are_not_prose() {
        let lines: Vec<_> = lines_of_prose("a\n```sh\nb\n```\nc").collect();
        assert_eq!(lines, [(1, "a"), (5, "c")]);
    }
}
