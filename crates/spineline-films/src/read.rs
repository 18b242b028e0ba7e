//! Reading a film of any kind.

use dicom_dictionary_std::tags::MANUFACTURER;
use dicom_object::InMemDicomObject;

use super::error::{FilmError, Measure};
use super::{FilmFile, FilmKind, FilmLimits, container, element, pixels, raster, tags};

/// Reads a film of any supported format.
///
/// # Errors
/// [`FilmError`]; never panics, and uses at most `limits` and a few times the file's size of memory.
pub fn read_film(bytes: &[u8], limits: &FilmLimits) -> Result<FilmFile, FilmError> {
    Measure::FileBytes.within(bytes.len() as u64, limits.file_bytes)?;
    match container::sniff(bytes)? {
        FilmKind::Dicom => read_dicom(bytes, limits),
        kind => raster::read(bytes, kind, limits),
    }
}

/// The data set of any DICOM file, without uncompressed pixels, after the same checks as a film.
///
/// # Errors
/// [`FilmError`] for files that are not DICOM, or invalid.
pub fn read_data_set(bytes: &[u8]) -> Result<InMemDicomObject, FilmError> {
    match container::sniff(bytes)? {
        FilmKind::Dicom => {}
        kind => return Err(FilmError::NotDicom { kind }),
    }
    let limits = FilmLimits::default();
    let container::Container { syntax, body, .. } = container::open(bytes, &limits)?;
    Ok(element::parse(&body, syntax.encoding, &limits)?.object)
}

/// Whether Spineline made a DICOM file: the film of a phantom, or a report of landmarks.
#[must_use]
pub fn is_own_dicom(bytes: &[u8]) -> bool {
    let Ok(data) = read_data_set(bytes) else { return false };
    let maker = data.get(MANUFACTURER).and_then(|element| element.to_str().ok());
    maker.is_some_and(|maker| maker.starts_with("Spineline"))
}

fn read_dicom(bytes: &[u8], limits: &FilmLimits) -> Result<FilmFile, FilmError> {
    let container::Container { syntax, body, mut remarks } = container::open(bytes, limits)?;
    let data = element::parse(&body, syntax.encoding, limits)?;
    let (mut tags, look) = tags::read(&data, syntax.name, &mut remarks)?;
    let picture = pixels::read(&data, &syntax, tags.photometric, limits, &mut remarks)?;
    tags.bits_stored = picture.bits_stored;
    Ok(FilmFile {
        kind: FilmKind::Dicom,
        columns: picture.columns,
        rows: picture.rows,
        stored: picture.stored,
        tags,
        look,
        remarks,
    })
}
