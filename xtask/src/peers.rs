//! `cargo xtask peers`: Spineline's times beside those of other engines on the same cases.

use std::env::consts::EXE_SUFFIX;
use std::path::Path;

use crate::{cargo, python, run};

/// Builds Spineline's program, makes the Python environment, runs every engine and prints the tables.
pub fn compare(root: &Path, passed_on: &[String]) -> Result<(), String> {
    cargo(root, &["build", "--quiet", "--release", "--locked", "--package", "spineline-peers"])?;
    let project = root.join("benchmarks/peers");
    let interpreter = python::environment(root, "peers", &project.join("requirements.txt"))?;
    let target = python::target()?;
    let program = target.join("release").join(format!("spineline-peers{EXE_SUFFIX}"));
    let own = [
        python::text(&project.join("run.py"))?,
        "--program".to_owned(),
        python::text(&program)?,
        "--out".to_owned(),
        python::text(&target.join("peers"))?,
    ];
    let arguments: Vec<&str> = own.iter().chain(passed_on).map(String::as_str).collect();
    let quiet = [("PYTHONDONTWRITEBYTECODE", "1")];
    run(root, &python::text(&interpreter)?, &arguments, &quiet)
}
