use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::FileError;
use crate::table_text::is_utf_16;

/// The first bytes of an SQLite file, such as a store of studies.
pub const SQLITE_SIGNATURE: &[u8; 16] = b"SQLite format 3\0";
/// Largest file of one record, in bytes: a case, a model, a load, a stiffness table or a table of readings.
pub const MAX_FILE_BYTES: u64 = 64 << 20;
/// Largest file that `rerun` reads, in bytes: the analyses of a whole cohort, or a report that contains them.
pub const MAX_ANALYSES_BYTES: u64 = 256 << 20;

/// Reads a text file whole, if it has at most [`MAX_FILE_BYTES`].
///
/// # Errors
/// [`FileError::Read`], [`FileError::TooLarge`], [`FileError::NotUtf8`], [`FileError::Database`].
pub fn read_text(path: &Path) -> Result<String, FileError> {
    text_of(path, read_bytes(path, MAX_FILE_BYTES)?)
}

/// The text of a file from its bytes.
///
/// # Errors
/// [`FileError::NotUtf8`], [`FileError::Database`].
pub fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String, FileError> {
    if bytes.starts_with(SQLITE_SIGNATURE) {
        return Err(FileError::Database { path: path.to_owned() });
    }
    let utf_16 = is_utf_16(&bytes);
    let refused = |at| FileError::NotUtf8 { path: path.to_owned(), at, utf_16 };
    match String::from_utf8(bytes) {
        // UTF-16 without a mark is UTF-8 with a zero beside every letter.
        Ok(text) if utf_16 => Err(refused(text.find('\0').unwrap_or(0) + 1)),
        Ok(text) => Ok(text),
        Err(error) => Err(refused(error.utf8_error().valid_up_to() + 1)),
    }
}

/// Reads a file whole, if it has at most `limit` bytes. A pipe or a device, which states no size, is read up to the limit.
///
/// # Errors
/// [`FileError::Read`], [`FileError::TooLarge`].
pub fn read_bytes(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let failed = |source| FileError::Read { path: path.to_owned(), source };
    let too_large = |bytes| FileError::TooLarge { path: path.to_owned(), bytes, limit };
    let file = File::open(path).map_err(failed)?;
    let stated = file.metadata().map_err(failed)?;
    if stated.is_file() && stated.len() > limit {
        return Err(too_large(Some(stated.len())));
    }
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > limit {
        return Err(too_large(None));
    }
    Ok(bytes)
}
