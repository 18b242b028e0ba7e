//! `cargo xtask films`: films of phantoms in another program that reads DICOM.

use std::path::Path;

use crate::{cargo, python};

/// Draws films of phantoms, reads them with pydicom, and compares pixels and attributes with what was stated.
pub fn compare(root: &Path) -> Result<(), String> {
    cargo(root, &["build", "--quiet", "--locked", "--package", "spineline-cli"])?;
    let script = root.join("validation/films/compare.py");
    python::project(root, "films", &script, Path::new("debug/spineline"), &[])
}
