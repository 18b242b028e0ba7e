//! ZIP archives, read without unpacking.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use zip::ZipArchive;
use zip::read::ZipFile;
use zip::result::ZipError;

use super::search::{IntakeError, IntakeLimits, Place, Reason, Surveyor, head_of, read_limited};

type Archive = ZipArchive<BufReader<File>>;

/// Whether a file begins as a ZIP archive does, an empty one included.
pub(super) fn is_archive(head: &[u8]) -> bool {
    head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06")
}

/// Files every entry of an archive.
pub(super) fn walk(surveyor: &mut Surveyor, path: &Path) -> Result<(), IntakeError> {
    let mut archive = match open(path) {
        Ok(archive) => archive,
        Err(reason) => {
            surveyor.pass_over(Place::File(path.to_owned()), reason);
            return Ok(());
        }
    };
    let mut unpacked: u64 = 0;
    for index in 0..archive.len() {
        surveyor.count()?;
        let place = Place::Entry { archive: path.to_owned(), index };
        match look(&mut archive, index) {
            Ok(None) => {}
            Ok(Some(entry)) => {
                // Declared size of an entry; reading stops there.
                unpacked = unpacked.saturating_add(entry.bytes);
                let limit = surveyor.limits.archive_bytes;
                if unpacked > limit {
                    surveyor.pass_over(place, Reason::ArchiveTooLarge { limit });
                } else {
                    surveyor.file(place, entry.bytes, &entry.head);
                }
            }
            Err(reason) => surveyor.pass_over(place, reason),
        }
    }
    Ok(())
}

/// The bytes of one entry.
pub(super) fn read(path: &Path, index: usize, limits: &IntakeLimits) -> Result<Vec<u8>, Reason> {
    let mut archive = open(path)?;
    let entry = archive.by_index(index).map_err(|error| reason(&error))?;
    // An entry may unpack to more than its declared size.
    let limit = limits.entry_bytes.min(entry.size());
    read_limited(entry, limit)
}

fn open(path: &Path) -> Result<Archive, Reason> {
    let file = File::open(path).map_err(|error| Reason::Unreadable(error.kind()))?;
    let archive = ZipArchive::new(BufReader::new(file)).map_err(|error| reason(&error))?;
    // The library's list contains only the last entry of a name.
    if archive.has_duplicate_names() { Err(Reason::SameNames) } else { Ok(archive) }
}

/// The properties of an entry that a survey needs.
struct Entry {
    bytes: u64,
    head: Vec<u8>,
}

/// `None` for a folder.
fn look(archive: &mut Archive, index: usize) -> Result<Option<Entry>, Reason> {
    let entry = archive.by_index(index).map_err(|error| reason(&error))?;
    if !has_plain_name(&entry) {
        return Err(Reason::UnsafeName);
    }
    if entry.is_dir() {
        return Ok(None);
    }
    if entry.is_symlink() {
        return Err(Reason::NotPlain);
    }
    let bytes = entry.size();
    let head = head_of(entry).map_err(|_| Reason::Damaged)?;
    if is_archive(&head) {
        return Err(Reason::Nested);
    }
    Ok(Some(Entry { bytes, head }))
}

/// Names are never used as paths, but an entry with `../` is not a film.
fn has_plain_name<R: std::io::Read + ?Sized>(entry: &ZipFile<'_, R>) -> bool {
    let Ok(name) = entry.name() else { return false };
    let drive = name.as_bytes().get(1) == Some(&b':');
    let parts_are_names = name.split(['/', '\\']).all(|part| part != "..");
    !name.starts_with(['/', '\\']) && !drive && !name.contains('\0') && parts_are_names
}

fn reason(error: &ZipError) -> Reason {
    match error {
        ZipError::UnsupportedArchive(text) if *text == ZipError::PASSWORD_REQUIRED => {
            Reason::Encrypted
        }
        ZipError::Io(error) => Reason::Unreadable(error.kind()),
        _ => Reason::Damaged,
    }
}
