//! Writes the films of phantoms as DICOM: Digital X-Ray Image Storage - For Presentation (PS3.3 A.26).
//!
//! Only synthetic films are written. The patient's name, the descriptions and the image comments say so, and UIDs are
//! made from the case's name, so that the same film gives the same file. Attributes that the modules require and a
//! phantom lacks (dates, a physician) are empty.

use dicom_core::value::{PixelFragmentSequence, PrimitiveValue, Value};
use dicom_core::{DataElement, Tag, VR};
use dicom_dictionary_std::{tags, uids};
use dicom_object::{FileMetaTableBuilder, InMemDicomObject};
use sha2::{Digest, Sha256};
use spineline::analysis::{Sex, Subject};
use spineline::anatomy::{ImageSide, Posture};
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane};

use super::element::{code_item, element, sequence};
use super::pixels::little_endian;
use super::png_file::SYNTHETIC;
use super::{rle, uid};

/// Meaning of large stored values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilmPolarity {
    /// Shown dark.
    Monochrome1,
    /// Shown bright.
    Monochrome2,
}

/// How the pixels are stored; all encodings are lossless.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// Explicit VR Little Endian, not compressed.
    Plain,
    /// RLE Lossless (PS3.5 annex G).
    Rle,
    /// JPEG-LS Lossless.
    JpegLs,
}

impl Encoding {
    /// The UID of the transfer syntax.
    #[must_use]
    pub const fn transfer_syntax(self) -> &'static str {
        match self {
            Self::Plain => uids::EXPLICIT_VR_LITTLE_ENDIAN,
            Self::Rle => uids::RLE_LOSSLESS,
            Self::JpegLs => uids::JPEGLS_LOSSLESS,
        }
    }
}

/// The film of a phantom.
#[derive(Debug, Clone, Copy)]
pub struct DicomFilm<'a> {
    /// Identifier of the case, such as `phantom-rod-01`; the patient's identifier and, in capitals, name.
    pub case_id: &'a str,
    /// Data of the synthetic patient.
    pub subject: &'a Subject,
    /// The posture.
    pub posture: Posture,
    /// Sides and spacing of the picture, which shows the patient from behind where the left is on the left. Where its
    /// spacing is the patient's, the detector's is larger by `magnification`.
    pub image: ImageGeometry,
    /// Magnification on the detector: 1 or more.
    pub magnification: f64,
    /// Meaning of large values.
    pub polarity: FilmPolarity,
    /// Bits that a value uses, 2 to 16.
    pub bits_stored: u16,
    /// Stored values, row by row.
    pub pixels: &'a [u16],
    /// How they are stored.
    pub encoding: Encoding,
}

spineline::faults! {
    /// A film that cannot be written.
    #[derive(Debug, thiserror::Error)]
    #[non_exhaustive]
    pub enum WriteFilmError {
        /// Another number of pixels than the picture has.
        #[error("{posture} film: {columns} × {rows} pixels are stated, but {found} are given")]
        #[help("give columns × rows values, row by row")]
        PixelCount {
            posture: Posture,
            /// Columns stated.
            columns: u32,
            /// Rows stated.
            rows: u32,
            /// Values given.
            found: usize,
        },
        /// A picture without pixels, or with a side that is too long for DICOM.
        #[error("{posture} film: {columns} × {rows} pixels; a side of a DICOM picture has 1 to 65535")]
        #[help("use larger pixels")]
        Size {
            posture: Posture,
            /// Columns stated.
            columns: u32,
            /// Rows stated.
            rows: u32,
        },
        /// An unsupported number of bits, or a value that needs more bits than stated.
        #[error(
            "{posture} film: a value of {greatest} in {bits_stored} bits; 2 to 16 bits are supported"
        )]
        #[help("state as many bits as the largest value needs")]
        Bits {
            posture: Posture,
            /// Largest value.
            greatest: u16,
            bits_stored: u16,
        },
        /// An invalid spacing or magnification.
        #[error("{posture} film: {quantity} of {value} {limit}")]
        #[help("give spacings in mm and a magnification of 1 or more")]
        Length {
            posture: Posture,
            quantity: &'static str,
            value: f64,
            /// Expected value.
            limit: &'static str,
        },
        /// The encoder or the writer of the data set failed.
        #[error("{posture} film: {reason}")]
        #[help("write the film uncompressed")]
        Encoder {
            posture: Posture,
            reason: String,
        },
    }
}

/// SHA-256 of stored values as 16-bit little-endian words, in hexadecimal.
#[must_use]
pub fn pixels_sha256(pixels: &[u16]) -> String {
    let digest = Sha256::digest(little_endian(pixels));
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The film as the bytes of a DICOM file.
pub fn write_dicom(film: &DicomFilm) -> Result<Vec<u8>, WriteFilmError> {
    film.check()?;
    let instance = uid::from_name(&format!("instance {} {}", film.case_id, film.posture.key()));
    let mut object = InMemDicomObject::new_empty();
    film.put_patient_and_study(&mut object);
    film.put_acquisition(&mut object);
    film.put_image(&mut object);
    text(&mut object, tags::SOP_CLASS_UID, VR::UI, STORAGE);
    text(&mut object, tags::SOP_INSTANCE_UID, VR::UI, &instance);
    object.put(film.pixel_data()?);
    let failed = |reason: String| WriteFilmError::Encoder { posture: film.posture, reason };
    let meta = FileMetaTableBuilder::new()
        .transfer_syntax(film.encoding.transfer_syntax())
        .media_storage_sop_class_uid(STORAGE)
        .media_storage_sop_instance_uid(&instance)
        .implementation_class_uid(uid::from_name("implementation"))
        .implementation_version_name("SPINELINE");
    let file = object.with_meta(meta).map_err(|error| failed(error.to_string()))?;
    let mut bytes = Vec::new();
    file.write_all(&mut bytes).map_err(|error| failed(error.to_string()))?;
    Ok(bytes)
}

const STORAGE: &str = uids::DIGITAL_X_RAY_IMAGE_STORAGE_FOR_PRESENTATION;
/// Distance of the source from the detector that the films state.
const SOURCE_TO_DETECTOR_MM: f64 = 1980.0;

fn text(object: &mut InMemDicomObject, tag: Tag, vr: VR, value: &str) {
    object.put(element(tag, vr, value));
}

/// A required attribute without a value.
fn empty(object: &mut InMemDicomObject, tag: Tag, vr: VR) {
    object.put(DataElement::empty(tag, vr));
}

/// A sequence of one coded entry of SNOMED CT.
fn code(object: &mut InMemDicomObject, tag: Tag, value: &str, meaning: &str) {
    object.put(sequence(tag, vec![code_item(value, "SCT", meaning)]));
}

/// A decimal of at most 16 characters, to ten places.
fn decimal(value: f64) -> String {
    let text = format!("{value:.10}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

impl DicomFilm<'_> {
    fn check(&self) -> Result<(), WriteFilmError> {
        let (posture, image) = (self.posture, &self.image);
        let (columns, rows) = (image.columns, image.rows);
        if [columns, rows].iter().any(|side| !(1..=65_535).contains(side)) {
            return Err(WriteFilmError::Size { posture, columns, rows });
        }
        let found = self.pixels.len();
        if found as u64 != u64::from(columns) * u64::from(rows) {
            return Err(WriteFilmError::PixelCount { posture, columns, rows, found });
        }
        let greatest = self.pixels.iter().copied().max().unwrap_or(0);
        let bits_stored = self.bits_stored;
        if !(2..=16).contains(&bits_stored) || u32::from(greatest) >> bits_stored != 0 {
            return Err(WriteFilmError::Bits { posture, greatest, bits_stored });
        }
        let length = |quantity, value, fits, limit| {
            if fits {
                Ok(())
            } else {
                Err(WriteFilmError::Length { posture, quantity, value, limit })
            }
        };
        if let Some(Spacing { column_mm, row_mm, .. }) = image.spacing {
            for (quantity, mm) in [("a column spacing", column_mm), ("a row spacing", row_mm)] {
                length(quantity, mm, Spacing::is_possible(mm), "must be from 0.01 to 5 mm")?;
            }
        }
        let fits = (1.0..=1e4).contains(&self.magnification);
        length("a magnification", self.magnification, fits, "must be 1 or more")
    }

    /// `PHANTOM^ROD01` for `phantom-rod-01`.
    fn patient_name(&self) -> String {
        let capitals = self.case_id.to_uppercase();
        let mut parts = capitals.split(|c: char| !c.is_ascii_alphanumeric());
        let first = parts.next().unwrap_or_default().to_owned();
        let rest: String = parts.collect();
        if rest.is_empty() { first } else { format!("{first}^{rest}") }
    }

    fn put_patient_and_study(&self, object: &mut InMemDicomObject) {
        let case = self.case_id;
        text(object, tags::SPECIFIC_CHARACTER_SET, VR::CS, "ISO_IR 192");
        text(object, tags::PATIENT_NAME, VR::PN, &self.patient_name());
        text(object, tags::PATIENT_ID, VR::LO, case);
        empty(object, tags::PATIENT_BIRTH_DATE, VR::DA);
        match self.subject.sex {
            Some(Sex::Female) => text(object, tags::PATIENT_SEX, VR::CS, "F"),
            Some(Sex::Male) => text(object, tags::PATIENT_SEX, VR::CS, "M"),
            _ => empty(object, tags::PATIENT_SEX, VR::CS),
        }
        if let Some(years) = self.subject.age_years.filter(|years| (0.0..1000.0).contains(years)) {
            text(object, tags::PATIENT_AGE, VR::AS, &format!("{:03}Y", years.floor() as u16));
        }
        text(object, tags::PATIENT_COMMENTS, VR::LT, "SYNTHETIC: a phantom, no patient");
        text(object, tags::PATIENT_IDENTITY_REMOVED, VR::CS, "YES");
        text(object, tags::DEIDENTIFICATION_METHOD, VR::LO, "SYNTHETIC: there is no patient");
        text(object, tags::STUDY_INSTANCE_UID, VR::UI, &uid::from_name(&format!("study {case}")));
        text(object, tags::STUDY_ID, VR::SH, "1");
        text(object, tags::STUDY_DESCRIPTION, VR::LO, "SYNTHETIC spine, erect and moved");
        for (tag, vr) in [
            (tags::STUDY_DATE, VR::DA),
            (tags::STUDY_TIME, VR::TM),
            (tags::ACCESSION_NUMBER, VR::SH),
            (tags::REFERRING_PHYSICIAN_NAME, VR::PN),
        ] {
            empty(object, tag, vr);
        }
        let series = format!("series {case} {}", self.posture.key());
        text(object, tags::SERIES_INSTANCE_UID, VR::UI, &uid::from_name(&series));
        let place = Posture::ALL.iter().position(|&p| p == self.posture).unwrap_or(0) + 1;
        text(object, tags::SERIES_NUMBER, VR::IS, &place.to_string());
        text(object, tags::INSTANCE_NUMBER, VR::IS, "1");
        let description = format!("SYNTHETIC {}", self.posture.key().replace('_', " "));
        text(object, tags::SERIES_DESCRIPTION, VR::LO, &description);
        let comments = format!("{description}; research software, not for the care of a patient");
        text(object, tags::IMAGE_COMMENTS, VR::LT, &comments);
        text(object, tags::MODALITY, VR::CS, "DX");
        text(object, tags::PRESENTATION_INTENT_TYPE, VR::CS, "FOR PRESENTATION");
        text(object, tags::MANUFACTURER, VR::LO, "Spineline (synthetic)");
        text(object, tags::SOFTWARE_VERSIONS, VR::LO, env!("CARGO_PKG_VERSION"));
    }

    fn put_acquisition(&self, object: &mut InMemDicomObject) {
        text(object, tags::BODY_PART_EXAMINED, VR::CS, "SPINE");
        code(object, tags::ANATOMIC_REGION_SEQUENCE, "421060004", "Spine");
        text(object, tags::IMAGE_LATERALITY, VR::CS, "U");
        // From behind, the patient's left is on the left. Directions of increasing columns and rows follow.
        let ((word, view, meaning), directions) = match self.image.patient_left {
            ImageSide::Left => (("PA", "272479007", "postero-anterior"), "R\\F"),
            ImageSide::Right => (("AP", "399348003", "antero-posterior"), "L\\F"),
        };
        text(object, tags::VIEW_POSITION, VR::CS, word);
        code(object, tags::VIEW_CODE_SEQUENCE, view, meaning);
        let (position, meaning) = match self.posture {
            Posture::Erect => ("10904000", "erect"),
            _ => ("102538003", "recumbent"),
        };
        code(object, tags::PATIENT_ORIENTATION_CODE_SEQUENCE, position, meaning);
        text(object, tags::PATIENT_ORIENTATION, VR::CS, directions);
        empty(object, tags::DETECTOR_TYPE, VR::CS);
        object.put(sequence(tags::ACQUISITION_CONTEXT_SEQUENCE, Vec::new()));
        self.put_spacing(object);
    }

    /// Row spacing first, then column spacing (PS3.3 10.7.1.3).
    fn put_spacing(&self, object: &mut InMemDicomObject) {
        let Some(spacing) = self.image.spacing else { return };
        let pair = |factor: f64| {
            let [row, column] = [spacing.row_mm, spacing.column_mm].map(|mm| decimal(mm * factor));
            format!("{row}\\{column}")
        };
        match spacing.plane {
            SpacingPlane::Patient => {
                text(object, tags::PIXEL_SPACING, VR::DS, &pair(1.0));
                text(object, tags::PIXEL_SPACING_CALIBRATION_TYPE, VR::CS, "GEOMETRY");
                let how = "SYNTHETIC: known without error";
                text(object, tags::PIXEL_SPACING_CALIBRATION_DESCRIPTION, VR::LO, how);
                text(object, tags::IMAGER_PIXEL_SPACING, VR::DS, &pair(self.magnification));
            }
            SpacingPlane::Detector => {
                text(object, tags::IMAGER_PIXEL_SPACING, VR::DS, &pair(1.0));
            }
            SpacingPlane::Unknown | SpacingPlane::Pixels => {}
        }
        if spacing.plane == SpacingPlane::Patient {
            let factor = decimal(self.magnification);
            text(object, tags::ESTIMATED_RADIOGRAPHIC_MAGNIFICATION_FACTOR, VR::DS, &factor);
            let to_detector = decimal(SOURCE_TO_DETECTOR_MM);
            text(object, tags::DISTANCE_SOURCE_TO_DETECTOR, VR::DS, &to_detector);
            let to_patient = decimal(SOURCE_TO_DETECTOR_MM / self.magnification);
            text(object, tags::DISTANCE_SOURCE_TO_PATIENT, VR::DS, &to_patient);
        }
    }

    fn put_image(&self, object: &mut InMemDicomObject) {
        text(object, tags::IMAGE_TYPE, VR::CS, "DERIVED\\PRIMARY");
        text(object, tags::DERIVATION_DESCRIPTION, VR::ST, SYNTHETIC[1]);
        empty(object, tags::CONTENT_DATE, VR::DA);
        empty(object, tags::CONTENT_TIME, VR::TM);
        // The word and the lead marker in the picture do not identify a person.
        // In the standard's words, an image of a phantom.
        text(object, tags::QUALITY_CONTROL_IMAGE, VR::CS, "YES");
        text(object, tags::BURNED_IN_ANNOTATION, VR::CS, "NO");
        text(object, tags::LOSSY_IMAGE_COMPRESSION, VR::CS, "00");
        let (photometric, shape) = match self.polarity {
            FilmPolarity::Monochrome1 => ("MONOCHROME1", "INVERSE"),
            FilmPolarity::Monochrome2 => ("MONOCHROME2", "IDENTITY"),
        };
        text(object, tags::PHOTOMETRIC_INTERPRETATION, VR::CS, photometric);
        text(object, tags::PRESENTATION_LUT_SHAPE, VR::CS, shape);
        text(object, tags::PIXEL_INTENSITY_RELATIONSHIP, VR::CS, "LOG");
        // 1: larger values mean more of the beam, as in MONOCHROME1; -1: less.
        let sign: i16 = if self.polarity == FilmPolarity::Monochrome1 { 1 } else { -1 };
        let tag = tags::PIXEL_INTENSITY_RELATIONSHIP_SIGN;
        object.put(element(tag, VR::SS, sign));
        for (tag, vr, value) in [
            (tags::RESCALE_INTERCEPT, VR::DS, "0"),
            (tags::RESCALE_SLOPE, VR::DS, "1"),
            (tags::RESCALE_TYPE, VR::LO, "US"),
        ] {
            text(object, tag, vr, value);
        }
        // All values of this number of bits.
        let levels = 1_u32 << self.bits_stored;
        text(object, tags::WINDOW_CENTER, VR::DS, &(levels / 2).to_string());
        text(object, tags::WINDOW_WIDTH, VR::DS, &levels.to_string());
        for (tag, value) in [
            (tags::SAMPLES_PER_PIXEL, 1),
            (tags::ROWS, self.image.rows as u16),
            (tags::COLUMNS, self.image.columns as u16),
            (tags::BITS_ALLOCATED, 16),
            (tags::BITS_STORED, self.bits_stored),
            (tags::HIGH_BIT, self.bits_stored - 1),
            (tags::PIXEL_REPRESENTATION, 0),
        ] {
            object.put(element(tag, VR::US, value));
        }
    }

    fn pixel_data(&self) -> Result<DataElement<InMemDicomObject>, WriteFilmError> {
        let mut fragment = match self.encoding {
            Encoding::Plain => {
                let words = PrimitiveValue::U16(self.pixels.into());
                return Ok(DataElement::new(tags::PIXEL_DATA, VR::OW, words));
            }
            Encoding::Rle => rle::encode(&rle::planes(self.pixels), self.image.columns as usize),
            Encoding::JpegLs => self.jpeg_ls()?,
        };
        if fragment.len() % 2 == 1 {
            fragment.push(0);
        }
        let fragments = PixelFragmentSequence::new(vec![0], vec![fragment]);
        Ok(DataElement::new(tags::PIXEL_DATA, VR::OB, Value::from(fragments)))
    }

    fn jpeg_ls(&self) -> Result<Vec<u8>, WriteFilmError> {
        let mut options = jpegls::EncodeOptions::default();
        options.precision = Some(self.bits_stored as u8);
        let mut stream = Vec::new();
        let (columns, rows) = (self.image.columns, self.image.rows);
        jpegls::encode_with_options(self.pixels, columns, rows, &options, &mut stream).map_err(
            |error| WriteFilmError::Encoder { posture: self.posture, reason: error.to_string() },
        )?;
        Ok(stream)
    }
}
