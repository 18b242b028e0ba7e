//! A radiograph after reading.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use spineline_marking::{SpacingEvidence, ViewEvidence};

use super::error::{FilmError, UnsupportedPhotometric};
use super::{ExposureMarks, FilmKind, FilmRemark, Look, PatientMarks};

/// Which values are bright: Photometric Interpretation (0028,0004).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Photometric {
    /// Small values are bright.
    Monochrome1,
    /// Large values are bright.
    Monochrome2,
    /// The picture was in colour; its luminance is here.
    Colour,
    /// Not stated; large values are taken as bright.
    #[default]
    NotStated,
}

impl Photometric {
    /// The DICOM name, or a word for a missing one.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Monochrome1 => "MONOCHROME1",
            Self::Monochrome2 => "MONOCHROME2",
            Self::Colour => "colour",
            Self::NotStated => "not stated",
        }
    }

    pub(super) fn read(text: Option<&str>) -> Result<Self, FilmError> {
        Ok(match text {
            None => Self::NotStated,
            Some("MONOCHROME1") => Self::Monochrome1,
            Some("MONOCHROME2") => Self::Monochrome2,
            Some("RGB" | "YBR_FULL" | "YBR_FULL_422" | "YBR_RCT" | "YBR_ICT") => Self::Colour,
            Some(other) => {
                let photometric = match other {
                    "PALETTE COLOR" => UnsupportedPhotometric::Palette,
                    _ => UnsupportedPhotometric::Unknown,
                };
                return Err(FilmError::Photometric { photometric });
            }
        })
    }
}

/// Identifiers with which a report refers to its film. They are unique to the film and contain no
/// name: [`deidentify`](super::deidentify) exchanges them.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FilmUids {
    /// SOP Class UID (0008,0016).
    pub sop_class: Option<String>,
    /// SOP Instance UID (0008,0018).
    pub sop_instance: Option<String>,
    /// Study Instance UID (0020,000D).
    pub study_instance: Option<String>,
    /// Series Instance UID (0020,000E).
    pub series_instance: Option<String>,
}

/// Values of a film's attributes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FilmTags {
    /// Modality (0008,0060); one of the radiographic ones, or `None`.
    pub modality: Option<String>,
    /// For [`judge_spacing`](spineline_marking::judge_spacing).
    pub spacing: SpacingEvidence,
    /// For [`judge_view`](spineline_marking::judge_view).
    pub view: ViewEvidence,
    /// Which values are bright.
    pub photometric: Photometric,
    /// Burned In Annotation (0028,0301), where it is stated.
    pub burned_in_annotation: Option<bool>,
    /// Whether the file states that its picture is of a phantom: Quality Control Image (0028,0300), or the text of a PNG
    /// file that Spineline wrote. Films of synthetic patients say so.
    pub is_phantom: bool,
    /// For comparison with the patient of another film.
    pub patient: PatientMarks,
    /// For comparison with the exposure of another film.
    pub exposure: ExposureMarks,
    /// Identifiers of the film.
    pub uids: FilmUids,
    /// Name of the transfer syntax of a DICOM file.
    pub transfer_syntax: Option<Cow<'static, str>>,
    /// Bits of a sample: 1 to 16.
    pub bits_stored: u8,
}

/// Pixels as stored, row by row from the top left, before any table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StoredPixels {
    /// Unsigned.
    Unsigned(Vec<u16>),
    /// Signed.
    Signed(Vec<i16>),
}

impl StoredPixels {
    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        match self {
            Self::Unsigned(values) => values.len(),
            Self::Signed(values) => values.len(),
        }
    }

    /// Whether it has no pixels; never true in a [`FilmFile`].
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Values in order.
    pub fn iter(&self) -> impl Iterator<Item = i32> + '_ {
        let (unsigned, signed): (&[u16], &[i16]) = match self {
            Self::Unsigned(values) => (values, &[]),
            Self::Signed(values) => (&[], values),
        };
        unsigned.iter().map(|&v| i32::from(v)).chain(signed.iter().map(|&v| i32::from(v)))
    }

    /// Smallest and largest value; `(0, 0)` without pixels.
    #[must_use]
    pub fn range(&self) -> (i32, i32) {
        fn of<T: Copy + Ord + Into<i32>>(values: &[T]) -> (i32, i32) {
            let least = values.iter().copied().min().map_or(0, Into::into);
            (least, values.iter().copied().max().map_or(0, Into::into))
        }
        match self {
            Self::Unsigned(values) => of(values),
            Self::Signed(values) => of(values),
        }
    }
}

impl FilmFile {
    /// SHA-256 of size and stored values, in hexadecimal: equal for the same picture in two files with any
    /// compression. Another bit depth, window, polarity or direction gives another picture.
    #[must_use]
    pub fn picture_sha256(&self) -> String {
        let mut digest = Sha256::new();
        for side in [self.columns, self.rows] {
            digest.update(side.to_le_bytes());
        }
        // Row by row, so that memory does not hold a large film twice.
        let columns = self.columns.max(1) as usize;
        let mut values = self.stored.iter().peekable();
        while values.peek().is_some() {
            let row: Vec<u8> = values.by_ref().take(columns).flat_map(i32::to_le_bytes).collect();
            digest.update(&row);
        }
        digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// A radiograph: pixels, values of attributes, and remarks.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmFile {
    /// What the file is.
    pub kind: FilmKind,
    /// Pixels in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Pixels as stored.
    pub stored: StoredPixels,
    /// Values of the attributes.
    pub tags: FilmTags,
    /// How values become grey.
    pub look: Look,
    /// Remarks.
    pub remarks: Vec<FilmRemark>,
}
