//! The target of a result's path, and the targets that are refused.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use spineline_files::SQLITE_SIGNATURE;
use spineline_films::is_own_dicom;

use crate::run::failure::Failure;

/// Links that are followed at most.
const MAX_LINKS: usize = 40;
/// Ends of the files that lie beside a store while it is in use.
const BESIDE_STORE: [&str; 4] = ["-wal", "-shm", "-journal", "-head"];

/// How a result gets to its path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// Printed to the standard output.
    StandardOutput,
    /// Written into what is there: a pipe, a terminal, a null device. It is never replaced.
    Into(PathBuf),
    /// A file that is made or replaced as a whole, behind all links.
    File(PathBuf),
}

/// Whether a path stands for the standard output.
pub fn is_stdout(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path == Path::new(name))
}

impl Target {
    /// Follows links and looks at what is there.
    ///
    /// # Errors
    /// If it is a folder, a disk, a socket or a store of studies, or links lead in a circle.
    pub fn of(path: &Path) -> Result<Self, Failure> {
        if is_stdout(path) {
            return Ok(Self::StandardOutput);
        }
        // Other open streams are what they were opened as, even where that is a file.
        if path.starts_with("/dev/fd")
            || path.starts_with("/proc")
            || path == Path::new("/dev/stderr")
        {
            return Ok(Self::Into(path.to_owned()));
        }
        let file = behind_links(path)?;
        match fs::metadata(&file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                refuse_store(path, &file)?;
                Ok(Self::File(file))
            }
            Err(error) => Err(Failure::write(&path.display().to_string(), &error)),
            Ok(found) if found.is_dir() => {
                let error = io::Error::from(io::ErrorKind::IsADirectory);
                Err(Failure::write(&path.display().to_string(), &error))
            }
            Ok(found) if found.is_file() => {
                refuse_store(path, &file)?;
                Ok(Self::File(file))
            }
            Ok(found) if is_stream(&found) => Ok(Self::Into(file)),
            Ok(_) => Err(Failure::target(
                path,
                "it is a disk or a socket",
                "name a file, a pipe or `-` for the standard output",
            )),
        }
    }
}

fn behind_links(path: &Path) -> Result<PathBuf, Failure> {
    let mut file = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&file) {
            // A relative link counts from its own folder.
            Ok(next) => file = file.parent().unwrap_or(Path::new("")).join(next),
            Err(_) => return Ok(file),
        }
    }
    Err(Failure::target(path, "its links lead in a circle", "name a file"))
}

#[cfg(unix)]
fn is_stream(found: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    found.file_type().is_char_device() || found.file_type().is_fifo()
}

#[cfg(not(unix))]
fn is_stream(_found: &fs::Metadata) -> bool {
    true
}

/// A store holds the only copy of what people marked, and is written by its own commands alone.
fn refuse_store(path: &Path, file: &Path) -> Result<(), Failure> {
    let name = file.to_string_lossy();
    let beside = BESIDE_STORE.iter().find_map(|end| name.strip_suffix(end)).map(PathBuf::from);
    if is_database(file) || beside.is_some_and(|store| is_database(&store)) {
        return Err(Failure::target(path, "it is a store of studies", "name another file"));
    }
    Ok(())
}

/// A film may be the only copy. What this program made may be replaced: films of phantoms, and reports of landmarks.
///
/// # Errors
/// For another DICOM file.
pub(super) fn refuse_film(path: &Path, file: &Path) -> Result<(), Failure> {
    let mut start = [0; 132];
    let read = File::open(file).and_then(|mut file| file.read_exact(&mut start));
    if read.is_err() || !start.ends_with(b"DICM") {
        return Ok(());
    }
    if fs::read(file).is_ok_and(|bytes| is_own_dicom(&bytes)) {
        return Ok(());
    }
    Err(Failure::target(path, "it is a film, which would be destroyed", "name another file"))
}

fn is_database(file: &Path) -> bool {
    let mut start = [0; SQLITE_SIGNATURE.len()];
    let read = File::open(file).and_then(|mut file| file.read_exact(&mut start));
    read.is_ok() && start == *SQLITE_SIGNATURE
}

/// Follows all links of a folder's path, up to the first part that does not exist.
fn canonical(folder: &Path) -> PathBuf {
    folder.canonicalize().unwrap_or_else(|_| match (folder.parent(), folder.file_name()) {
        (Some(around), Some(name)) if !around.as_os_str().is_empty() => {
            canonical(around).join(name)
        }
        (_, Some(name)) => canonical(Path::new(".")).join(name),
        _ => folder.to_owned(),
    })
}

/// Whether two paths lead to one file, however they are written.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    Identity::of(one).is(&Identity::of(other))
}

/// The identity of a file, the same through links of both kinds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    path: PathBuf,
    #[cfg(unix)]
    node: Option<(u64, u64)>,
}

impl Identity {
    /// Of a file that may not be there yet.
    pub fn of(file: &Path) -> Self {
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let folder = canonical(folder);
        let path = file
            .canonicalize()
            .unwrap_or_else(|_| folder.join(file.file_name().unwrap_or_default()));
        Self {
            path,
            #[cfg(unix)]
            node: fs::metadata(file).ok().map(|found| {
                use std::os::unix::fs::MetadataExt;
                (found.dev(), found.ino())
            }),
        }
    }

    /// Its path with upper and lower case as one, as some disks have it.
    pub fn name(&self) -> String {
        self.path.to_string_lossy().to_lowercase()
    }

    /// Whether both are one file, here or on a disk for which upper and lower case are one.
    pub fn is_alike(&self, other: &Self) -> bool {
        self.is(other) || self.name() == other.name()
    }

    /// Whether both are one file.
    pub fn is(&self, other: &Self) -> bool {
        #[cfg(unix)]
        if self.node.is_some() && self.node == other.node {
            return true;
        }
        self.path == other.path
    }
}
