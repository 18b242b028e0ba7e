//! Whether this program wrote a file, so that running a command again may replace it.

use std::fs;
use std::path::Path;

use serde_json::Value;
use spineline_files::sha256_hex;

/// What every file says that names the program which wrote it, before the version.
const GENERATORS: [&str; 3] =
    ["\"program\": \"spineline ", "\"program\":\"spineline ", "spineline 0."];
/// Landmarks are the work of people, whoever wrote the file.
const CASE: &str = "\"format\": \"spineline-case\"";
/// Classes of DICOM reports, which this program makes; films, which it does not, have others.
const REPORTS: &str = "1.2.840.10008.5.1.4.1.1.88.";
/// The format of a file begins within so many bytes.
const HEAD_BYTES: usize = 400;

/// Whether a file is a result of this program: it says so itself, or a provenance file in its folder lists it as it is.
///
/// Cases and films never are. `path` may lead to `file` by links, and has the list beside it.
pub fn is_result(path: &Path, file: &Path) -> bool {
    fs::read(file).is_ok_and(|bytes| {
        says_so(&bytes) || is_listed(path, &bytes) || (path != file && is_listed(file, &bytes))
    })
}

fn says_so(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD_BYTES)]);
    if head.contains(CASE) {
        return false;
    }
    let text = String::from_utf8_lossy(bytes);
    if bytes.get(128..132) == Some(b"DICM") && !text.contains(REPORTS) {
        return false;
    }
    GENERATORS.iter().any(|generator| text.contains(generator))
}

/// Provenance files name other files with the SHA-256 of what was written.
fn is_listed(file: &Path, bytes: &[u8]) -> bool {
    let (Some(folder), Some(name)) = (file.parent(), file.file_name()) else { return false };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(entries) = fs::read_dir(folder) else { return false };
    let name = name.to_string_lossy();
    let hash = sha256_hex(bytes);
    entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.to_string_lossy().ends_with("provenance.json"))
        .filter_map(|path| serde_json::from_slice::<Value>(&fs::read(path).ok()?).ok())
        .any(|list| {
            let files = list["of"].as_array();
            files.is_some_and(|files| {
                files.iter().any(|one| one["name"] == *name && one["sha256"] == hash)
            })
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_say_so_and_cases_and_films_are_none() {
        for (text, expected) in [
            ("{\"provenance\": {\"program\": \"spineline 0.1.0\"}}", true),
            ("<!-- spineline 0.1.0 -->", true),
            ("{\n  \"format\": \"spineline-case\",\n  \"program\": \"spineline 0.1.0\"}", false),
            ("level,y_mm\nT2,1\n", false),
        ] {
            assert_eq!(says_so(text.as_bytes()), expected, "{text}");
        }
        let film = [&[0; 128][..], b"DICM spineline 0.1.0"].concat();
        assert!(!says_so(&film));
        assert!(says_so(&[&film[..], REPORTS.as_bytes()].concat()));
    }
}
