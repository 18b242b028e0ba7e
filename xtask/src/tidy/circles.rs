//! Which source file of a crate uses which other, through re-exports, outside of tests. A name that a file hands on from its own
//! modules does not count as its use.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::files::{read, sources};

use super::imports::{Import, child_paths, code_of, imports, module_of, named_paths};

/// Which module or file uses which, with a file that does.
pub type Uses = BTreeMap<String, BTreeMap<String, String>>;

/// Re-exports that are followed to the file of an item.
const MOST_STEPS: usize = 8;

/// The files of a crate by their modules, with what decides which file a path means.
type Files = BTreeMap<Vec<String>, SourceFile>;

struct SourceFile {
    /// Its path below `src`.
    inside: String,
    items: BTreeSet<String>,
    imports: Vec<Import>,
    /// Paths from the root that it names, without what it only hands on from its own modules.
    named: BTreeSet<Vec<String>>,
}

/// The uses between the files below a `src` folder.
pub fn uses_of_files(source: &Path) -> Result<Uses, String> {
    let mut texts = BTreeMap::new();
    for file in sources(source)?.iter().filter(|file| file.extension().is_some_and(|e| e == "rs")) {
        let inside = file.strip_prefix(source).unwrap_or(file).display().to_string();
        // A library stands before the program of its crate.
        texts.entry(module_of(source, file)).or_insert((inside, read(file)?));
    }
    Ok(uses_in(&texts))
}

/// The uses between files, given by module: path and text.
fn uses_in(texts: &BTreeMap<Vec<String>, (String, String)>) -> Uses {
    let modules: BTreeSet<Vec<String>> = texts.keys().cloned().collect();
    let file = |(module, (inside, text)): (&Vec<String>, &(String, String))| {
        let imports = imports(module, &modules, text);
        let is_handed_on = |path: &Vec<String>| {
            let handed = imports.iter().any(|one| one.is_public && one.path == *path);
            handed && path.starts_with(module)
        };
        let mut named = named_paths(module, text);
        named.extend(imports.iter().map(|one| one.path.clone()));
        named.retain(|path| !is_handed_on(path));
        named.extend(child_paths(module, &modules, text));
        let file = SourceFile { inside: inside.clone(), items: items(text), imports, named };
        (module.clone(), file)
    };
    let files: Files = texts.iter().map(file).collect();
    let mut uses = Uses::new();
    for (module, file) in &files {
        for path in &file.named {
            let used = file_of(&files, path, MOST_STEPS);
            if let Some(used) = used.filter(|used| used != module) {
                let own = uses.entry(file.inside.clone()).or_default();
                own.insert(files[&used].inside.clone(), file.inside.clone());
            }
        }
    }
    uses
}

/// The module of the file that defines what a path names.
fn file_of(files: &Files, path: &[String], steps: usize) -> Option<Vec<String>> {
    let length = (0..=path.len()).rev().find(|&length| files.contains_key(&path[..length]))?;
    let (module, rest) = path.split_at(length);
    let Some(name) = rest.first() else { return Some(module.to_vec()) };
    let file = &files[module];
    let is_it = |one: &&Import| one.path.last() == Some(name) && one.path != path;
    let handed_on = file.imports.iter().find(is_it).filter(|_| !file.items.contains(name));
    match handed_on.filter(|_| steps > 0) {
        Some(import) => file_of(files, &import.path, steps - 1),
        None => Some(module.to_vec()),
    }
}

/// Names that a file defines.
fn items(text: &str) -> BTreeSet<String> {
    const KEYWORDS: [&str; 8] =
        ["fn", "struct", "enum", "trait", "type", "const", "static", "macro_rules!"];
    let code = code_of(text);
    let words: Vec<&str> = code.split_whitespace().collect();
    let pairs = words.windows(2).filter(|pair| KEYWORDS.contains(&pair[0]));
    let name = |word: &str| word.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    pairs.map(|pair| name(pair[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uses(files: &[(&str, &str)]) -> Vec<String> {
        let module = |name: &str| match name {
            "lib" => Vec::new(),
            name => name.split('/').filter(|part| *part != "mod").map(str::to_owned).collect(),
        };
        let text =
            |&(name, text): &(&str, &str)| (module(name), (name.to_owned(), text.to_owned()));
        let found = uses_in(&files.iter().map(text).collect());
        let pairs = found.iter().flat_map(|(file, used)| used.keys().map(move |u| (file, u)));
        pairs.map(|(file, used)| format!("{file} → {used}")).collect()
    }

    #[test]
    fn a_name_leads_to_the_file_that_defines_it() {
        let found = uses(&[
            ("lib", "mod a;\nmod b;\npub use a::{One, Two};"),
            ("a/mod", "mod x;\nmod y;\npub use x::One;\npub struct Two;"),
            ("a/x", "pub struct One;\n// use crate::b::Three;"),
            ("a/y", "use super::{One, Two};\n#[cfg(test)]\nmod tests { use crate::b::Three; }"),
            ("b", "use crate::One;\npub struct Three;"),
        ]);
        assert_eq!(found, ["a/y → a/mod", "a/y → a/x", "b → a/x"]);
    }

    #[test]
    fn a_parent_that_calls_its_child_uses_it() {
        let found = uses(&[
            ("a/mod", "mod x;\nmod y;\npub use y::Y;\nfn f() { x::g(); }"),
            ("a/x", "use super::Y;\npub fn g() {}"),
            ("a/y", "pub struct Y;"),
        ]);
        assert_eq!(found, ["a/mod → a/x", "a/x → a/y"]);
    }
}
