//! `cargo xtask fuzz`: every parser for a bounded time, from seeds, with cargo-fuzz where a nightly compiler is there.
//! Nothing here is unsafe, so that panics and overflows are what is looked for, and no sanitizer is needed.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::{built, run};

/// Runs every target for so many seconds; a crash is an error, and its input stays below `fuzz/artifacts`.
pub fn all(root: &Path, seconds: u32) -> Result<(), String> {
    let folder = root.join("fuzz");
    if !answers("cargo", &["+nightly", "--version"]) {
        println!("» no nightly compiler: fuzzing is left out (`rustup toolchain install nightly`)");
        return Ok(());
    }
    if !answers("cargo", &["fuzz", "--version"]) {
        run(root, "cargo", &["install", "--locked", "--quiet", "cargo-fuzz"], &[])?;
    }
    let seeds = built(root, "examples/fuzz_seeds")?.display().to_string();
    run(&folder, &seeds, &[], &[])?;
    run(&folder, "cargo", &["+nightly", "fuzz", "build", "--sanitizer", "none"], &[])?;
    for target in targets(&folder)? {
        let seeds = format!("seeds/{target}");
        let corpus = format!("corpus/{target}");
        fs::create_dir_all(folder.join(&corpus)).map_err(|error| format!("{corpus}: {error}"))?;
        let time = format!("-max_total_time={seconds}");
        let options = [
            "+nightly",
            "fuzz",
            "run",
            "--sanitizer",
            "none",
            &target,
            &corpus,
            &seeds,
            "--",
            &time,
            "-rss_limit_mb=3072",
            "-timeout=20",
            "-verbosity=0",
            "-close_fd_mask=1",
        ];
        run(&folder, "cargo", &options, &[])?;
    }
    Ok(())
}

fn answers(program: &str, arguments: &[&str]) -> bool {
    let quiet =
        Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    quiet.is_ok_and(|status| status.success())
}

/// Names of the targets, from their files.
fn targets(folder: &Path) -> Result<Vec<String>, String> {
    let list = folder.join("fuzz_targets");
    let entries = fs::read_dir(&list).map_err(|error| format!("{}: {error}", list.display()))?;
    let mut names: Vec<String> = entries
        .filter_map(|entry| Some(entry.ok()?.path().file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    Ok(names)
}
