//! The browser app: built into `web/dist`, which the program embeds, and driven in a real browser.

use std::fs;
use std::path::Path;

use crate::{built, debian, run};

/// Checks, unit-tests and builds the app.
pub fn build(root: &Path) -> Result<(), String> {
    provide_packages(root)?;
    for script in ["check", "test", "build"] {
        npm(root, &["run", "--silent", script], &[])?;
    }
    Ok(())
}

/// Drives the app in Chromium as a person does.
pub fn browser(root: &Path) -> Result<(), String> {
    if !root.join("web/dist/index.html").exists() {
        build(root)?;
    }
    provide_packages(root)?;
    if !debian::provide("chromium", "chromium") {
        return Err("no Chromium\n  help: install the package `chromium`".to_owned());
    }
    let program = built(root, "spineline")?;
    let program = program.to_str().ok_or("the target folder's name is not UTF-8")?;
    npm(root, &["run", "--silent", "e2e"], &[("SPINELINE_PROGRAM", program)])
}

/// What the lock file names, installed once for each of its versions.
fn provide_packages(root: &Path) -> Result<(), String> {
    let web = root.join("web");
    let read = |path: &Path| fs::read_to_string(path);
    let lock = web.join("package-lock.json");
    let wanted = read(&lock).map_err(|error| format!("{}: {error}", lock.display()))?;
    let stamp = web.join("node_modules/spineline.stamp");
    if read(&stamp).is_ok_and(|had| had == wanted) {
        return Ok(());
    }
    let help = "\n  help: Node 20 with npm, and once a network, are needed";
    npm(root, &["ci", "--no-audit", "--no-fund"], &[]).map_err(|reason| reason + help)?;
    fs::write(&stamp, wanted).map_err(|error| format!("{}: {error}", stamp.display()))
}

fn npm(root: &Path, arguments: &[&str], variables: &[(&str, &str)]) -> Result<(), String> {
    let program = if cfg!(windows) { "npm.cmd" } else { "npm" };
    run(&root.join("web"), program, arguments, variables)
}
