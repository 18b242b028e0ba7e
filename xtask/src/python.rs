//! Python environments for checks against other programs: one per requirements file, below the target folder.

use std::collections::BTreeMap;
use std::env;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX, EXE_EXTENSION};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::command::run;
use crate::files::{read, write};

/// Runs a script of a Python project with this program; results go to a folder of that name below the target.
pub fn project(
    root: &Path,
    name: &str,
    script: &Path,
    program: &Path,
    passed_on: &[String],
) -> Result<(), String> {
    let folder = script.parent().expect("a script lies in its project");
    let interpreter = environment(root, name, &folder.join("requirements.txt"))?;
    self::script(root, &interpreter, name, script, program, passed_on)
}

/// Runs a script with an existing interpreter; else as [`project`].
pub fn script(
    root: &Path,
    interpreter: &Path,
    name: &str,
    script: &Path,
    program: &Path,
    passed_on: &[String],
) -> Result<(), String> {
    let target = target()?;
    let program = target.join(program).with_extension(EXE_EXTENSION);
    let results = target.join(name);
    if results.exists() {
        // Files of an earlier version of the program would be taken for a user's, and kept.
        fs::remove_dir_all(&results).map_err(|error| format!("{}: {error}", results.display()))?;
    }
    let own = [
        text(script)?,
        "--program".to_owned(),
        text(&program)?,
        "--out".to_owned(),
        text(&results)?,
    ];
    let arguments: Vec<&str> = own.iter().chain(passed_on).map(String::as_str).collect();
    run(root, &text(interpreter)?, &arguments, &[("PYTHONDONTWRITEBYTECODE", "1")])
}

/// A program in an environment.
pub fn tool(root: &Path, name: &str, requirements: &Path, tool: &str) -> Result<String, String> {
    let interpreter = environment(root, name, requirements)?;
    text(&interpreter.with_file_name(tool).with_extension(EXE_EXTENSION))
}

/// The interpreter of an environment with the packages of a requirements file.
///
/// The environment is made if it is missing, and filled if the file has changed since; otherwise the network is not
/// needed. `python3` makes it, or the program that `PYTHON` names.
pub fn environment(root: &Path, name: &str, requirements: &Path) -> Result<PathBuf, String> {
    /// One environment of a name at a time; different names concurrently.
    static MAKING: Mutex<BTreeMap<String, Arc<Mutex<()>>>> = Mutex::new(BTreeMap::new());
    let own = MAKING
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .entry(name.to_owned())
        .or_default()
        .clone();
    let _own = own.lock().unwrap_or_else(PoisonError::into_inner);
    let wanted = read(requirements)?;
    let folder = target()?.join("python").join(name);
    let bin = if cfg!(windows) { "Scripts" } else { "bin" };
    let python = folder.join(bin).join(if cfg!(windows) { "python.exe" } else { "python" });
    let stamp = folder.join("requirements.stamp");
    if python.exists() && read(&stamp).is_ok_and(|had| had == wanted) {
        return Ok(python);
    }
    let failed = |reason: String| {
        format!(
            "{reason}\n  help: Python 3.11 with `venv`, and once a network, are needed; the variable PYTHON may name \
             the interpreter, and removing {} starts afresh",
            folder.display()
        )
    };
    let maker = env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    run(root, &maker, &["-m", "venv", &text(&folder)?], &[]).map_err(failed)?;
    let file = text(requirements)?;
    // Most modules are never imported: compiling all of them takes half of the installation time.
    let quiet = ["--quiet", "--disable-pip-version-check", "--no-compile"];
    let install = [&["-m", "pip", "install"][..], &quiet, &["--requirement", &file]].concat();
    run(root, &text(&python)?, &install, &[]).map_err(failed)?;
    write(&stamp, &wanted)?;
    Ok(python)
}

/// The folder that cargo builds into: this program lies in one of its profiles.
pub fn target() -> Result<PathBuf, String> {
    let own = env::current_exe().map_err(|error| format!("own path: {error}"))?;
    own.ancestors()
        .nth(2)
        .map(Path::to_owned)
        .ok_or_else(|| format!("{} lies in no target folder", own.display()))
}

/// A path as an argument.
pub fn text(path: &Path) -> Result<String, String> {
    path.to_str().map(str::to_owned).ok_or_else(|| format!("{} is not UTF-8", path.display()))
}

/// The file name that cargo gives the native module.
pub fn module_file() -> String {
    format!("{DLL_PREFIX}_native{DLL_SUFFIX}")
}
