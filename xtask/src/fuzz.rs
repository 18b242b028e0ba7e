//! `cargo xtask fuzz`: every parser for a limited time, from seeds, with cargo-fuzz and a nightly compiler. The tests
//! replay the seeds on stable. The code is safe Rust, so fuzzing looks for panics and overflows, without a sanitizer.

use std::fs;
use std::path::Path;

use crate::command::{answers, cargo, run};
use crate::files::entries;

/// Runs every target for this number of seconds; a crash is an error, and its input is kept below
/// `fuzz/artifacts`.
pub fn all(root: &Path, seconds: u32) -> Result<(), String> {
    let folder = root.join("fuzz");
    if !answers("cargo", &["+nightly", "--version"]) {
        return Err("no nightly compiler\n  help: rustup toolchain install nightly".to_owned());
    }
    if !answers("cargo", &["fuzz", "--version"]) {
        return Err("no cargo-fuzz\n  help: cargo install --locked cargo-fuzz".to_owned());
    }
    let write = ["run", "--quiet", "--locked", "--package", "spineline-fuzz-checks"];
    cargo(root, &[&write[..], &["--example", "seeds", "fuzz/seeds"]].concat())?;
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

/// Names of the targets, from their files.
fn targets(folder: &Path) -> Result<Vec<String>, String> {
    let files = entries(&folder.join("fuzz_targets"))?;
    Ok(files.iter().filter_map(|file| Some(file.file_stem()?.to_str()?.to_owned())).collect())
}
