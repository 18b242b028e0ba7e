//! House rules that compilers cannot check.

mod circles;
mod documents;
mod faults;
mod imports;
mod order;
mod panics;
mod versions;
mod vocabulary;

use std::path::Path;

use crate::files::{read, sources};

/// Names that the core may not use: files, clock, printing, processes, environment.
const IMPURE: [&str; 9] = [
    "std::fs",
    "std::env",
    "std::net",
    "std::process",
    "std::time",
    "println!",
    "eprintln!",
    "print!",
    "dbg!",
];

/// Crates on which the core may depend.
const CORE_DEPENDENCIES: [&str; 9] = [
    "nalgebra",
    "rand",
    "rand_chacha",
    "rand_distr",
    "schemars",
    "serde",
    "statrs",
    "tdigest",
    "thiserror",
];

/// Files that set the places of a number themselves: the formatter of texts, files for programs, and coordinates of figures.
const WITH_PLACES: [&str; 8] = [
    "crates/spineline/src/number.rs",
    "crates/spineline-films/src/write.rs",
    "crates/spineline-landmarks/src/sr/item.rs",
    "crates/spineline-report/src/figures/arrows.rs",
    "crates/spineline-report/src/figures/page.rs",
    "crates/spineline-report/src/figures/panel.rs",
    "crates/spineline-report/src/figures/style.rs",
    "crates/spineline-tables/src/table.rs",
];

/// A longer file contains more than one idea.
const MAX_LINES: usize = 500;

pub fn run(root: &Path) -> Result<(), String> {
    let mut faults = Vec::new();
    let core = root.join("crates/spineline/src");
    for file in sources(&core)? {
        check_purity(&core, &file, &mut faults)?;
    }
    check_parameters(root, &mut faults)?;
    check_places(root, &mut faults)?;
    order::check(root, &mut faults)?;
    panics::check(root, &mut faults)?;
    versions::check(root, &mut faults)?;
    check_core_dependencies(root, &mut faults)?;
    let folders = ["benchmarks", "crates", "fuzz/fuzz_targets", "xtask", "web/src", "web/e2e"];
    for folder in folders {
        for file in sources(&root.join(folder))? {
            check_length(root, &file, &mut faults)?;
        }
    }
    documents::check(root, &mut faults)?;
    vocabulary::check(root, &mut faults)?;
    faults::check(root, &mut faults)?;
    if faults.is_empty() {
        println!("» tidy");
        return Ok(());
    }
    Err(format!("house rules do not hold:\n  {}", faults.join("\n  ")))
}

/// The core is pure, except for its tests beside the code.
fn check_purity(core: &Path, file: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let inside = file.strip_prefix(core).map_err(|error| error.to_string())?;
    for (number, line) in read(file)?.lines().enumerate() {
        let code = line.split("//").next().unwrap_or_default();
        for word in IMPURE.iter().filter(|word| code.contains(**word)) {
            let place = format!("{}:{}", inside.display(), number + 1);
            faults.push(format!("{place}: the core is pure, and `{word}` is not"));
        }
    }
    Ok(())
}

/// A parameter is one thing: a tuple of several needs a type with a name.
fn check_parameters(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let found = places_of(root, has_tuple_parameter)?;
    faults.extend(found.iter().map(|(place, number)| {
        format!(
            "{place}:{number}: a parameter is taken apart as a tuple: give its parts, or name a type"
        )
    }));
    Ok(())
}

/// File and number of every line of code in the crates that has a fault. Tests are free.
fn places_of(root: &Path, has_fault: fn(&str) -> bool) -> Result<Vec<(String, usize)>, String> {
    let mut found = Vec::new();
    for file in sources(&root.join("crates"))? {
        let place = file.strip_prefix(root).unwrap_or(&file).display().to_string();
        if !place.contains("/src/") || place.ends_with("/tests.rs") {
            continue;
        }
        let text = read(&file)?;
        let is_code = |line: &str| !line.trim_start().starts_with("//");
        for (number, line) in imports::without_tests(&text).lines().enumerate() {
            if is_code(line) && has_fault(line) {
                found.push((place.clone(), number + 1));
            }
        }
    }
    Ok(found)
}

/// Whether a formatted line of a signature destructures a parameter, as `(a, b): (A, B)`; closures and conversions may.
fn has_tuple_parameter(line: &str) -> bool {
    let code = line.trim_start();
    let is_name = |c: char| c.is_alphanumeric() || "_, &".contains(c);
    let is_pattern = |(at, _): (usize, &str)| {
        let inside = code[at + 1..].split_once("): ");
        inside.is_some_and(|(names, rest)| {
            let is_tuple = rest.trim_start_matches('&').starts_with('(');
            is_tuple && names.contains(',') && names.chars().all(is_name)
        })
    };
    let is_signature = code.starts_with('(') || code.contains("fn ");
    is_signature
        && !code.contains("fn from(")
        && !code.contains('|')
        && code.match_indices('(').any(is_pattern)
}

/// A number in a text for people goes through the one formatter.
fn check_places(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let mut found = places_of(root, has_places)?;
    for listed in WITH_PLACES.iter().filter(|listed| found.iter().all(|one| one.0 != **listed)) {
        faults.push(format!("{listed}: it sets no places of a number, and `WITH_PLACES` lists it"));
    }
    found.retain(|(place, _)| !WITH_PLACES.contains(&place.as_str()));
    faults.extend(found.iter().map(|(place, number)| {
        format!(
            "{place}:{number}: write the number by `spineline::number`, an angle by `Angle::text`"
        )
    }));
    Ok(())
}

/// Whether a line has a format with a precision, such as `{x:.1}`, `{:>8.2}`, `{:.*}` and `{x:.places$}`.
fn has_places(line: &str) -> bool {
    let is_name = |text: &str| text.chars().all(|c| c.is_alphanumeric() || c == '_');
    let formats = line.split('{').skip(1).filter_map(|tail| tail.split_once('}'));
    let mut parts = formats.filter_map(|(format, _)| format.split_once(':'));
    parts.any(|(name, format)| {
        let places = format.split_once('.').map_or("", |(_, places)| places);
        let places = places.trim_end_matches(['e', '?']);
        let is_count = !places.is_empty() && is_name(places.trim_end_matches('$'));
        is_name(name) && (places == "*" || is_count)
    })
}

fn check_core_dependencies(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let manifest = read(&root.join("crates/spineline/Cargo.toml"))?;
    let section = manifest.split("[dependencies]").nth(1).unwrap_or_default();
    let lines = section.lines().skip(1).take_while(|line| !line.starts_with('['));
    for line in lines.filter(|line| !line.trim().is_empty() && !line.starts_with('#')) {
        let name = line.split(['.', ' ', '=']).next().unwrap_or_default();
        if !CORE_DEPENDENCIES.contains(&name) {
            faults.push(format!("the core depends on `{name}`, which it should not know"));
        }
    }
    Ok(())
}

fn check_length(root: &Path, file: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let lines = read(file)?.lines().count();
    if lines > MAX_LINES {
        let place = file.strip_prefix(root).unwrap_or(file);
        faults.push(format!("{}: {lines} lines, and the limit is {MAX_LINES}", place.display()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{has_places, has_tuple_parameter};

    #[test]
    fn a_precision_is_found_in_formats_only() {
        let found = [
            r#"format!("{x:.1} mm")"#,
            r#"format!("{{{:>8.2}}}", x)"#,
            r#"write!(f, "{:+.*}°", places, x)"#,
            r#""{level}: {x:.places$}","#,
            r#"format!("{:.1e}", x)"#,
            r#""{0:.3?}""#,
        ];
        assert!(found.iter().all(|line| has_places(line)));
        let others = [
            r#"format!("{x} of {} in {:>8}.", all.len(), fixed(x, 1))"#,
            "let Point { x: a.x, y } = point;",
            "use spineline::{anatomy::Side, spatial::Angle};",
            r#"let json = "{\"n\":1.5}";"#,
            r#"format!("{tolerance:e}. {name:?}.")"#,
        ];
        assert!(!others.iter().any(|line| has_places(line)));
    }

    #[test]
    fn a_tuple_is_found_in_signatures_only() {
        let found = ["    (a, b): (A, B),", "fn f((a, _): &(A, B), c: C) {"];
        assert!(found.iter().all(|line| has_tuple_parameter(line)));
        let others = [
            "let (a, b): (A, B) = c;",
            "    pair: (A, B),",
            "fn f(a: A, b: (B, C)) -> D {",
            "let f = |(a, b): (A, B)| a;",
            "fn from((a, b): (A, B)) -> Self {",
            "fn f((a, b): Pair) -> A {",
        ];
        assert!(!others.iter().any(|line| has_tuple_parameter(line)));
    }
}
