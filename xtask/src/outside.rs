//! The program beside programs of others: each check is a Python project below `validation/`.

use std::path::Path;

use crate::{built, debian, python};

/// Exported models in MuJoCo, Pinocchio and OpenSim: shapes under load.
pub fn engines(root: &Path) -> Result<(), String> {
    compare(root, "engines")
}

/// Random tables of readings in pingouin and scipy: every statistic.
pub fn reliability(root: &Path) -> Result<(), String> {
    compare(root, "reliability")
}

/// Films of phantoms in pydicom: pixels and attributes.
pub fn films(root: &Path) -> Result<(), String> {
    compare(root, "films")
}

/// Exported landmarks in highdicom, pydicom and DCMTK: every point; tables in pyarrow and pandas: every value; typeset
/// reports in qpdf.
pub fn exchange(root: &Path) -> Result<(), String> {
    provide_dcmtk();
    compare(root, "exchange")
}

fn compare(root: &Path, name: &str) -> Result<(), String> {
    built(root, "spineline")?;
    let script = root.join("validation").join(name).join("compare.py");
    python::project(root, name, &script, Path::new("debug/spineline"), &[])
}

/// DCMTK reads reports too; where it may not be installed, the others read them alone.
fn provide_dcmtk() {
    if !debian::provide("dsrdump", "dcmtk") {
        println!(
            "» no dsrdump: install the package `dcmtk` (as `apt-get install dcmtk`) to let DCMTK read the reports"
        );
    }
}
