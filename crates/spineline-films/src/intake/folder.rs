//! Files and folders.

use std::fs::{self, File};
use std::path::Path;

use super::archive;
use super::search::{IntakeError, Place, Reason, Surveyor, head_of};

/// Files everything at and below a path. A given path may be a link; links below it are not followed.
pub(super) fn walk(
    surveyor: &mut Surveyor,
    path: &Path,
    seen: &mut impl FnMut(usize),
) -> Result<(), IntakeError> {
    let missing = |error: std::io::Error| IntakeError::Missing {
        place: Place::File(path.to_owned()),
        kind: error.kind(),
    };
    if !fs::metadata(path).map_err(missing)?.is_dir() {
        surveyor.count()?;
        look(surveyor, path, seen)?;
        return Ok(());
    }
    let depth = surveyor.limits.depth;
    let entries = walkdir::WalkDir::new(path)
        .follow_links(false)
        .follow_root_links(true)
        .sort_by_file_name()
        // One level more, so that deeper files are reported.
        .max_depth(depth + 1);
    for entry in entries {
        surveyor.count()?;
        let entry = match entry {
            Ok(entry) => entry,
            Err(error) => {
                let kind = error.io_error().map_or(std::io::ErrorKind::Other, |e| e.kind());
                let place = error.path().unwrap_or(path).to_owned();
                surveyor.pass_over(Place::File(place), Reason::Unreadable(kind));
                continue;
            }
        };
        if entry.depth() > depth {
            let place = Place::File(entry.path().to_owned());
            surveyor.pass_over(place, Reason::TooDeep { limit: depth });
        } else if entry.file_type().is_file() {
            look(surveyor, entry.path(), seen)?;
        } else if !entry.file_type().is_dir() {
            surveyor.pass_over(Place::File(entry.path().to_owned()), Reason::NotPlain);
        }
    }
    Ok(())
}

/// Files one file, or every entry of it if it is an archive.
fn look(
    surveyor: &mut Surveyor,
    path: &Path,
    seen: &mut impl FnMut(usize),
) -> Result<(), IntakeError> {
    seen(surveyor.looked_at);
    let place = Place::File(path.to_owned());
    let metadata = match fs::metadata(path) {
        // Reading a pipe could block forever.
        Ok(metadata) if !metadata.is_file() => {
            surveyor.pass_over(place, Reason::NotPlain);
            return Ok(());
        }
        Ok(metadata) => metadata,
        Err(error) => {
            surveyor.pass_over(place, Reason::Unreadable(error.kind()));
            return Ok(());
        }
    };
    match File::open(path).and_then(head_of) {
        Ok(head) if archive::is_archive(&head) => archive::walk(surveyor, path)?,
        Ok(head) => surveyor.file(place, metadata.len(), &head),
        Err(error) => surveyor.pass_over(place, Reason::Unreadable(error.kind())),
    }
    Ok(())
}
