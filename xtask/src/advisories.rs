//! `cargo xtask advisories`: known faults and licences of all dependencies, by cargo-deny and the RustSec database.

use std::path::Path;
use std::process::Command;

use crate::cargo;
use crate::plan::Plan;
use crate::tools::answers;

/// Checks licences and sources, which need no network, and advisories where their database can be had.
///
/// What cannot be checked on this machine is said, and is no error.
pub fn check(plan: &Plan<'_>) -> Result<(), String> {
    if !answers("cargo", &["deny", "--version"]) {
        not_run(
            "licences and advisories",
            "`cargo install --locked cargo-deny` installs the program",
        );
        return Ok(());
    }
    cargo(plan.root, &["deny", "--all-features", "check", "licenses", "bans", "sources"])?;
    if let Err(reason) = fetched(plan.root) {
        not_run("advisories", &format!("the RustSec database cannot be fetched: {reason}"));
        return Ok(());
    }
    let arguments = ["deny", "--all-features", "check", "--disable-fetch", "advisories"];
    cargo(plan.root, &arguments)
}

fn not_run(what: &str, why: &str) {
    println!("NOT RUN: {what}: {why}");
}

/// Fetches the database; the error is the last line of what cargo-deny says.
fn fetched(root: &Path) -> Result<(), String> {
    let mut command = Command::new("cargo");
    command.args(["deny", "fetch", "db"]).current_dir(root);
    let output = command.output().map_err(|error| error.to_string())?;
    if output.status.success() { Ok(()) } else { Err(last_line(&output.stderr)) }
}

fn last_line(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text);
    let last = text.lines().rev().map(str::trim).find(|line| !line.is_empty());
    last.unwrap_or("no reason was given").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn f74_every_kind_of_check_is_configured() {
        // A kind without a section takes defaults, of which some allow everything.
        let text = include_str!("../../deny.toml");
        for section in ["[advisories]", "[licenses]", "[bans]", "[sources]"] {
            assert!(text.contains(section), "{section}");
        }
        for refused in
            ["unknown-registry = \"deny\"", "unknown-git = \"deny\"", "yanked = \"deny\""]
        {
            assert!(text.contains(refused), "{refused}");
        }
        assert!(!text.contains("GPL"), "a licence with duties for those who link it");
    }

    #[test]
    fn f74_the_reason_is_the_last_line() {
        assert_eq!(last_line(b"fetching\nerror: no network\n\n"), "error: no network");
        assert_eq!(last_line(b""), "no reason was given");
    }
}
