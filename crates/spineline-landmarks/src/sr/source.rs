use std::path::Path;

use dicom_core::Tag;
use dicom_dictionary_std::tags;
use spineline::anatomy::Posture;
use spineline_files::FilmSource;
use spineline_films::intake::{IntakeLimits, read_plain};
use spineline_films::read_data_set;

use super::SourceImage;
use crate::LandmarkExportError;

/// Data that a report copies from the DICOM file of a radiograph; pixels are not read.
///
/// # Errors
/// [`LandmarkExportError::Source`] for a file that is not DICOM or lacks identifiers.
pub fn read_source(path: &Path) -> Result<SourceImage, LandmarkExportError> {
    parse_source(&bytes_of(path)?, &path.display().to_string())
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, LandmarkExportError> {
    let bytes = read_plain(path, &IntakeLimits::default());
    bytes.map_err(|error| LandmarkExportError::Source(error.to_string()))
}

/// The same of the film on which a case's landmarks were placed, as the case states its file.
///
/// # Errors
/// As [`read_source`], and [`LandmarkExportError::OtherFile`].
pub fn read_film_source(
    posture: Posture,
    stated: &FilmSource,
    path: &Path,
) -> Result<SourceImage, LandmarkExportError> {
    parse_film_source(posture, stated, &bytes_of(path)?, &path.display().to_string())
}

/// The same from the bytes of a file; errors use this name.
///
/// # Errors
/// As [`read_film_source`].
pub fn parse_film_source(
    posture: Posture,
    stated: &FilmSource,
    bytes: &[u8],
    name: &str,
) -> Result<SourceImage, LandmarkExportError> {
    match stated.other_bytes(bytes) {
        Some(why) => Err(LandmarkExportError::OtherFile { posture, why }),
        None => parse_source(bytes, name),
    }
}

/// [`read_source`] from the bytes of a file; errors use this name.
pub fn parse_source(bytes: &[u8], name: &str) -> Result<SourceImage, LandmarkExportError> {
    let unfit = |reason: &str| LandmarkExportError::Source(format!("{name}: {reason}"));
    let object = read_data_set(bytes).map_err(|error| unfit(&error.to_string()))?;
    let text = |tag: Tag| -> String {
        let value = object.get(tag).and_then(|element| element.to_str().ok());
        value.map(|text| text.trim_matches(['\0', ' ']).to_owned()).unwrap_or_default()
    };
    let side = |tag: Tag| object.get(tag).and_then(|element| element.to_int::<u32>().ok());
    let size = side(tags::COLUMNS).zip(side(tags::ROWS));
    let source = SourceImage {
        sop_class_uid: text(tags::SOP_CLASS_UID),
        sop_instance_uid: text(tags::SOP_INSTANCE_UID),
        study_instance_uid: text(tags::STUDY_INSTANCE_UID),
        series_instance_uid: text(tags::SERIES_INSTANCE_UID),
        modality: text(tags::MODALITY),
        size: size.ok_or_else(|| unfit("it contains no picture"))?,
        patient_name: text(tags::PATIENT_NAME),
        patient_id: text(tags::PATIENT_ID),
        patient_birth_date: text(tags::PATIENT_BIRTH_DATE),
        patient_sex: text(tags::PATIENT_SEX),
        study_date: text(tags::STUDY_DATE),
        study_time: text(tags::STUDY_TIME),
        study_id: text(tags::STUDY_ID),
        accession_number: text(tags::ACCESSION_NUMBER),
    };
    if source.sop_instance_uid.is_empty() || source.study_instance_uid.is_empty() {
        return Err(unfit("it lacks the identifiers of its study and itself"));
    }
    Ok(source)
}
