//! `cargo xtask engines`: exported models in the engines that they are exported for.

use std::env::consts::EXE_SUFFIX;
use std::path::Path;

use crate::{cargo, python, run};

/// Exports models of phantoms, loads them into MuJoCo, Pinocchio and OpenSim, and compares shapes under load.
pub fn compare(root: &Path) -> Result<(), String> {
    cargo(root, &["build", "--quiet", "--locked", "--package", "spineline-cli"])?;
    let project = root.join("validation/engines");
    let interpreter = python::environment(root, "engines", &project.join("requirements.txt"))?;
    let target = python::target()?;
    let program = target.join("debug").join(format!("spineline{EXE_SUFFIX}"));
    let arguments = [
        python::text(&project.join("compare.py"))?,
        "--program".to_owned(),
        python::text(&program)?,
        "--out".to_owned(),
        python::text(&target.join("engines"))?,
    ];
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let quiet = [("PYTHONDONTWRITEBYTECODE", "1")];
    run(root, &python::text(&interpreter)?, &arguments, &quiet)
}
