//! Files of the project as text.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

pub fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

pub fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

/// Files and folders directly in a folder, in order.
pub fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let failed = |error: io::Error| format!("{}: {error}", folder.display());
    let entries = fs::read_dir(folder).map_err(failed)?;
    let mut found: Vec<PathBuf> =
        entries.map(|entry| Ok(entry.map_err(failed)?.path())).collect::<Result<_, String>>()?;
    found.sort();
    Ok(found)
}

/// Makes a folder; files of an earlier run are removed.
pub fn emptied(folder: &Path) -> Result<(), String> {
    let gone = if folder.exists() { fs::remove_dir_all(folder) } else { Ok(()) };
    let made = gone.and_then(|()| fs::create_dir_all(folder));
    made.map_err(|error| format!("{}: {error}", folder.display()))
}

/// Kinds of files that people write.
const WRITTEN: [&str; 6] = ["rs", "ts", "svelte", "css", "py", "pyi"];

/// All source files below a folder, in order.
pub fn sources(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for path in entries(&folder)? {
            if path.is_dir() {
                folders.push(path);
            } else if is_written(&path) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

fn is_written(path: &Path) -> bool {
    let written = |end: &str| WRITTEN.contains(&end) && !path.ends_with("schema.d.ts");
    path.extension().and_then(|end| end.to_str()).is_some_and(written)
}
