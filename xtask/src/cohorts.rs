//! `cargo xtask cohorts`: times of cohorts by the program and by the Python package on Dask.

use std::path::Path;

use crate::{package, python};

/// Builds the wheel, installs it in the environment of its tests, and prints the table.
pub fn compare(root: &Path, passed_on: &[String]) -> Result<(), String> {
    let interpreter = package::with_wheel(root)?;
    let script = root.join("benchmarks/cohorts/run.py");
    let program = Path::new("release/spineline");
    python::script(root, &interpreter, "cohorts", &script, program, passed_on)
}
