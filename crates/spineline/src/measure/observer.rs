//! Codes of observers: one rule for files, studies and Python.

use std::collections::{BTreeMap, BTreeSet};

use crate::warning::first_named;

/// The rule for a code of an observer, in words.
pub const OBSERVER_RULE: &str = "1 to 64 letters, digits, `.`, `-` and `_`, such as A or reader-2";

/// Remedy where the observer of a reading is not a code.
pub(super) const OBSERVER_HELP: &str =
    "give every observer a code, the same in all files and studies, and no name of a person";

/// Whether a text is the code of an observer: 1 to 64 ASCII letters, digits, `.`, `-` and `_`.
///
/// ```
/// use spineline::measure::is_observer_code;
/// assert!(is_observer_code("reader-2"));
/// assert!(!is_observer_code("Dr. A. B.") && !is_observer_code("A ") && !is_observer_code(""));
/// ```
#[must_use]
pub fn is_observer_code(text: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '_');
    (1..=64).contains(&text.len()) && text.chars().all(allowed)
}

/// Names, as of observers, that differ by capitals, blanks and marks between letters alone, in groups of at least two; each name
/// counts nevertheless.
///
/// ```
/// use spineline::measure::alike_names;
/// assert_eq!(alike_names(["A", "b", "B", "b"]), [["B", "b"]]);
/// assert_eq!(alike_names(["R1", "R-1", "r_1", "R2"]), [["R-1", "r_1"]]);
/// ```
#[must_use]
pub fn alike_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<Vec<&'a str>> {
    let mut alike: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    for name in names {
        alike.entry(folded(name)).or_default().insert(name);
    }
    let groups = alike.into_values().filter(|names| names.len() > 1);
    groups.map(|names| names.into_iter().collect()).collect()
}

/// The letters and digits of a name, with one mark for whatever stands between them.
fn folded(name: &str) -> String {
    let lower = name.to_lowercase();
    let words = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_")
}

/// The words on such names of subjects or quantities; `None` without any.
///
/// ```
/// use spineline::measure::alike_remark;
/// let words = alike_remark("subjects", ["s1", "s2", "S1"]).expect("two are alike");
/// assert!(words.starts_with("these subjects have names that differ by capitals and marks alone: S1 and s1;"));
/// ```
#[must_use]
pub fn alike_remark<'a>(what: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let alike = alike_names(names);
    let groups = alike.iter().map(|names| names.join(" and "));
    (!alike.is_empty()).then(|| {
        format!(
            "these {what} have names that differ by capitals and marks alone: {}; each name counts, so write one name for one of the {what}",
            first_named(groups, alike.len())
        )
    })
}

/// The warning about such names of observers.
#[must_use]
pub fn alike_words(names: &[impl AsRef<str>]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{}`", name.as_ref())).collect();
    format!(
        "{} count as {} observers: if they are one person, write one name",
        names.join(" and "),
        names.len()
    )
}
