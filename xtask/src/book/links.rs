//! Links between pages: the book lays the documents of the repository out anew, and has no dead link.

use std::path::{Component, Path, PathBuf};

use crate::files::{entries, read};

/// Files of the repository that the book holds beside the guide, and their places in it.
pub const PAGES: [(&str, &str); 10] = [
    ("benchmarks/results.md", "results/times.md"),
    ("docs/landmarks.md", "landmarks.md"),
    ("validation/claims.md", "results/claims.md"),
    ("validation/lines.md", "results/lines.md"),
    ("validation/noise-study.svg", "results/noise-study.svg"),
    ("validation/noise.md", "results/noise.md"),
    ("validation/proposals.md", "results/proposals.md"),
    ("validation/space.md", "results/space.md"),
    ("validation/stiffness.md", "results/stiffness.md"),
    ("validation/warnings.md", "results/warnings.md"),
];

/// The folder of the guide in the repository.
const GUIDE: &str = "docs/guide/src";

/// The text of a document of the repository as a page of the book: links lead to pages of the book, and where it lacks them, their words
/// remain.
pub fn in_book(text: &str, document: &str, page: &str) -> String {
    let folder = Path::new(document).parent().unwrap_or(Path::new(""));
    let up = "../".repeat(page.matches('/').count());
    with_links(text, |target| {
        let (path, anchor) = target.split_at(target.find('#').unwrap_or(target.len()));
        if path.is_empty() || path.contains(':') {
            return Some(target.to_owned());
        }
        let place = normal(&folder.join(path));
        let known = PAGES.iter().find(|(from, _)| Path::new(from) == place);
        let to = match known {
            Some((_, to)) => (*to).to_owned(),
            None => place.strip_prefix(GUIDE).ok()?.display().to_string(),
        };
        Some(format!("{up}{to}{anchor}"))
    })
}

/// Links of the pages below a folder that lead to no file.
pub fn dead(folder: &Path) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    for page in pages(folder)? {
        let text = read(&page)?;
        let beside = page.parent().unwrap_or(folder);
        with_links(&text, |target| {
            let path = target.split('#').next().unwrap_or_default();
            if !path.is_empty() && !path.contains(':') && !beside.join(path).exists() {
                found.push(format!("{}: {target}", page.display()));
            }
            None
        });
    }
    Ok(found)
}

fn pages(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    for path in entries(folder)? {
        if path.is_dir() {
            found.extend(pages(&path)?);
        } else if path.extension().is_some_and(|end| end == "md") {
            found.push(path);
        }
    }
    Ok(found)
}

/// The text with the target of every link as `map` gives it; without a target, the words of the link remain. Code keeps its brackets.
fn with_links(text: &str, mut map: impl FnMut(&str) -> Option<String>) -> String {
    let mut is_code = false;
    let lines = text.split_inclusive('\n').map(|line| {
        is_code ^= line.trim_start().starts_with("```");
        if is_code { line.to_owned() } else { line_with_links(line, &mut map) }
    });
    lines.collect()
}

fn line_with_links(line: &str, map: &mut impl FnMut(&str) -> Option<String>) -> String {
    let mut written = String::new();
    let mut rest = line;
    while let Some((before, after)) = rest.split_once("](") {
        let (Some(open), Some((target, behind))) = (before.rfind('['), after.split_once(')'))
        else {
            break;
        };
        match map(target) {
            Some(target) => written.push_str(&format!("{before}]({target})")),
            None => written.push_str(&[&before[..open], &before[open + 1..]].concat()),
        }
        rest = behind;
    }
    written + rest
}

/// A path without `..`.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => drop(normal.pop()),
            other => normal.push(other),
        }
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_to_pages_of_the_book_or_leave_their_words() {
        let text = "[lines](../../../validation/lines.md#limits), [start](start.md), [why](../../decisions/0001.md)\n\
                    ```\n[[1]](x)\n```\n[here](#below) and [there](https://a.org)\n";
        assert_eq!(
            in_book(text, "docs/guide/src/own.md", "own.md"),
            "[lines](results/lines.md#limits), [start](start.md), why\n\
             ```\n[[1]](x)\n```\n[here](#below) and [there](https://a.org)\n"
        );
        let page = in_book(
            "![n](noise-study.svg) [s](../docs/guide/src/sure.md)",
            "validation/noise.md",
            "results/noise.md",
        );
        assert_eq!(page, "![n](../results/noise-study.svg) [s](../sure.md)");
    }

    #[test]
    fn every_page_of_the_repository_is_there() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a workspace");
        for (from, _) in PAGES {
            assert!(root.join(from).is_file(), "{from}");
        }
    }
}
