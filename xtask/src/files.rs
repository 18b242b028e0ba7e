//! Files of the project as text.

use std::fs;
use std::path::{Path, PathBuf};

pub fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

pub fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

/// Kinds of files that people write.
const WRITTEN: [&str; 6] = ["rs", "ts", "svelte", "css", "py", "pyi"];

/// All source files below a folder, in order.
pub fn sources(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let entries =
            fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        for entry in entries {
            let path = entry.map_err(|error| error.to_string())?.path();
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
