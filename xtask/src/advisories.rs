//! `cargo xtask advisories`: known vulnerabilities and licences of all dependencies, by cargo-deny and the RustSec
//! database.

use std::path::Path;
use std::process::Command;

use crate::command::{answers, cargo};
use crate::plan::Plan;

/// Checks licences and sources without a network, and advisories if their database can be fetched.
///
/// Checks that cannot run on this machine are listed as not run, and are not an error here: a release needs them
/// (`cargo xtask advisories --required`).
pub fn check(plan: &Plan<'_>) -> Result<(), String> {
    if !answers("cargo", &["deny", "--version"]) {
        let why = "cargo-deny is missing; `cargo install --locked cargo-deny` installs it";
        plan.note_not_run("licences and advisories of dependencies", why);
        return Ok(());
    }
    cargo(plan.root, &["deny", "--all-features", "check", "licenses", "bans", "sources"])?;
    if let Err(reason) = fetched(plan.root) {
        let why = format!("the RustSec database cannot be fetched: {reason}");
        plan.note_not_run("advisories of dependencies", &why);
        return Ok(());
    }
    let arguments = ["deny", "--all-features", "check", "--disable-fetch", "advisories"];
    cargo(plan.root, &arguments)
}

/// Fetches the database; the error is the last line of cargo-deny's output.
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
        // A missing section means defaults, some of which allow everything.
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

    /// Every exception names a crate that still exists and a reason; crates known as unmaintained have an exception.
    #[test]
    fn f74_every_exception_has_a_crate_and_a_reason() {
        let (deny, lock) = (include_str!("../../deny.toml"), include_str!("../../Cargo.lock"));
        let exceptions: Vec<&str> = deny.lines().filter(|line| line.contains("RUSTSEC-")).collect();
        for line in &exceptions {
            let reason = line.split_once("reason = \"").map(|(_, reason)| reason);
            let reason = reason.unwrap_or_else(|| panic!("no reason: {line}"));
            let (name, why) = reason.split_once(": ").expect("the crate, then the reason");
            let (name, version) = name.split_once(' ').expect("a crate and its version");
            assert!(why.len() > 30, "{line}");
            let there = format!("name = \"{name}\"\nversion = \"{version}.");
            assert!(lock.contains(&there), "{name} {version} is gone: remove {line}");
        }
        for name in
            ["quick-xml", "bincode", "yaml-rust", "rustybuzz", "ttf-parser", "encoding", "paste"]
        {
            let is_named = exceptions.iter().any(|line| line.contains(&format!("\"{name} ")));
            let is_there = lock.contains(&format!("name = \"{name}\"\n"));
            assert!(is_named || !is_there, "{name}");
        }
    }

    #[test]
    fn f74_the_reason_is_the_last_line() {
        assert_eq!(last_line(b"fetching\nerror: no network\n\n"), "error: no network");
        assert_eq!(last_line(b""), "no reason was given");
    }
}
