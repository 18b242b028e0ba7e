//! The one way in which results leave the program: whole files, or the standard output.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use spineline_files::{InputFile, Provenance, ProvenanceFile, to_text};
use spineline_report::document::Notice;
use spineline_report::terminal;

use super::failure::{Ending, Failure};
use super::interrupt;
use super::messages::say;

/// Whether a path stands for the standard output.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Writes to the standard output; a closed pipe is no error.
///
/// # Errors
/// If it cannot be written.
pub fn print(text: &str) -> Result<Ending, Failure> {
    let mut output = io::stdout().lock();
    // What is still held back at the end of the program is lost without a word where the disk is full.
    shown(output.write_all(text.as_bytes()).and_then(|()| output.flush()))
}

/// Whether what was written to the standard output is there; a closed pipe is no error.
///
/// # Errors
/// If it could not be written.
pub fn shown(written: io::Result<()>) -> Result<Ending, Failure> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::write("standard output", &error))
        }
        _ => Ok(Ending::Done),
    }
}

/// Writes notices to the standard error, one line each, so that other programs can read them by line.
pub fn print_notices(notices: &[Notice]) {
    for notice in notices {
        say(&terminal::notice(notice, usize::MAX));
    }
}

/// Writes a file as a whole and makes its folder: a reader never sees half of it.
///
/// The only place that writes files of results.
///
/// # Errors
/// If it cannot be written.
pub fn write_file(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    interrupt::begin_writing();
    let failed = |error: &io::Error| Failure::write(&path.display().to_string(), error);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(|error| failed(&error))?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".spineline-").suffix(".part");
    // A temporary file is its owner's alone; a result has the permissions of an ordinary new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let part = builder.tempfile_in(folder).map_err(|error| failed(&error))?;
    part.as_file().write_all(content.as_ref()).map_err(|error| failed(&error))?;
    part.persist(path).map(|_| ()).map_err(|error| failed(&error.error))
}

/// Writes a file, or to the standard output for `-`.
///
/// # Errors
/// If it cannot be written.
pub fn write_or_print(path: &Path, text: &str) -> Result<(), Failure> {
    if is_stdout(path) { print(text).map(|_| ()) } else { write_file(path, text) }
}

/// Writes a table and, in a file beside it, its provenance, so that other programs read the table unchanged; `-` writes the
/// table alone to the standard output.
///
/// # Errors
/// If they cannot be written.
pub fn write_table(path: &Path, text: &str, provenance: &Provenance) -> Result<(), Failure> {
    if is_stdout(path) {
        print(text).map(|_| ())
    } else {
        write_beside(path, text.as_bytes(), provenance)
    }
}

/// Writes a file that has no place for its provenance, and the provenance beside it.
///
/// # Errors
/// If they cannot be written.
pub fn write_beside(path: &Path, content: &[u8], provenance: &Provenance) -> Result<(), Failure> {
    write_file(path, content)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let file = ProvenanceFile::new(vec![InputFile::of(&*name, content)], provenance.clone());
    write_file(&beside(path), to_text(&file))
}

/// `errors.csv` has `errors.csv.provenance.json` beside it.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".provenance.json");
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_as_a_whole_with_ordinary_permissions() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("new/result.txt");
        for content in ["a longer first content", "second"] {
            write_file(&path, content).expect("written");
            assert_eq!(fs::read_to_string(&path).expect("there"), content);
        }
        let inside = fs::read_dir(path.parent().expect("a folder")).expect("entries").count();
        assert_eq!(inside, 1, "no temporary file is left");
        let ordinary = folder.path().join("ordinary.txt");
        fs::write(&ordinary, "").expect("written");
        let permissions = |path: &Path| fs::metadata(path).expect("there").permissions();
        assert_eq!(permissions(&path), permissions(&ordinary));
    }
}
