//! The checks that cargo runs.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::command::{cargo, run};
use crate::plan::{self, Plan};
use crate::{python, tools};

/// Typesetting takes most of a build, encryption much of one, so they are features.
const USUAL: [&str; 4] = ["--locked", "--workspace", "--exclude", "spineline-pdf"];
const FULL: [&str; 4] =
    ["--locked", "--workspace", "--features", "spineline-cli/pdf,spineline-cli/https"];

/// The crates of all cargo commands of a plan. They are always the same: another choice would change the features of
/// their dependencies, and build all of them again.
fn crates(plan: &Plan<'_>) -> &'static [&'static str] {
    if plan.is_full() { &FULL } else { &USUAL }
}

/// Calls cargo with clippy in place of the compiler: built code is linted, and a lint ends the build.
///
/// Separate lints would check all dependencies again, which takes a third of the time of building them.
fn cargo_on(
    plan: &Plan<'_>,
    command: &[&str],
    rest: &[&str],
    variables: &[(&str, &str)],
) -> Result<(), String> {
    let linted = as_linted(plan.root)?;
    let linted = linted.iter().map(|(name, value)| (*name, value.as_str()));
    let variables: Vec<(&str, &str)> = linted.chain(variables.iter().copied()).collect();
    run(plan.root, "cargo", &[command, crates(plan), rest].concat(), &variables)
}

/// The program and its examples as built by the tests.
///
/// They are built once per run: a concurrent step would wait for the build folder, which the tests use.
pub fn built(plan: &Plan<'_>, name: &str) -> Result<PathBuf, String> {
    static IS_BUILT: AtomicBool = AtomicBool::new(false);
    if !IS_BUILT.load(Ordering::Acquire) {
        cargo_on(plan, &["test", "--quiet", "--no-run"], &[], &[])?;
        IS_BUILT.store(true, Ordering::Release);
    }
    Ok(python::target()?.join("debug").join(name).with_extension(std::env::consts::EXE_EXTENSION))
}

/// The native module of the Python package, from the tests' build: the same crates and features. It is built once per
/// run, as the program is.
pub fn native_module(plan: &Plan<'_>) -> Result<PathBuf, String> {
    static IS_BUILT: AtomicBool = AtomicBool::new(false);
    if !IS_BUILT.load(Ordering::Acquire) {
        built(plan, "spineline")?;
        cargo_on(plan, &["build", "--quiet"], &["--lib", "--tests"], &[])?;
        IS_BUILT.store(true, Ordering::Release);
    }
    Ok(python::target()?.join("debug").join(python::module_file()))
}

pub fn format(plan: &Plan<'_>) -> Result<(), String> {
    cargo(plan.root, &["fmt", "--all", "--check"])
}

pub fn lint(plan: &Plan<'_>) -> Result<(), String> {
    let arguments = ["--all-targets", "--", "--deny", "warnings"];
    run(plan.root, "cargo", &[&["clippy"], crates(plan), &arguments].concat(), &[])
}

/// The environment of clippy as `cargo clippy` sets it in [`lint`], so that the documentation reuses the crates checked
/// by the lints. If cargo changes these settings, the crates are checked again.
fn as_linted(root: &Path) -> Result<[(&'static str, String); 2], String> {
    let output = Command::new("rustc").args(["--print", "sysroot"]).current_dir(root).output();
    let output = output.map_err(|error| format!("`rustc` could not be started: {error}"))?;
    let sysroot = String::from_utf8_lossy(&output.stdout);
    let driver = Path::new(sysroot.trim()).join("bin/clippy-driver");
    let driver = driver.with_extension(std::env::consts::EXE_EXTENSION);
    let arguments = ["--deny", "warnings", ""].join("__CLIPPY_HACKERY__");
    Ok([("RUSTC_WORKSPACE_WRAPPER", python::text(&driver)?), ("CLIPPY_ARGS", arguments)])
}

/// All tests except slow studies, with nextest if it is installed; long tests only in a full run
/// (`.config/nextest.toml`).
pub fn test(plan: &Plan<'_>) -> Result<(), String> {
    // Concurrent steps then find it built.
    native_module(plan)?;
    // Tests that change the machine briefly must be requested.
    let variables: &[(&str, &str)] =
        if plan.is_full() { &[("SPINELINE_MOUNT_SMALL_DISKS", "1")] } else { &[] };
    if tools::has_nextest() {
        let profile = if plan.is_full() { "full" } else { "default" };
        cargo_on(plan, &["nextest", "run", "--profile", profile], &[], variables)
    } else {
        cargo_on(plan, &["test", "--lib", "--bins", "--tests"], &[], variables)
    }
}

/// All tests, with the output of each and how it ended.
pub fn certify(plan: &Plan<'_>) -> Result<(), String> {
    let profile = if plan.is_full() { "full" } else { "default" };
    let shown =
        ["--status-level", "all", "--success-output", "immediate", "--failure-output", "immediate"];
    cargo_on(plan, &["nextest", "run", "--no-fail-fast", "--profile", profile], &shown, &[])
}

/// Films of an image archive: the tests with Orthanc, which pass silently if it is missing.
pub fn archive(plan: &Plan<'_>) -> Result<(), String> {
    cargo_on(plan, &["test", "--quiet", "--test", "it"], &["orthanc"], &[])
}

/// The program as a packager builds it who leaves the weights out. It replaces the program of the other steps.
pub fn without_weights(plan: &Plan<'_>) -> Result<(), String> {
    let rest = ["--no-default-features", "without_weights"];
    cargo_on(plan, &["test", "--quiet", "--test", "it"], &rest, &[])
}

/// Studies of minutes over thousands of synthetic patients, which are ignored by other runs.
///
/// `cargo xtask studies` runs all of them, for so long that a release build pays. A full run uses the tests' build and
/// leaves out the longest (`.config/nextest.toml`).
pub fn slow_studies(plan: &Plan<'_>) -> Result<(), String> {
    if plan.is_full() {
        let arguments = ["nextest", "run", "--profile", "studies", "--run-ignored", "only"];
        return cargo_on(plan, &arguments, &[], &[]);
    }
    let arguments =
        ["test", "--release", "--locked", "--package", "spineline-phantom", "--test", "it"];
    cargo(plan.root, &[&arguments[..], &["--", "--ignored"]].concat())
}

pub fn doctest(plan: &Plan<'_>) -> Result<(), String> {
    cargo_on(plan, &["test", "--doc"], &[], &[])
}

/// Documentation of the libraries, and of programs with another name than the libraries.
pub fn rustdoc(plan: &Plan<'_>) -> Result<(), String> {
    let command = ["doc", "--no-deps", "--quiet", "--lib"];
    let programs = ["--bin", "xtask", "--bin", "spineline-peers"];
    // An example requests the features of the lints' tests.
    let targets = [&programs[..], &["--example", "openapi"]].concat();
    cargo_on(plan, &command, &targets, &[("RUSTDOCFLAGS", "--deny warnings")])
}

/// Packs the crates for crates.io, and builds them from their packages.
pub fn packages(plan: &Plan<'_>) -> Result<(), String> {
    let crates = ["-p", "spineline", "-p", "spineline-phantom", "-p", "spineline-files"];
    cargo(plan.root, &[&["package", "--locked", "--allow-dirty"][..], &crates].concat())
}

/// Quick tests of some crates and of all that depend on them.
pub struct QuickTests {
    filter: String,
    /// nextest's list of the built tests. With it a run does not call cargo, and so waits for no other build.
    binaries: PathBuf,
}

impl QuickTests {
    pub fn new(changed: &[String]) -> Result<Self, String> {
        let filter: Vec<String> = changed.iter().map(|name| format!("rdeps(={name})")).collect();
        let binaries = plan::output_file("quick-tests.json")?.0;
        Ok(Self { filter: filter.join(" + "), binaries })
    }

    pub fn build(&self, root: &Path) -> Result<(), String> {
        let command =
            ["nextest", "list", "--list-type", "binaries-only", "--message-format", "json"];
        let arguments = [&command[..], &["--filterset", &self.filter], &USUAL].concat();
        println!("» cargo {}", arguments.join(" "));
        let file = File::create(&self.binaries)
            .map_err(|error| format!("{}: {error}", self.binaries.display()))?;
        let status = Command::new("cargo").args(arguments).current_dir(root).stdout(file).status();
        match status {
            Ok(status) if status.success() => Ok(()),
            Ok(_) => Err("the tests could not be built".to_owned()),
            Err(error) => Err(format!("`cargo` could not be started: {error}")),
        }
    }

    pub fn run(&self, root: &Path) -> Result<(), String> {
        let binaries = python::text(&self.binaries)?;
        let command = ["nextest", "run", "--profile", "quick", "--filterset", &self.filter];
        cargo(root, &[&command[..], &["--binaries-metadata", &binaries]].concat())
    }
}
