//! `cargo xtask docs`: one book of the guide, the reference of the Python package, the executed notebooks, and two
//! pages from the project's own data.
//!
//! mdBook comes as a wheel, as the other programs of the checks do: building it here would take as long as everything
//! else, and Debian does not package it. The book needs no network, and making it needs none once the wheel is
//! installed.

pub mod credibility;
mod links;
mod paper;

use std::fs;
use std::path::Path;

use crate::checks::built;
use crate::command::run;
use crate::files::{emptied, entries, read, write};
use crate::plan::{Extent, Plan};
use crate::{notebooks, python};

/// The folder of the certificate, below the target folder: its claims have outcomes.
pub const CERTIFICATE: &str = "certificate";

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
    add_pages(root, &source.join("src"))?;
    let certified = target.join(CERTIFICATE).join("claims.md");
    let claims = root.join("validation/README.md");
    let evidence = read(if certified.exists() { &certified } else { &claims })?;
    let page =
        links::in_book(&credibility::page(&evidence)?, "validation/README.md", "credibility.md");
    write(&source.join("src/credibility.md"), &page)?;
    let dictionary = output(&program, &["schema", "dictionary"])?;
    write(&source.join("src/dictionary.md"), &dictionary)?;
    let summary = read(&results.join("summary.json"))?;
    write(&source.join("src/paper.md"), &paper::page(&summary)?)?;
    notebooks::render(&plan, &source.join("src/notebooks"))?;
    python_reference(root, &source.join("src/python_reference.md"))?;
    let dead = links::dead(&source.join("src"))?;
    if !dead.is_empty() {
        return Err(format!("links lead nowhere:\n{}", dead.join("\n")));
    }
    let [source, book] = [&source, &target.join("book")].map(|path| path.display().to_string());
    run(root, &mdbook, &["build", &source, "--dest-dir", &book], &[])?;
    println!("» {book}/index.html");
    Ok(())
}

/// Adds the pages of the repository outside of the guide, and lets all links lead to pages of the book.
fn add_pages(root: &Path, pages: &Path) -> Result<(), String> {
    for path in entries(pages)? {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.ends_with(".md") {
            let page = links::in_book(&read(&path)?, &format!("docs/guide/src/{name}"), &name);
            write(&path, &page)?;
        }
    }
    emptied(&pages.join("results"))?;
    for (from, to) in links::PAGES {
        let text = read(&root.join(from))?;
        let page = if to.ends_with(".md") { links::in_book(&text, from, to) } else { text };
        write(&pages.join(to), &page)?;
    }
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

/// Replaces the guide: pages of an older one are removed.
fn copy(from: &Path, to: &Path) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}", to.display());
    emptied(&to.join("src"))?;
    fs::copy(from.join("book.toml"), to.join("book.toml")).map_err(failed)?;
    for path in entries(&from.join("src"))? {
        let name = path.file_name().unwrap_or_default();
        fs::copy(&path, to.join("src").join(name)).map_err(failed)?;
    }
    Ok(())
}
