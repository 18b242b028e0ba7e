//! `cargo xtask quick`: quick checks of the changed parts.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use crate::checks::{self, QuickTests};
use crate::files::read;
use crate::plan::{Extent, Plan, Step};
use crate::tidy;

/// Checks the differences from a revision, including untracked files.
pub fn run(root: &Path, base: &str) -> Result<(), String> {
    let mut files = git(root, &["diff", "--name-only", base])?;
    files.extend(git(root, &["ls-files", "--others", "--exclude-standard"])?);
    let changed: Vec<String> = crates_of(root, &files)?.into_iter().collect();
    let format = Step::new("format", &[], checks::format);
    let tidy = Step::new("tidy", &[], |plan| tidy::run(plan.root));
    let plan = Plan::new(root, Extent::Usual);
    if changed.is_empty() {
        println!("no crate differs from {base}");
        return plan.run(&[format, tidy]);
    }
    println!("changed: {}", changed.join(", "));
    let tests = QuickTests::new(&changed)?;
    plan.run(&[
        format.beside(),
        tidy.beside(),
        Step::new("build", &[], |plan| tests.build(plan.root)),
        // The lints of the core alone leave a core of the machine free.
        Step::new("lints", &[], checks::lint).beside(),
        Step::new("tests", &[], |plan| tests.run(plan.root)),
    ])
}

fn git(root: &Path, arguments: &[&str]) -> Result<BTreeSet<String>, String> {
    let output = Command::new("git").args(arguments).current_dir(root).output();
    let output = output.map_err(|error| format!("`git` could not be started: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect())
}

/// Names of the crates that contain these files. The workspace's own files count for the core, on which all depend.
fn crates_of(root: &Path, files: &BTreeSet<String>) -> Result<BTreeSet<String>, String> {
    let mut names = BTreeSet::new();
    for file in files {
        if file == "Cargo.toml" || file == "Cargo.lock" {
            names.insert("spineline".to_owned());
        }
        let folders = Path::new(file).ancestors().skip(1);
        let Some(own) = folders
            .map(|folder| root.join(folder))
            .find(|folder| folder.join("Cargo.toml").exists())
        else {
            continue;
        };
        let manifest = read(&own.join("Cargo.toml"))?;
        let name = manifest.lines().find_map(|line| line.strip_prefix("name = "));
        let is_outside = manifest.contains("[workspace]");
        names.extend(name.filter(|_| !is_outside).map(|name| name.trim_matches('"').to_owned()));
    }
    Ok(names)
}
