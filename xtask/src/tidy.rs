//! House rules that no compiler knows.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules of the core; each uses only those before it.
const MODULES: [&str; 19] = [
    "anatomy",
    "spatial",
    "warning",
    "measure",
    "reliability",
    "curve",
    "clinical",
    "chain",
    "motion",
    "action",
    "multibody",
    "response",
    "personalize",
    "evaluate",
    "hypothesis",
    "error",
    "analysis",
    "uncertainty",
    "cohort",
];

/// What the core may not touch: files, clock, printing, processes, environment.
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

/// Crates on which the core may stand.
const CORE_DEPENDENCIES: [&str; 7] =
    ["nalgebra", "rand", "rand_chacha", "rand_distr", "statrs", "tdigest", "thiserror"];

/// A file that is longer holds more than one idea.
const LONGEST_FILE: usize = 500;

pub fn run(root: &Path) -> Result<(), String> {
    let mut faults = Vec::new();
    let core = root.join("crates/spineline/src");
    for file in sources(&core)? {
        check_core_file(&core, &file, &mut faults)?;
    }
    check_core_dependencies(root, &mut faults)?;
    let folders = ["benchmarks", "crates", "fuzz/fuzz_targets", "xtask", "web/src", "web/e2e"];
    for folder in folders {
        for file in sources(&root.join(folder))? {
            check_length(root, &file, &mut faults)?;
        }
    }
    check_changelog(root, &mut faults)?;
    if faults.is_empty() {
        println!("» tidy");
        return Ok(());
    }
    Err(format!("house rules do not hold:\n  {}", faults.join("\n  ")))
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// Kinds of files that people write.
const WRITTEN: [&str; 4] = ["rs", "ts", "svelte", "css"];

/// All source files below a folder, in order.
fn sources(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let entries =
            fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        for entry in entries {
            let path = entry.map_err(|error| error.to_string())?.path();
            if path.is_dir() {
                folders.push(path);
            } else if is_written(&path) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

fn is_written(path: &Path) -> bool {
    let written = |end: &str| WRITTEN.contains(&end) && !path.ends_with("schema.d.ts");
    path.extension().and_then(|end| end.to_str()).is_some_and(written)
}

fn check_core_file(core: &Path, file: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let inside = file.strip_prefix(core).map_err(|error| error.to_string())?;
    let name =
        inside.components().next().map(|c| c.as_os_str().to_string_lossy().replace(".rs", ""));
    let Some(own) = name.and_then(|name| MODULES.iter().position(|module| *module == name)) else {
        if inside != Path::new("lib.rs") {
            faults.push(format!("{}: a module that the order does not know", inside.display()));
        }
        return Ok(());
    };
    for (number, line) in read(file)?.lines().enumerate() {
        let place = || format!("{}:{}", inside.display(), number + 1);
        let code = line.split("//").next().unwrap_or_default();
        for word in IMPURE.iter().filter(|word| code.contains(**word)) {
            faults.push(format!("{}: the core is pure, and `{word}` is not", place()));
        }
        for used in code.split("crate::").skip(1) {
            let used: String =
                used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let later =
                MODULES.iter().position(|module| *module == used).is_some_and(|other| other > own);
            if later {
                faults.push(format!(
                    "{}: `{}` uses `{used}`, which comes after it",
                    place(),
                    MODULES[own]
                ));
            }
        }
    }
    Ok(())
}

fn check_core_dependencies(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let manifest = read(&root.join("crates/spineline/Cargo.toml"))?;
    let section = manifest.split("[dependencies]").nth(1).unwrap_or_default();
    let lines = section.lines().skip(1).take_while(|line| !line.starts_with('['));
    for line in lines.filter(|line| !line.trim().is_empty()) {
        let name = line.split(['.', ' ', '=']).next().unwrap_or_default();
        if !CORE_DEPENDENCIES.contains(&name) {
            faults.push(format!("the core depends on `{name}`, which it should not know"));
        }
    }
    Ok(())
}

fn check_length(root: &Path, file: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    let lines = read(file)?.lines().count();
    if lines > LONGEST_FILE {
        let place = file.strip_prefix(root).unwrap_or(file);
        faults.push(format!("{}: {lines} lines, and the limit is {LONGEST_FILE}", place.display()));
    }
    Ok(())
}

fn check_changelog(root: &Path, faults: &mut Vec<String>) -> Result<(), String> {
    if !read(&root.join("CHANGELOG.md"))?.contains("### Results") {
        faults.push("CHANGELOG.md: no `### Results` heading".to_owned());
    }
    Ok(())
}
