//! Comparisons of the program with other programs: each is a Python project below `validation/`.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::thread;

use crate::checks::built;
use crate::plan::{Extent, Plan};
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
/// reports in qpdf; vertebral bodies in VTK.
pub fn exchange(plan: &Plan<'_>) -> Result<(), String> {
    let full = Plan::new(plan.root, Extent::Full);
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

/// Completed and detected landmarks on X-rays of patients that the models were not learned from; their data are not in
/// the project.
pub fn landmarks(plan: &Plan<'_>) -> Result<(), String> {
    let data = std::env::var("SPINELINE_DATA")
        .map_err(|_| "the variable SPINELINE_DATA must name the folder that holds `aasce`")?;
    let complete = python::text(&built(plan, "examples/complete")?)?;
    let data = python::text(&Path::new(&data).join("aasce"))?;
    let passed_on = ["--data".to_owned(), data, "--complete".to_owned(), complete];
    let script = project(plan.root, "landmarks").join("compare.py");
    python::project(plan.root, "landmarks", &script, Path::new("debug/spineline"), &passed_on)
}

/// Makes the Python environments of the checks of a plan, two at a time: each uses network, disk and half a core.
pub fn provide_environments(plan: &Plan<'_>) -> Result<(), String> {
    let root = plan.root;
    let projects: &[&str] = match plan.extent {
        Extent::Usual => &["engines", "reliability", "films"],
        Extent::Full => &["engines", "reliability", "films", "exchange", "attack"],
    };
    let own = projects.iter().map(|name| -> Provide<'_> {
        Box::new(|| {
            let requirements = project(root, name).join("requirements.txt");
            python::environment(root, name, &requirements).map(drop)
        })
    });
    let notebooks = plan
        .is_full()
        .then(|| -> Provide<'_> { Box::new(|| notebooks::environment(root).map(drop)) });
    let package: Provide<'_> = Box::new(|| package::environment(root).map(drop));
    // The last one is the largest and starts first.
    let waiting = Mutex::new(own.chain(notebooks).chain([package]).collect::<Vec<_>>());
    let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).pop();
    let work = || std::iter::from_fn(next).try_for_each(|make| make());
    thread::scope(|scope| {
        let beside = scope.spawn(work);
        let own = work();
        beside.join().expect("it returns its faults").and(own)
    })
}

/// What makes one environment.
type Provide<'a> = Box<dyn FnOnce() -> Result<(), String> + Send + 'a>;

fn project(root: &Path, name: &str) -> PathBuf {
    root.join("validation").join(name)
}

fn compare(plan: &Plan<'_>, name: &str) -> Result<(), String> {
    built(plan, "spineline")?;
    let script = project(plan.root, name).join("compare.py");
    python::project(plan.root, name, &script, Path::new("debug/spineline"), &[])
}
