//! The program beside programs of others: each check is a Python project below `validation/`.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::{cargo, python};

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

/// Exported landmarks in highdicom, pydicom and DCMTK: every point.
pub fn exchange(root: &Path) -> Result<(), String> {
    provide_dcmtk();
    compare(root, "exchange")
}

fn compare(root: &Path, name: &str) -> Result<(), String> {
    cargo(root, &["build", "--quiet", "--locked", "--package", "spineline-cli"])?;
    let script = root.join("validation").join(name).join("compare.py");
    python::project(root, name, &script, Path::new("debug/spineline"), &[])
}

/// DCMTK reads reports too. It is a package of the system; where it may not be installed, the others read them alone.
fn provide_dcmtk() {
    let works = |program: &str, arguments: &[&str]| {
        let quiet = Command::new(program)
            .args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        quiet.is_ok_and(|status| status.success())
    };
    if works("dsrdump", &["--version"]) {
        return;
    }
    let root = Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout == b"0\n");
    let install = ["install", "--yes", "--no-install-recommends", "dcmtk"];
    if root
        && (works("apt-get", &install)
            || works("apt-get", &["update"]) && works("apt-get", &install))
    {
        println!("» apt-get install dcmtk");
        return;
    }
    println!(
        "» no dsrdump: install the package `dcmtk` (as `apt-get install dcmtk`) to let DCMTK read the reports"
    );
}
