//! The build identity of a program: a hash of the sources of its crate and of all crates of the workspace that it uses, directly or not, and
//! of the versions of all other crates (`Cargo.lock`). Equal sources give an equal identity in any folder and on any machine; compiler,
//! platform and profile do not count.
//!
//! A build script calls [`emit`]; the crate then has its identity as `env!("SPINELINE_BUILD")`.

use std::collections::BTreeSet;
use std::env;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Folders of a crate whose files are not part of programs.
const NOT_BUILT: [&str; 4] = ["tests", "benches", "examples", "target"];

/// Sets the environment variable `SPINELINE_BUILD` of the crate that is built to its identity, and makes cargo check
/// again after any change of its sources.
///
/// # Errors
/// If a source cannot be read.
///
/// # Panics
/// If cargo did not start the build script.
pub fn emit() -> io::Result<()> {
    let folder = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let sources = Sources::of(&folder)?;
    for place in &sources.places {
        println!("cargo:rerun-if-changed={}", place.display());
    }
    println!("cargo:rustc-env=SPINELINE_BUILD={}", sources.identity()?);
    Ok(())
}

/// The sources of a crate.
pub struct Sources {
    /// The folder of all crates.
    root: PathBuf,
    /// Files and folders that count, sorted by name.
    places: BTreeSet<PathBuf>,
}

impl Sources {
    /// For the crate in a folder. A crate of the workspace lies in the folder of its name beside those that use it.
    ///
    /// # Errors
    /// If a folder or a manifest cannot be read.
    pub fn of(folder: &Path) -> io::Result<Self> {
        let root = folder.parent().unwrap_or(folder).to_owned();
        let mut known = BTreeSet::from([folder.to_owned()]);
        let (mut places, mut open) = (BTreeSet::new(), vec![folder.to_owned()]);
        while let Some(one) = open.pop() {
            for entry in fs::read_dir(&one)? {
                let path = entry?.path();
                let is_built = path.file_name().is_some_and(|name| {
                    let name = name.to_string_lossy();
                    !NOT_BUILT.contains(&&*name) && !name.starts_with('.')
                });
                if is_built {
                    places.insert(path);
                }
            }
            for name in dependencies(&fs::read_to_string(one.join("Cargo.toml"))?) {
                let other = root.join(name);
                if other.join("Cargo.toml").exists() && known.insert(other.clone()) {
                    open.push(other);
                }
            }
        }
        let versions = root.join("../Cargo.lock");
        if versions.exists() {
            places.insert(versions);
        }
        Ok(Self { root, places })
    }

    /// SHA-256 of all names and bytes, in hexadecimal digits.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn identity(&self) -> io::Result<String> {
        let mut files = BTreeSet::new();
        for place in &self.places {
            collect(place, &mut files)?;
        }
        let mut digest = Sha256::new();
        for file in files {
            let bytes = fs::read(&file)?;
            let name = file.strip_prefix(&self.root).unwrap_or(&file);
            let parts: Vec<_> = name.iter().map(|part| part.to_string_lossy()).collect();
            digest.update(format!("{}\0{}\0", parts.join("/"), bytes.len()));
            digest.update(bytes);
        }
        Ok(digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
    }
}

/// Names of the crates in a manifest's tables of dependencies, except in those for tests.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let mut is_listed = false;
    let mut names = BTreeSet::new();
    for line in manifest.lines().map(str::trim) {
        if let Some(table) = line.strip_prefix('[') {
            let table = table.trim_end_matches(']');
            is_listed = table.ends_with("dependencies") && table != "dev-dependencies";
        } else if is_listed {
            let name = line.split(['.', '=', ' ']).next().unwrap_or_default();
            names.extend(Some(name.to_owned()).filter(|name| !name.is_empty()));
        }
    }
    names
}

/// A file, or all files below a folder.
fn collect(place: &Path, files: &mut BTreeSet<PathBuf>) -> io::Result<()> {
    if !place.is_dir() {
        files.insert(place.to_owned());
        return Ok(());
    }
    for entry in fs::read_dir(place)? {
        collect(&entry?.path(), files)?;
    }
    Ok(())
}
