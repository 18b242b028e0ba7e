//! Several files as one download.

use std::io::{Cursor, Write};

use spineline_files::{InputFile, Provenance, ProvenanceFile, to_text, with_hash};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::file::{Download, ZIP, internal};
use crate::problem::Answer;

/// An archive of files, with a list of them and their provenance. The same files give the same bytes except for the
/// date.
pub fn archive(
    ending: &'static str,
    files: Vec<(String, Vec<u8>)>,
    provenance: Provenance,
) -> Answer<Download> {
    let list = files.iter().map(|(name, bytes)| InputFile::of(name.as_str(), bytes)).collect();
    let list = with_hash(to_text(&ProvenanceFile::new(list, provenance)).into_bytes());
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files.into_iter().chain([("provenance.json".to_owned(), list)]) {
        writer.start_file(name, SimpleFileOptions::default()).map_err(|error| internal(&error))?;
        writer.write_all(&bytes).map_err(|error| internal(&error))?;
    }
    let bytes = writer.finish().map_err(|error| internal(&error))?.into_inner();
    Ok(Download { ending, kind: ZIP, bytes })
}
