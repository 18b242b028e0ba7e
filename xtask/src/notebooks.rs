//! Notebooks: run from top to bottom, and made into pages with their output and pictures.

use std::path::{Path, PathBuf};

use crate::command::run;
use crate::files::{emptied, entries};
use crate::package::staged;
use crate::plan::Plan;
use crate::python;

/// The name of their Python environment.
const ENVIRONMENT: &str = "notebooks";

/// The interpreter of the environment in which they run.
pub fn environment(root: &Path) -> Result<PathBuf, String> {
    python::environment(root, ENVIRONMENT, &root.join("python/notebooks/requirements.txt"))
}

/// Runs all notebooks; a cell that fails stops it. The pages are below the target folder.
pub fn test(plan: &Plan<'_>) -> Result<(), String> {
    render(plan, &python::target()?.join("notebooks"))
}

/// Runs all notebooks, and writes each as a Markdown page with its pictures beside it.
pub fn render(plan: &Plan<'_>, to: &Path) -> Result<(), String> {
    emptied(to)?;
    let interpreter = python::text(&environment(plan.root)?)?;
    let package = python::text(&staged(plan)?)?;
    let variables = [("PYTHONPATH", package.as_str()), ("PYTHONDONTWRITEBYTECODE", "1")];
    for source in sources(plan.root)? {
        let name = source.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default().to_owned();
        let (source, notebook) = (python::text(&source)?, format!("{name}.ipynb"));
        let convert =
            ["-m", "jupytext", "--quiet", "--to", "ipynb", "--output", &notebook, &source];
        run(to, &interpreter, &convert, &variables)?;
        let execute =
            ["-m", "nbconvert", "--log-level", "WARN", "--execute", "--to", "markdown", &notebook];
        run(to, &interpreter, &execute, &variables)?;
    }
    Ok(())
}

/// The notebooks in the repository: Python files with marked cells.
fn sources(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = entries(&root.join("python/notebooks"))?;
    found.retain(|path| path.extension().is_some_and(|end| end == "py"));
    Ok(found)
}
