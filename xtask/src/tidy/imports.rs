//! The modules of its crate that a source file names, read from its text.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The module of a file, as names from the crate's root; empty for the root itself.
pub fn module_of(source: &Path, file: &Path) -> Vec<String> {
    let inside = file.strip_prefix(source).unwrap_or(file).with_extension("");
    let mut names: Vec<String> =
        inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|last| last == "mod" || last == "lib" || last == "main") {
        names.pop();
    }
    names
}

/// Paths from the crate's root that a file names by `crate::` or `super::`, without tests at its end.
pub fn named_paths(module: &[String], text: &str) -> BTreeSet<Vec<String>> {
    let code = code_of(text);
    let mut found = BTreeSet::new();
    for (place, _) in code.match_indices("crate::") {
        let before = code[..place].chars().next_back();
        // `$crate::` and `my_crate::` are different.
        if before.is_none_or(|c| !c.is_alphanumeric() && c != '_' && c != '$') {
            expand(&code[place + "crate::".len()..], Vec::new(), &mut found);
        }
    }
    for (place, _) in code.match_indices("super::") {
        // A path follows, and in a text nothing does.
        let is_text = code[place + "super::".len()..].starts_with('"');
        if is_text || code[..place].ends_with("super::") {
            continue;
        }
        let mut rest = &code[place..];
        let mut base = module.to_vec();
        while let Some(after) = rest.strip_prefix("super::") {
            base.pop();
            rest = after;
        }
        expand(rest, base, &mut found);
    }
    found
}

/// Names that the crate's root re-exports, each with its module.
pub fn handed_on(root: &str) -> BTreeMap<String, String> {
    let code = without_comments(root);
    let mut names = BTreeMap::new();
    for statement in code.split("pub use ").skip(1) {
        let statement = statement.split(';').next().unwrap_or_default();
        let mut paths = BTreeSet::new();
        expand(statement, Vec::new(), &mut paths);
        for path in paths {
            if let [module, .., name] = &path[..] {
                names.insert(name.clone(), module.clone());
            }
        }
    }
    names
}

/// The text of a file, without tests at its end.
pub fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]\nmod ").next().unwrap_or_default()
}

/// The code of a file, without comments and without tests at its end.
pub fn code_of(text: &str) -> String {
    without_comments(without_tests(text))
}

/// One name that a file imports.
pub struct Import {
    /// Its path from the crate's root.
    pub path: Vec<String>,
    /// Whether the file hands it on.
    pub is_public: bool,
}

/// All names of the own crate that a file imports by `use`.
pub fn imports(module: &[String], modules: &BTreeSet<Vec<String>>, text: &str) -> Vec<Import> {
    let code = code_of(text);
    let mut found = Vec::new();
    for Statement { is_public, names, .. } in use_statements(&code) {
        let mut paths = BTreeSet::new();
        expand(names, Vec::new(), &mut paths);
        let paths = paths.into_iter().filter_map(|path| from_root(module, modules, path));
        found.extend(paths.map(|path| Import { path, is_public }));
    }
    found
}

/// Paths from the crate's root that begin with a child of the file's module, outside of `use`.
pub fn child_paths(
    module: &[String],
    modules: &BTreeSet<Vec<String>>,
    text: &str,
) -> BTreeSet<Vec<String>> {
    let mut code = code_of(text);
    let statements: Vec<_> =
        use_statements(&code).map(|one| one.place..one.place + one.names.len()).collect();
    for statement in statements.into_iter().rev() {
        code.replace_range(statement, "");
    }
    let is_of_path = |c: char| c.is_alphanumeric() || "_:.$".contains(c);
    let words = code.split(|c| !is_of_path(c)).filter(|word| word.contains("::"));
    let paths = words.map(|word| word.split("::").map(str::to_owned).collect::<Vec<_>>());
    let of_child = paths.filter(|path| modules.contains(&[module, &path[..1]].concat()));
    of_child.map(|path| [module, &path[..]].concat()).collect()
}

/// A `use` statement of a code.
struct Statement<'a> {
    /// Where its names begin.
    place: usize,
    is_public: bool,
    names: &'a str,
}

fn use_statements(code: &str) -> impl Iterator<Item = Statement<'_>> {
    code.match_indices("use ").filter_map(|(start, word)| {
        let line = code[..start].rsplit('\n').next().unwrap_or_default().trim();
        let is_public = line == "pub" || line.starts_with("pub(") && line.ends_with(')');
        let place = start + word.len();
        let names = code[place..].split(';').next().unwrap_or_default();
        (line.is_empty() || is_public).then_some(Statement { place, is_public, names })
    })
}

/// A path from the crate's root; `None` if it is of another crate.
fn from_root(
    module: &[String],
    modules: &BTreeSet<Vec<String>>,
    mut path: Vec<String>,
) -> Option<Vec<String>> {
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let mut base = match &path[0][..] {
        "crate" => Vec::new(),
        "self" | "super" => module.to_vec(),
        _ if modules.contains(&[module, &path[..1]].concat()) => {
            return Some([module, &path[..]].concat());
        }
        _ => return None,
    };
    let steps = path.iter().take_while(|part| matches!(&part[..], "crate" | "self" | "super"));
    let (steps, ups) =
        steps.fold((0, 0), |(steps, ups), part| (steps + 1, ups + usize::from(part == "super")));
    base.truncate(base.len().saturating_sub(ups));
    base.extend_from_slice(&path[steps..]);
    Some(base)
}

fn without_comments(text: &str) -> String {
    text.lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join("\n")
}

/// All paths of `a::{b, c::d}` behind a base.
fn expand(text: &str, base: Vec<String>, found: &mut BTreeSet<Vec<String>>) {
    let text = text.trim_start();
    if let Some(group) = text.strip_prefix('{') {
        for part in parts(group) {
            expand(part, base.clone(), found);
        }
        return;
    }
    let name: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    if name.is_empty() {
        if !base.is_empty() {
            found.insert(base);
        }
        return;
    }
    let mut path = base;
    let rest = &text[name.len()..];
    path.push(name);
    match rest.strip_prefix("::") {
        Some(rest) => expand(rest, path, found),
        None => {
            found.insert(path);
        }
    }
}

/// The parts of a group up to its closing brace.
fn parts(group: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0_usize, 0, Vec::new());
    for (place, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => {
                parts.push(&group[start..place]);
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&group[start..place]);
                start = place + 1;
            }
            _ => {}
        }
    }
    parts.retain(|part| !part.trim().is_empty());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(module: &[&str], text: &str) -> Vec<String> {
        let module: Vec<String> = module.iter().map(|&name| name.to_owned()).collect();
        named_paths(&module, text).iter().map(|path| path.join("::")).collect()
    }

    #[test]
    fn groups_parents_and_tests_are_read() {
        let text = "use crate::{a::{B, c::D}, e};\nuse super::super::f::G;\nuse super::h;\n\
                    // use crate::comment;\n#[cfg(test)]\nmod tests { use crate::test; }";
        assert_eq!(paths(&["x", "y"], text), ["a::B", "a::c::D", "e", "f::G", "x::h"]);
    }

    #[test]
    fn names_that_the_root_re_exports_have_their_module() {
        let names = handed_on("pub use a::{B, c::D};\npub use e::F;");
        assert_eq!(names["D"], "a");
        assert_eq!(names["F"], "e");
    }
}
