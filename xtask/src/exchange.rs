//! `cargo xtask exchange`: exported landmarks in the programs that they are exported for.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::{cargo, python};

/// Exports landmarks of phantoms, and reads them with highdicom, pydicom, DCMTK and Python.
pub fn compare(root: &Path) -> Result<(), String> {
    cargo(root, &["build", "--quiet", "--locked", "--package", "spineline-cli"])?;
    provide_dcmtk();
    let script = root.join("validation/exchange/compare.py");
    python::project(root, "exchange", &script, Path::new("debug/spineline"), &[])
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
    if root && works("apt-get", &["install", "--yes", "--no-install-recommends", "dcmtk"]) {
        println!("» apt-get install dcmtk");
        return;
    }
    println!(
        "» no dsrdump: install the package `dcmtk` (as `apt-get install dcmtk`) to let DCMTK read the reports"
    );
}
