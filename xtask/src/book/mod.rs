//! `cargo xtask docs`: one book of the guide, the reference of the Python package, the notebooks as they ran, and two pages that are made
//! from what the project knows of itself.
//!
//! mdBook comes as a wheel, as the other programs of the checks do: building it here would take as long as everything else,
//! and Debian has no package of it. The book needs no network, nor does making it once the wheel is installed.

mod credibility;
mod paper;

use std::fs;
use std::path::Path;

use crate::checks::built;
use crate::plan::{Extent, Plan};
use crate::{notebooks, python, run};

/// Makes the book below the target folder.
pub fn make(root: &Path) -> Result<(), String> {
    let target = python::target()?;
    let guide = root.join("docs/guide");
    let mdbook = python::tool(root, "docs", &guide.join("requirements.txt"), "mdbook")?;
    let results = target.join("docs/reproduce");
    let plan = Plan::new(root, Extent::Usual);
    let program = built(&plan, "spineline")?;
    let [program, out] = [&program, &results].map(|path| path.display().to_string());
    output(&program, &["reproduce", "--out", &out])?;
    let source = target.join("docs/guide");
    copy(&guide, &source)?;
    let evidence = read(&root.join("validation/README.md"))?;
    write(&source.join("src/credibility.md"), &credibility::page(&evidence)?)?;
    let dictionary = output(&program, &["schema", "dictionary"])?;
    write(&source.join("src/dictionary.md"), &dictionary)?;
    let summary = read(&results.join("summary.json"))?;
    write(&source.join("src/paper.md"), &paper::page(&summary)?)?;
    notebooks::render(&plan, &source.join("src/notebooks"))?;
    python_reference(root, &source.join("src/python_reference.md"))?;
    let [source, book] = [&source, &target.join("book")].map(|path| path.display().to_string());
    run(root, &mdbook, &["build", &source, "--dest-dir", &book], &[])?;
    println!("» {book}/index.html");
    Ok(())
}

/// The text that a run of the program prints.
fn output(program: &str, arguments: &[&str]) -> Result<String, String> {
    println!("» {program} {}", arguments.join(" "));
    let printed = std::process::Command::new(program).args(arguments).output();
    let printed = printed.map_err(|error| format!("`{program}`: {error}"))?;
    if !printed.status.success() {
        return Err(String::from_utf8_lossy(&printed.stderr).into_owned());
    }
    String::from_utf8(printed.stdout).map_err(|error| format!("`{program}`: {error}"))
}

/// The page of every name of the Python package, by its docstrings.
fn python_reference(root: &Path, page: &Path) -> Result<(), String> {
    let interpreter = python::text(&notebooks::environment(root)?)?;
    let script = python::text(&root.join("docs/guide/python_reference.py"))?;
    let (package, page) = (python::text(&root.join("python/spineline"))?, python::text(page)?);
    run(root, &interpreter, &[&script, &package, &page], &[("PYTHONDONTWRITEBYTECODE", "1")])
}

/// Copies the guide afresh: no page of an older one is left.
fn copy(from: &Path, to: &Path) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}", to.display());
    if to.exists() {
        fs::remove_dir_all(to).map_err(failed)?;
    }
    fs::create_dir_all(to.join("src")).map_err(failed)?;
    fs::copy(from.join("book.toml"), to.join("book.toml")).map_err(failed)?;
    for entry in fs::read_dir(from.join("src")).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        fs::copy(entry.path(), to.join("src").join(entry.file_name())).map_err(failed)?;
    }
    Ok(())
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}
