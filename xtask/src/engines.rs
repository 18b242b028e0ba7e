//! `cargo xtask engines`: exported models in the engines that they are exported for.

use std::path::Path;

use crate::{cargo, python};

/// Exports models of phantoms, loads them into MuJoCo, Pinocchio and OpenSim, and compares shapes under load.
pub fn compare(root: &Path) -> Result<(), String> {
    cargo(root, &["build", "--quiet", "--locked", "--package", "spineline-cli"])?;
    let script = root.join("validation/engines/compare.py");
    python::project(root, "engines", &script, Path::new("debug/spineline"), &[])
}
