//! The program beside programs of others: each check is a Python project below `validation/`.

use std::path::{Path, PathBuf};

use crate::checks::built;
use crate::plan::Plan;
use crate::{notebooks, package, python};

/// Exported models in MuJoCo, Pinocchio and OpenSim: shapes under load.
pub fn engines(plan: &Plan<'_>) -> Result<(), String> {
    compare(plan, "engines")
}

/// Random tables of readings in pingouin and scipy: every statistic.
pub fn reliability(plan: &Plan<'_>) -> Result<(), String> {
    compare(plan, "reliability")
}

/// Films of phantoms in pydicom: pixels and attributes.
pub fn films(plan: &Plan<'_>) -> Result<(), String> {
    compare(plan, "films")
}

/// Exported landmarks in highdicom, pydicom and DCMTK: every point; tables in pyarrow and pandas: every value; typeset
/// reports in qpdf.
pub fn exchange(plan: &Plan<'_>) -> Result<(), String> {
    let full = Plan::new(plan.root, crate::plan::Extent::Full);
    compare(&full, "exchange")
}

/// Damaged files, bombs, full disks, interruptions and kills: how every run of the program ends.
pub fn attack(plan: &Plan<'_>) -> Result<(), String> {
    let seeds = built(plan, "examples/seeds")?;
    let seeds = seeds.to_str().ok_or("the target folder's name is not UTF-8")?;
    let passed_on = ["--seeds".to_owned(), seeds.to_owned()];
    let script = project(plan.root, "attack").join("attack.py");
    python::project(plan.root, "attack", &script, Path::new("debug/spineline"), &passed_on)
}

/// Makes the Python environments of all checks.
pub fn provide_environments(root: &Path) -> Result<(), String> {
    for name in ["engines", "reliability", "films", "exchange", "attack"] {
        python::environment(root, name, &project(root, name).join("requirements.txt"))?;
    }
    package::environment(root)?;
    notebooks::environment(root).map(|_| ())
}

fn project(root: &Path, name: &str) -> PathBuf {
    root.join("validation").join(name)
}

fn compare(plan: &Plan<'_>, name: &str) -> Result<(), String> {
    built(plan, "spineline")?;
    let script = project(plan.root, name).join("compare.py");
    python::project(plan.root, name, &script, Path::new("debug/spineline"), &[])
}
