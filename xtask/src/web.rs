//! The browser app: built into `web/dist`, which the program embeds, and driven in a real browser.

use std::path::Path;
use std::process::Command;

use crate::checks::built;
use crate::command::run;
use crate::files::{read, write};
use crate::plan::Plan;
use crate::{node, tools};

/// Builds the app.
pub fn build(root: &Path) -> Result<(), String> {
    provide_packages(root)?;
    npm(root, &["run", "--silent", "build"], &[])
}

/// Checks and unit-tests the app.
pub fn check(root: &Path) -> Result<(), String> {
    provide_packages(root)?;
    ["check", "test"].iter().try_for_each(|script| npm(root, &["run", "--silent", script], &[]))
}

/// Drives the app in Chromium, with all tests.
pub fn browser(plan: &Plan<'_>) -> Result<(), String> {
    drive(plan, &[])
}

/// The same without long tests, which only a full run has.
pub fn browser_in_short(plan: &Plan<'_>) -> Result<(), String> {
    drive(plan, if plan.is_full() { &[] } else { &["--", "--grep-invert", "@long"] })
}

fn drive(plan: &Plan<'_>, chosen: &[&str]) -> Result<(), String> {
    if !plan.root.join("web/dist/index.html").exists() {
        build(plan.root)?;
    }
    provide_packages(plan.root)?;
    let program = built(plan, "spineline")?;
    let program = program.to_str().ok_or("the target folder's name is not UTF-8")?;
    let arguments = [&["run", "--silent", "e2e"], chosen].concat();
    let found = chromium(plan.root)?;
    let mut variables = vec![("SPINELINE_PROGRAM", program)];
    if let Some([path, libraries]) = &found {
        variables.extend([("CHROMIUM", path.as_str()), ("CHROMIUM_LIBRARIES", libraries)]);
    }
    npm(plan.root, &arguments, &variables)
}

/// The Chromium of npm and the folder of its libraries, if the machine has no Chromium.
fn chromium(root: &Path) -> Result<Option<[String; 2]>, String> {
    if tools::has_chromium() {
        return Ok(None);
    }
    let folder = root.join("web/chromium");
    install(&folder)?;
    let mut node = Command::new("node");
    let output = node.arg("executable.mjs").current_dir(&folder).output();
    let output = output.map_err(|error| format!("node: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let mut lines = text.lines().map(str::to_owned);
    match (output.status.success(), lines.next(), lines.next()) {
        (true, Some(path), Some(libraries)) => Ok(Some([path, libraries])),
        _ => Err(format!("Chromium of npm: {}", String::from_utf8_lossy(&output.stderr))),
    }
}

/// The packages of the app.
pub fn provide_packages(root: &Path) -> Result<(), String> {
    node::check(root)?;
    install(&root.join("web"))
}

/// Installs the packages of a folder, once for each version of its lock file.
fn install(folder: &Path) -> Result<(), String> {
    let wanted = read(&folder.join("package-lock.json"))?;
    let stamp = folder.join("node_modules/spineline.stamp");
    if read(&stamp).is_ok_and(|had| had == wanted) {
        return Ok(());
    }
    let help = "\n  help: npm and once a network are needed";
    run(folder, tools::NPM, &["ci", "--no-audit", "--no-fund"], &[])
        .map_err(|reason| reason + help)?;
    write(&stamp, &wanted)
}

fn npm(root: &Path, arguments: &[&str], variables: &[(&str, &str)]) -> Result<(), String> {
    run(&root.join("web"), tools::NPM, arguments, variables)
}
