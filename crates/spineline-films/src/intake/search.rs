//! A search: its limits, its results and its state.

use std::fmt;
use std::io::{ErrorKind, Read};
use std::path::PathBuf;

use crate::error::system_words;
use crate::{FilmError, FilmKind, Lookalike, sniff};

/// Limits of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IntakeLimits {
    /// Maximum number of files and archive entries.
    pub entries: usize,
    /// Bytes of one file or unpacked entry.
    pub entry_bytes: u64,
    /// Bytes that all entries of one archive may unpack to.
    pub archive_bytes: u64,
    /// Depth of folders.
    pub depth: usize,
}

impl Default for IntakeLimits {
    fn default() -> Self {
        Self { entries: 100_000, entry_bytes: 256 << 20, archive_bytes: 4 << 30, depth: 32 }
    }
}

/// Where a film lies.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// A file.
    File(PathBuf),
    /// An entry of an archive, by its number there.
    Entry {
        /// The archive.
        archive: PathBuf,
        /// Place in the archive's own list.
        index: usize,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            // The entry's name may be anything, such as a patient's name.
            Self::Entry { archive, index } => {
                write!(f, "{}, entry {}", archive.display(), index + 1)
            }
        }
    }
}

/// A film that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// Where.
    pub place: Place,
    /// Kind by its first bytes.
    pub kind: FilmKind,
    /// Its size.
    pub bytes: u64,
}

/// A found file that is not a film.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PassedOver {
    /// Where.
    pub place: Place,
    /// Why.
    pub reason: Reason,
}

/// Why a file was skipped.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// It is something else.
    #[error("it {0}")]
    NotAFilm(Lookalike),
    /// It could not be read.
    #[error("it cannot be read: {}", system_words(*.0))]
    Unreadable(ErrorKind),
    /// A link, a device or a pipe.
    #[error("it is not a regular file")]
    NotPlain,
    /// Too large for a film.
    #[error("it has {bytes} bytes, and the limit is {limit}")]
    TooLarge {
        /// Its size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// A name that leads out of the archive, or that files cannot have.
    #[error("its name in the archive is not a plain file name")]
    UnsafeName,
    /// Two entries of an archive with one name.
    #[error(
        "two of its entries have the same name, so that one of them cannot be read: give each film a name and pack it again"
    )]
    SameNames,
    /// An encrypted entry.
    #[error("it is encrypted")]
    Encrypted,
    /// An archive in an archive.
    #[error("it is an archive within an archive")]
    Nested,
    /// A broken archive or entry.
    #[error("the archive is damaged here, or packed in an unsupported way")]
    Damaged,
    /// Folders nested too deeply.
    #[error("it lies deeper than {limit} folders")]
    TooDeep {
        /// The limit.
        limit: usize,
    },
    /// The archive unpacks to more than its limit.
    #[error("its archive unpacks to more than {limit} bytes")]
    ArchiveTooLarge {
        /// The limit.
        limit: u64,
    },
}

spineline::faults! {
    /// Error that stops a search.
    #[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
    #[non_exhaustive]
    pub enum IntakeError {
        /// A given path does not open.
        #[error("{place}: {}", system_words(*kind))]
        #[help("check the path, and that you may read it")]
        Missing {
            /// The path.
            place: Place,
            kind: ErrorKind,
        },
        /// Too many files.
        #[error("there are more than {limit} files and archive entries here")]
        #[help("name the patient's own folder, or the films one by one")]
        TooMany {
            limit: usize,
        },
        /// A film that cannot be read: it is too large, or it changed or went away after the survey.
        #[error("{place}: {reason}")]
        #[help(match reason {
            Reason::SameNames => "give each film its own name and pack the archive again",
            Reason::NotPlain => "put the film itself there, and not a pipe or a device",
            Reason::TooLarge { .. } => "check that it is a film; export only the frontal film",
            Reason::Unreadable(ErrorKind::NotFound) => "check the path; the films of a case lie in the folder of the case",
            Reason::Unreadable(ErrorKind::PermissionDenied) => "check that you may read it",
            Reason::Unreadable(ErrorKind::IsADirectory) => "name the film or the case file in the folder",
            _ => "run the command again when no other program writes there",
        })]
        Gone {
            place: Place,
            reason: Reason,
        },
    }
}

/// Result of a search, in the order of the paths and of their names.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Survey {
    /// The films.
    pub films: Vec<Found>,
    /// Everything else.
    pub passed_over: Vec<PassedOver>,
}

/// State of a search.
pub(super) struct Surveyor {
    pub limits: IntakeLimits,
    pub looked_at: usize,
    pub survey: Survey,
}

impl Surveyor {
    /// Counts one more file or entry.
    pub fn count(&mut self) -> Result<(), IntakeError> {
        self.looked_at += 1;
        if self.looked_at > self.limits.entries {
            return Err(IntakeError::TooMany { limit: self.limits.entries });
        }
        Ok(())
    }

    pub fn pass_over(&mut self, place: Place, reason: Reason) {
        self.survey.passed_over.push(PassedOver { place, reason });
    }

    /// Classifies a file by its first bytes.
    pub fn file(&mut self, place: Place, bytes: u64, head: &[u8]) {
        if bytes > self.limits.entry_bytes {
            let limit = self.limits.entry_bytes;
            return self.pass_over(place, Reason::TooLarge { bytes, limit });
        }
        match sniff(head) {
            Ok(kind) => self.survey.films.push(Found { place, kind, bytes }),
            Err(FilmError::NotAFilm { looks_like }) => {
                self.pass_over(place, Reason::NotAFilm(looks_like));
            }
            Err(_) => self.pass_over(place, Reason::Damaged),
        }
    }
}

/// The first bytes of a stream, which show its kind.
pub(super) fn head_of(stream: impl Read) -> Result<Vec<u8>, std::io::Error> {
    const ENOUGH: u64 = 4096;
    let mut head = Vec::new();
    stream.take(ENOUGH).read_to_end(&mut head)?;
    Ok(head)
}

/// A whole stream, if it is within a limit.
pub(super) fn read_limited(stream: impl Read, limit: u64) -> Result<Vec<u8>, Reason> {
    let mut bytes = Vec::new();
    let read = stream.take(limit + 1).read_to_end(&mut bytes);
    read.map_err(|error| Reason::Unreadable(error.kind()))?;
    match bytes.len() as u64 {
        more if more > limit => Err(Reason::TooLarge { bytes: more, limit }),
        _ => Ok(bytes),
    }
}
