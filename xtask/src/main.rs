//! The project's own commands: `cargo xtask test` runs all checks.

mod advisories;
mod book;
mod certify;
mod checks;
mod cohorts;
mod command;
mod files;
mod fuzz;
mod node;
mod notebooks;
mod outside;
mod package;
mod peers;
mod plan;
mod python;
mod quick;
mod setup;
mod tidy;
mod tools;
mod web;

use std::env;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use plan::{Extent, Plan, Step};
use tools::Tool;

const HELP: &str = "\
cargo xtask COMMAND

  test [--full]
           format, tidy, lints, all tests, documentation and its examples, the browser app in Chromium, other programs.
           --full adds typeset reports, exchange formats, full small disks, long tests and the slow studies, and fails
           where a tool is missing
  quick [--base REV]
           format, tidy, lints, and the quick tests of the crates that a change touches and of those that depend on them;
           the change is what differs from REV (the last commit, unless told otherwise)
  setup    install what the tests need: Debian packages, cargo-nextest, npm packages, Python environments
  check    format, tidy and lints
  tidy     house rules that no compiler knows
  advisories [--required]
           check dependencies for known faults and their licences (needs cargo-deny, and the network for the faults);
           what cannot be checked is named at the end, and fails with --required, as for a release
  studies  run the slow studies over tens of thousands of synthetic patients, in a release build (half an hour)
  web      check, test and build the browser app, which the program then embeds
  browser  drive the browser app in Chromium
  engines  compare exported models with MuJoCo, Pinocchio and OpenSim
  reliability
           compare ICC, errors and correlations with pingouin and scipy
  films    compare films of phantoms with pydicom
  landmarks
           judge completed and detected landmarks on X-rays of unseen patients (SPINELINE_DATA names the folder of the data)
  exchange compare landmarks with highdicom, pydicom and DCMTK, tables with pyarrow and pandas, typeset reports with qpdf
  python   test the Python package and its types; measure import and calls
  notebooks
           run the notebooks and write them as pages with their pictures
  slicer   run the self-test of the module of 3D Slicer on Slicer's scene
  wheel [--also INTERPRETER] [--glibc VERSION]
           build the wheel of the Python package, with the program and the browser app inside; --also builds a second
           one for an interpreter without the stable ABI, such as python3.14t; --glibc 2.28 links with Zig for every Linux
           with that C library or a later one
  attack   give the program damaged files, bombs, full disks, interruptions and kills
  certify [--full] [--since FOLDER]
           run the test of every claim and the comparisons with other programs, and write down how each ended, with the
           numbers on known films that moved since another certificate (its FOLDER); the book then shows the outcomes
  docs     make the book: guide, Python reference, notebooks with their pictures, credibility, the paper's numbers
  fuzz [SECONDS]
           run every parser on random input, 60 seconds each (needs a nightly compiler and cargo-fuzz)
  bench    run the benchmarks of the core
  peers [--rounds N] [--without-octave]
           compare times with MuJoCo, Pinocchio, OpenSim, numpy and Octave
  cohorts [--cases N] [--patients N] [--replicates N] [--rows N] [--workers N]...
           time cohorts by the program and by the Python package on Dask
";

fn main() -> ExitCode {
    let command = env::args().nth(1).unwrap_or_default();
    let root = root();
    let arguments: Vec<String> = env::args().skip(2).collect();
    let result = match (command.as_str(), &arguments[..]) {
        ("cohorts", _) => cohorts::compare(&root, &arguments),
        ("peers", _) => peers::compare(&root, &arguments),
        ("fuzz", []) => fuzz::all(&root, 60),
        ("fuzz", [seconds]) => match seconds.parse() {
            Ok(seconds) => fuzz::all(&root, seconds),
            Err(_) => Err(format!("`{seconds}` is not a number of seconds")),
        },
        ("quick", []) => quick::run(&root, "HEAD"),
        ("quick", [option, base]) if option == "--base" => quick::run(&root, base),
        ("wheel", _) => package::wheels(&root, &arguments),
        ("setup", []) => setup::setup(&root),
        ("docs", []) => book::make(&root),
        ("certify", _) => certify::certify(&root, &arguments),
        ("bench", []) => command::cargo(&root, &["bench", "--package", "spineline", "--benches"]),
        ("advisories", [option]) if option == "--required" => {
            Plan::new(&root, Extent::Usual).run_all_of(&steps("advisories").unwrap_or_default())
        }
        (name, rest) => match (steps(name), rest) {
            (Some(steps), []) => Plan::new(&root, Extent::Usual).run(&steps),
            (Some(steps), [option]) if name == "test" && option == "--full" => {
                Plan::new(&root, Extent::Full).run(&steps)
            }
            _ => {
                eprint!("{HELP}");
                return ExitCode::from(2);
            }
        },
    };
    match result {
        Ok(()) => {
            println!("xtask {command}: passed");
            ExitCode::SUCCESS
        }
        Err(reason) => {
            eprintln!("xtask {command}: {reason}");
            ExitCode::FAILURE
        }
    }
}

/// The steps of a command that consists of steps only.
fn steps(command: &str) -> Option<Vec<Step<'static>>> {
    let format = Step::new("format", &[], checks::format);
    let advisories = Step::new("advisories", &[], advisories::check);
    let tidy = Step::new("tidy", &[], |plan| tidy::run(plan.root));
    let lint = Step::new("lints", &[], checks::lint);
    // While the browser app and the program are built, which leave network and disk free.
    let environments = Step::new("environments", &[Tool::Python], outside::provide_environments);
    // Before the program is built, which embeds it.
    let web = Step::new("web", &[Tool::Npm], |plan| web::build(plan.root));
    let web_checks = Step::new("web checks", &[Tool::Npm], |plan| web::check(plan.root));
    let browser = Step::new("browser", &[Tool::Npm], web::browser);
    let engines = Step::new("engines", &[Tool::Python], outside::engines);
    let reliability = Step::new("reliability", &[Tool::Python], outside::reliability);
    let films = Step::new("films", &[Tool::Python], outside::films);
    let exchange = Step::new("exchange", &[Tool::Python, Tool::Dcmtk], outside::exchange).full();
    let package = Step::new("python", &[Tool::Python], package::test);
    let wheel = Step::new("wheel", &[Tool::Python], |plan| package::test_wheel(plan.root)).full();
    let notebooks = Step::new("notebooks", &[Tool::Python], notebooks::test).full();
    let slicer = Step::new("slicer", &[Tool::Python], package::test_slicer).full();
    let attack = Step::new("attack", &[Tool::Python], outside::attack).full();
    let studies = Step::new("studies", &[], checks::slow_studies).full();
    Some(match command {
        "test" => vec![
            format,
            tidy,
            advisories,
            environments.beside(),
            web,
            web_checks.beside(),
            Step::new("tests", &[], checks::test),
            Step::new("archive", &[Tool::Orthanc], checks::archive),
            engines.beside(),
            reliability.beside(),
            films.beside(),
            exchange.beside(),
            package.beside(),
            Step::new("doc examples", &[], checks::doctest),
            lint.full(),
            Step::new("docs", &[], checks::rustdoc).full(),
            Step::new("packages", &[], checks::packages).full(),
            // They write files that the Python step or the lints read.
            notebooks.alone(),
            slicer.alone(),
            wheel.alone(),
            Step::new("browser", &[Tool::Npm], web::browser_in_short).alone(),
            attack,
            studies,
            Step::new("without weights", &[], checks::without_weights).alone(),
        ],
        "python" => vec![package],
        "notebooks" => vec![notebooks.usual()],
        "slicer" => vec![slicer.usual()],
        "attack" => vec![attack.usual()],
        "studies" => vec![studies.usual()],
        "check" => vec![format, tidy, lint],
        "tidy" => vec![tidy],
        "advisories" => vec![advisories],
        "web" => vec![web_checks, web],
        "browser" => vec![web_checks, web, browser],
        "engines" => vec![engines],
        "reliability" => vec![reliability],
        "films" => vec![films],
        "landmarks" => vec![Step::new("landmarks", &[Tool::Python], outside::landmarks)],
        "exchange" => vec![exchange.usual()],
        _ => return None,
    })
}

/// The folder of the workspace.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace").to_owned()
}
