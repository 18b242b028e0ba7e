//! `cargo xtask certify`: runs the test of every claim, and writes down how each ended, with the logs and with the numbers
//! that moved since another certificate.

mod numbers;
mod outcomes;

use std::fs::File;
use std::path::Path;
use std::process::Command;

use crate::book::{CERTIFICATE, credibility};
use crate::checks::{self, built};
use crate::command::with_output;
use crate::files::{emptied, read, write};
use crate::plan::{Extent, Plan};
use crate::{outside, python, tools};
use outcomes::Outcomes;

/// Makes the certificate: of all tests with `--full`, and beside the certificate in the folder of `--since`.
pub fn certify(root: &Path, arguments: &[String]) -> Result<(), String> {
    let (extent, since) = match arguments {
        [] => (Extent::Usual, None),
        [full] if full == "--full" => (Extent::Full, None),
        [since, folder] if since == "--since" => (Extent::Usual, Some(folder)),
        [full, since, folder] if full == "--full" && since == "--since" => {
            (Extent::Full, Some(folder))
        }
        _ => return Err("`cargo xtask` lists the options".to_owned()),
    };
    if !tools::has_nextest() {
        return Err("cargo-nextest is missing: `cargo xtask setup` installs it".to_owned());
    }
    let folder = python::target()?.join(CERTIFICATE);
    let before = since.map(|folder| numbers::read_all(Path::new(folder))).transpose()?;
    emptied(&folder)?;
    let plan = Plan::new(root, extent);
    let outcomes = outcomes_of(&plan, &folder)?;
    let now = numbers::measured(&built(&plan, "spineline")?, &folder)?;
    let claims = outcomes.beside(&read(&root.join("validation/README.md"))?);
    let page = format!(
        "{}\n{}\n{}",
        heading(root, &outcomes),
        credibility::page(&claims)?.trim_start_matches("# Credibility\n"),
        numbers::page(before.as_ref(), &now),
    );
    write(&folder.join("claims.md"), &claims)?;
    write(&folder.join("certificate.md"), &page)?;
    println!("» {}", folder.join("certificate.md").display());
    match outcomes.failed() {
        0 => Ok(()),
        failed => Err(format!("{failed} tests failed: the certificate names them")),
    }
}

/// Runs the tests and the comparisons with other programs, each with its log in the folder.
fn outcomes_of(plan: &Plan<'_>, folder: &Path) -> Result<Outcomes, String> {
    let log = |name: &str| {
        let path = folder.join(format!("{name}.log"));
        let file = File::create(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        println!("━━ {name}: {}", path.display());
        Ok::<_, String>((path, file))
    };
    built(plan, "spineline")?;
    let (path, file) = log("tests")?;
    let ended = with_output(file, || checks::certify(plan));
    let mut outcomes = Outcomes::of_log(&read(&path)?);
    if outcomes.is_empty() {
        ended?;
    }
    type Comparison = fn(&Plan<'_>) -> Result<(), String>;
    let mut comparisons: Vec<(&str, Comparison)> = vec![
        ("engines", outside::engines),
        ("reliability", outside::reliability),
        ("films", outside::films),
    ];
    if plan.is_full() {
        comparisons.push(("exchange", outside::exchange));
    }
    for (name, compare) in comparisons {
        let (_, file) = log(name)?;
        outcomes.comparison(name, &with_output(file, || compare(plan)));
    }
    Ok(outcomes)
}

fn heading(root: &Path, outcomes: &Outcomes) -> String {
    let asked = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).current_dir(root).output();
        output.map_or_else(
            |_| "unknown".to_owned(),
            |output| String::from_utf8_lossy(&output.stdout).trim().to_owned(),
        )
    };
    let commit = asked("git", &["show", "--no-patch", "--format=%H of %cs", "HEAD"]);
    let changed = asked("git", &["status", "--porcelain", "--untracked-files=no"]);
    let changed = if changed.is_empty() { "" } else { ", with changes that are not committed" };
    format!(
        "# Certificate\n\nSpineline {}, commit {commit}{changed}, {}. {outcomes}\n",
        env!("CARGO_PKG_VERSION"),
        asked("rustc", &["--version"]),
    )
}
