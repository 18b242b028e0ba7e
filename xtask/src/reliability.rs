//! `cargo xtask reliability`: ICC, errors and correlations beside those of an independent statistics package.

use std::path::Path;

use crate::{cargo, python};

/// Assesses random tables of readings with the program and with pingouin and scipy, and compares all numbers.
pub fn compare(root: &Path) -> Result<(), String> {
    cargo(root, &["build", "--quiet", "--locked", "--package", "spineline-cli"])?;
    let script = root.join("validation/reliability/compare.py");
    python::project(root, "reliability", &script, Path::new("debug/spineline"), &[])
}
