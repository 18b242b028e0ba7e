//! Films that may not belong to a case, by their files: another part of the body, or another patient.

use dicom_dictionary_std::tags::MODALITY;
use serde::{Deserialize, Serialize};
use spineline::warning::WarningCode;

use super::element::Attributes;
use super::patient::other_body_part;
use super::read::read_data_set;
use super::{FilmError, FilmFile, FilmRemark, PatientMarks};

/// Patient and part of the body, as a file states them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Stated {
    /// The patient, for comparison with other films.
    pub patient: PatientMarks,
    /// [`FilmRemark::OtherBodyPart`], where the file states one.
    pub other_part: Option<FilmRemark>,
}

impl Stated {
    /// The statements of a decoded film.
    #[must_use]
    pub fn of(film: &FilmFile) -> Self {
        Self::by_remarks(film.tags.patient, &film.remarks)
    }

    /// The statements of a film with known remarks.
    #[must_use]
    pub fn by_remarks(patient: PatientMarks, remarks: &[FilmRemark]) -> Self {
        let is_other_part = |remark: &&FilmRemark| remark.is_other_body_part();
        Self { patient, other_part: remarks.iter().find(is_other_part).cloned() }
    }

    /// The statements of a DICOM file; its pixels are not decoded.
    ///
    /// # Errors
    /// [`FilmError`] for files that are not DICOM, or invalid.
    pub fn read(bytes: &[u8]) -> Result<Self, FilmError> {
        let data = read_data_set(bytes)?;
        let modality = data.text(MODALITY);
        let other_part = other_body_part(&data, modality.as_deref());
        Ok(Self { patient: PatientMarks::read(&data), other_part })
    }
}

/// Why a film may not belong to a case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FilmDoubt {
    /// [`WarningCode::OtherBodyPart`] or [`WarningCode::PatientDiffers`].
    pub code: WarningCode,
    /// What is wrong, without the patient's identity.
    pub text: String,
}

/// Doubts about each film of a case, by the films' names (such as "erect film") and the statements of their files.
///
/// ```
/// use spineline_films::{Stated, film_doubts};
/// // Files that state nothing give no doubt.
/// let films = [("erect film".to_owned(), Stated::default()), ("neutral film".to_owned(), Stated::default())];
/// assert!(film_doubts(&films).iter().all(Vec::is_empty));
/// ```
#[must_use]
pub fn film_doubts(films: &[(String, Stated)]) -> Vec<Vec<FilmDoubt>> {
    let of_film = |(i, (_, stated)): (usize, &(String, Stated))| {
        let part = stated
            .other_part
            .as_ref()
            .map(|remark| FilmDoubt { code: WarningCode::OtherBodyPart, text: remark.to_string() });
        let patient = films[..i].iter().find_map(|(name, earlier)| {
            let text = contradiction(name, &earlier.patient.differences(&stated.patient))?;
            Some(FilmDoubt { code: WarningCode::PatientDiffers, text })
        });
        part.into_iter().chain(patient).collect()
    };
    films.iter().enumerate().map(of_film).collect()
}

fn contradiction(other: &str, found: &[&str]) -> Option<String> {
    let verb = match found.len() {
        0 => return None,
        1 => "differs",
        _ => "differ",
    };
    Some(format!(
        "{} {verb} from the {other} in the files: the films may show two patients",
        found.join(" and ")
    ))
}
