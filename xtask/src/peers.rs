//! `cargo xtask peers`: Spineline's times beside other engines' on the same cases.

use std::path::Path;

use crate::command::cargo;
use crate::python;

/// Builds Spineline's program, makes the Python environment, runs every engine and prints the tables.
pub fn compare(root: &Path, passed_on: &[String]) -> Result<(), String> {
    cargo(root, &["build", "--quiet", "--release", "--locked", "--package", "spineline-peers"])?;
    let script = root.join("benchmarks/peers/run.py");
    python::project(root, "peers", &script, Path::new("release/spineline-peers"), passed_on)
}
