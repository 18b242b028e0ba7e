//! The project's own commands: `cargo xtask test` runs everything that must hold.

mod book;
mod debian;
mod fuzz;
mod oracle;
mod outside;
mod peers;
mod python;
mod tidy;
mod web;

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const HELP: &str = "\
cargo xtask COMMAND

  test     everything: format, lints, tidy, tests, documentation and its examples, the browser app,
           other programs, fuzzing for seconds
  check    the quick part: format, lints, tidy
  tidy     house rules that no compiler knows
  web      the browser app, checked and built, so that the program embeds it (needs Node, and a network once)
  browser  the browser app, driven in Chromium as a person does
  engines  exported models in MuJoCo, Pinocchio and OpenSim (this and the next three need Python, and a network once)
  reliability
           ICC, errors and correlations in pingouin and scipy
  films    films of phantoms in pydicom
  exchange exported landmarks in highdicom, pydicom and DCMTK, tables in pyarrow and pandas, typeset reports in qpdf
  docs     the guide as a book, with the page of credibility and that of the paper's numbers (needs what `engines` needs)
  fuzz [SECONDS]
           every parser on random input, 60 seconds each (needs a nightly compiler)
  bench    benchmarks of the core
  peers [--rounds N] [--without-octave]
           times beside those of MuJoCo, Pinocchio, OpenSim, numpy and Octave (minutes; needs what `engines` needs)
  oracle CASE.json… --out DIR
           spines solved by other programs, solved by the march and by Newton
";

/// One thing that must hold; the text says what does not.
type Step = fn(&Path) -> Result<(), String>;

fn main() -> ExitCode {
    let command = env::args().nth(1).unwrap_or_default();
    let root = root();
    let arguments: Vec<String> = env::args().skip(2).collect();
    match command.as_str() {
        "oracle" => return ended(&command, oracle::run(&arguments)),
        "peers" => return ended(&command, peers::compare(&root, &arguments)),
        "fuzz" => {
            let seconds = arguments.first().map_or(Some(60), |text| text.parse().ok());
            let result = seconds.ok_or_else(|| "SECONDS is a number".to_owned());
            return ended(&command, result.and_then(|seconds| fuzz::all(&root, seconds)));
        }
        _ => {}
    }
    let steps: &[Step] = match command.as_str() {
        "test" => &[
            format,
            lint,
            tidy::run,
            // Before the program is built, which embeds it.
            web::build,
            test,
            doctest,
            rustdoc,
            web::browser,
            outside::engines,
            outside::reliability,
            outside::films,
            outside::exchange,
            fuzz_for_seconds,
        ],
        "check" => &[format, lint, tidy::run],
        "tidy" => &[tidy::run],
        "web" => &[web::build],
        "browser" => &[web::browser],
        "engines" => &[outside::engines],
        "reliability" => &[outside::reliability],
        "films" => &[outside::films],
        "exchange" => &[outside::exchange],
        "docs" => &[book::make],
        "bench" => &[bench],
        _ => {
            eprint!("{HELP}");
            return ExitCode::from(2);
        }
    };
    ended(&command, steps.iter().try_for_each(|step| step(&root)))
}

fn ended(command: &str, result: Result<(), String>) -> ExitCode {
    match result {
        Ok(()) => {
            println!("xtask {command}: all is well");
            ExitCode::SUCCESS
        }
        Err(reason) => {
            eprintln!("xtask {command}: {reason}");
            ExitCode::FAILURE
        }
    }
}

/// The folder of the workspace.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace").to_owned()
}

/// The program and its examples as the tests have built them. Another choice of packages would ask for other features of
/// what they depend on, and build all of it once more.
fn built(root: &Path, name: &str) -> Result<PathBuf, String> {
    cargo(root, &["test", "--quiet", "--workspace", "--locked", "--no-run"])?;
    Ok(python::target()?.join("debug").join(name).with_extension(std::env::consts::EXE_EXTENSION))
}

fn cargo(root: &Path, arguments: &[&str]) -> Result<(), String> {
    run(root, "cargo", arguments, &[])
}

fn run(
    root: &Path,
    program: &str,
    arguments: &[&str],
    variables: &[(&str, &str)],
) -> Result<(), String> {
    println!("» {program} {}", arguments.join(" "));
    let status = Command::new(program)
        .args(arguments)
        .envs(variables.iter().copied())
        .current_dir(root)
        .status()
        .map_err(|error| format!("`{program}` could not be started: {error}"))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("`{program} {}` failed", arguments.join(" ")))
    }
}

fn format(root: &Path) -> Result<(), String> {
    cargo(root, &["fmt", "--all", "--check"])
}

fn lint(root: &Path) -> Result<(), String> {
    cargo(root, &["clippy", "--workspace", "--all-targets", "--locked", "--", "--deny", "warnings"])
}

/// All tests, with nextest where it is installed.
fn test(root: &Path) -> Result<(), String> {
    let nextest = Command::new("cargo").args(["nextest", "--version"]).output();
    if nextest.is_ok_and(|output| output.status.success()) {
        cargo(root, &["nextest", "run", "--workspace", "--locked"])
    } else {
        cargo(root, &["test", "--workspace", "--locked", "--lib", "--bins", "--tests"])
    }
}

fn doctest(root: &Path) -> Result<(), String> {
    cargo(root, &["test", "--workspace", "--locked", "--doc"])
}

fn rustdoc(root: &Path) -> Result<(), String> {
    let arguments = ["doc", "--workspace", "--no-deps", "--locked", "--quiet"];
    run(root, "cargo", &arguments, &[("RUSTDOCFLAGS", "--deny warnings")])
}

/// Long enough to meet what is easy to break, short enough for every change.
fn fuzz_for_seconds(root: &Path) -> Result<(), String> {
    fuzz::all(root, 8)
}

fn bench(root: &Path) -> Result<(), String> {
    cargo(root, &["bench", "--package", "spineline", "--benches"])
}
