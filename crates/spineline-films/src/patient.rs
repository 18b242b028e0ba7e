//! Patient and part of the body by the file, to notice a film of another patient or part.

use dicom_core::Tag;
use dicom_dictionary_std::tags;
use dicom_object::InMemDicomObject;
use serde::{Deserialize, Serialize};

use super::FilmRemark;
use super::element::Attributes;
use super::exposure::hash;

/// Values of Body Part Examined in DICOM PS3.16, annex L, that exclude a spine from L4 to T2.
const OTHER_PARTS: [&str; 41] = [
    "ANKLE",
    "ARM",
    "BREAST",
    "CALCANEUS",
    "CALF",
    "CAROTID",
    "CLAVICLE",
    "EAR",
    "ELBOW",
    "EXTREMITY",
    "EYE",
    "FACE",
    "FEMUR",
    "FINGER",
    "FOOT",
    "FOREARM",
    "FOREFOOT",
    "HAND",
    "HEAD",
    "HIP",
    "HUMERUS",
    "JAW",
    "KNEE",
    "LEG",
    "LOWERLEG",
    "LOWERLIMB",
    "MANDIBLE",
    "NOSE",
    "ORBIT",
    "PATELLA",
    "RADIUS",
    "SCAPULA",
    "SHOULDER",
    "SKULL",
    "THIGH",
    "THUMB",
    "TIBIA",
    "TOE",
    "ULNA",
    "WRIST",
    "ZYGOMA",
];

/// Identity of a patient as two files state it, only for comparison. Never written to a file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PatientMarks {
    id: Option<u64>,
    birth_date: Option<u64>,
    sex: Option<u64>,
}

impl PatientMarks {
    pub(super) fn read(data: &InMemDicomObject) -> Self {
        let mark = |tag: Tag| data.text(tag).map(|text| mark(&text));
        Self {
            id: mark(tags::PATIENT_ID),
            birth_date: mark(tags::PATIENT_BIRTH_DATE),
            sex: mark(tags::PATIENT_SEX),
        }
    }

    /// The identity that an archive states by a Patient ID alone.
    #[must_use]
    pub fn of_id(patient_id: &str) -> Self {
        let id = patient_id.trim_matches([' ', '\0']);
        Self { id: (id.is_ascii() && !id.is_empty()).then(|| mark(id)), ..Self::default() }
    }

    /// Names of the attributes that both files state differently.
    ///
    /// ```
    /// use spineline_films::PatientMarks;
    /// // Missing values do not differ.
    /// assert!(PatientMarks::default().differences(&PatientMarks::default()).is_empty());
    /// ```
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<&'static str> {
        let pairs = [
            ("Patient ID", self.id, other.id),
            ("Patient's Birth Date", self.birth_date, other.birth_date),
            ("Patient's Sex", self.sex, other.sex),
        ];
        let differ = |a: Option<u64>, b: Option<u64>| a.zip(b).is_some_and(|(a, b)| a != b);
        pairs.into_iter().filter(|&(_, a, b)| differ(a, b)).map(|(name, ..)| name).collect()
    }
}

fn mark(text: &str) -> u64 {
    hash(&text.to_ascii_uppercase())
}

/// A remark where the file states another part of the body than the spine, by Body Part Examined or as a mammogram.
pub(super) fn other_body_part(
    data: &InMemDicomObject,
    modality: Option<&str>,
) -> Option<FilmRemark> {
    let stated = data
        .text(tags::BODY_PART_EXAMINED)
        .map(|text| text.to_ascii_uppercase().replace([' ', '_'], ""));
    let by_part = OTHER_PARTS.into_iter().find(|part| stated.as_deref() == Some(*part));
    let part = by_part.or_else(|| (modality == Some("MG")).then_some("BREAST"))?;
    Some(FilmRemark::OtherBodyPart { part: part.into() })
}
