//! The kind of a file that a result would replace.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use spineline_files::{Content, case_ids, parse_provenance, sha256_hex};

/// A file that is there already.
pub enum There {
    /// A result as this program wrote it, of these cases.
    Result(BTreeSet<String>),
    /// A result that was changed since.
    Changed,
    /// Anything else, such as a case or a film.
    Other,
}

impl There {
    /// A result has the hash of its content, or a provenance file in its folder lists it as it is. `path` may lead to `file` by links, and has the list
    /// beside it.
    pub fn of(path: &Path, file: &Path) -> Self {
        let Ok(bytes) = fs::read(file) else { return Self::Other };
        let content = Content::of(&bytes);
        if content == Content::AsWritten {
            return Self::Result(case_ids(&bytes));
        }
        match (listed(path, &bytes).or_else(|| listed(file, &bytes)), content) {
            (Some(cases), _) => Self::Result(cases),
            (None, Content::Changed) => Self::Changed,
            (None, _) => Self::Other,
        }
    }
}

/// The cases of the provenance file that names a file with the SHA-256 of what is there.
fn listed(file: &Path, bytes: &[u8]) -> Option<BTreeSet<String>> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let name = file.file_name()?.to_string_lossy();
    let hash = sha256_hex(bytes);
    fs::read_dir(folder.unwrap_or(Path::new(".")))
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.to_string_lossy().ends_with("provenance.json"))
        .filter_map(|path| parse_provenance(&fs::read_to_string(path).ok()?).ok())
        .find(|list| list.files.iter().any(|one| one.name == *name && one.sha256 == hash))
        .map(|list| list.provenance().case_ids.iter().cloned().collect())
}
