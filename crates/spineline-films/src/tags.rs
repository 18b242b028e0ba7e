//! Values of a film's attributes for measuring.

use dicom_core::Tag;
use dicom_core::value::Value;
use dicom_dictionary_std::tags;
use dicom_object::InMemDicomObject;
use spineline_marking::{
    CalibrationType, PatientDirection, SpacingEvidence, Stance, ViewEvidence, ViewPosition,
};

use super::element::{Attributes, DataSet, number};
use super::error::FilmError;
use super::lookup::{Look, look};
use super::pair::{aspect, pair};
use super::patient::{PatientMarks, other_body_part};
use super::scan::PIXEL_DATA;
use super::{ExposureMarks, FilmRemark, FilmTags, FilmUids, Photometric};

/// Modalities whose pictures can be radiographs: devices, scanned films, and captures of either.
pub(super) const RADIOGRAPHS: [&str; 10] =
    ["CR", "DX", "RG", "RF", "XA", "MG", "OT", "SC", "HC", "XC"];

/// Other modalities of DICOM PS3.3, C.7.3.1.1.1, that an error may name.
const OTHER_MODALITIES: [&str; 29] = [
    "CT", "MR", "NM", "PT", "US", "ES", "SM", "SR", "PR", "KO", "SEG", "REG", "DOC", "ECG", "IO",
    "IVUS", "OCT", "OP", "PX", "BMD", "BDUS", "RTIMAGE", "RTDOSE", "RTPLAN", "RTSTRUCT",
    "RTRECORD", "AU", "HD", "GM",
];

/// Reads the attributes, and refuses everything except for a single grey radiograph.
pub(super) fn read(
    data: &DataSet<'_>,
    syntax_name: &'static str,
    remarks: &mut Vec<FilmRemark>,
) -> Result<(FilmTags, Look), FilmError> {
    let with_pixels = data;
    let data = &data.object;
    let modality = modality(data, remarks)?;
    remarks.extend(other_body_part(data, modality.as_deref()));
    refuse_other_pixels(with_pixels)?;
    name_left_out(with_pixels, remarks);
    let photometric = polarity(data, remarks)?;
    if data.text(tags::LOSSY_IMAGE_COMPRESSION).as_deref() == Some("01") {
        remarks.push(FilmRemark::Lossy);
    }
    if data.text(tags::PRESENTATION_INTENT_TYPE).as_deref() == Some("FOR PROCESSING") {
        remarks.push(FilmRemark::ForProcessing);
    }
    let burned_in = burned_in(data, remarks);
    let spacing = spacing(data, remarks);
    let tags = FilmTags {
        modality,
        spacing,
        view: view(data, remarks),
        photometric,
        burned_in_annotation: burned_in,
        is_phantom: data.text(tags::QUALITY_CONTROL_IMAGE).as_deref() == Some("YES"),
        patient: PatientMarks::read(data),
        exposure: ExposureMarks::read(data),
        uids: FilmUids {
            sop_class: uid(data, tags::SOP_CLASS_UID, remarks),
            sop_instance: uid(data, tags::SOP_INSTANCE_UID, remarks),
            study_instance: uid(data, tags::STUDY_INSTANCE_UID, remarks),
            series_instance: uid(data, tags::SERIES_INSTANCE_UID, remarks),
        },
        transfer_syntax: Some(syntax_name.into()),
        bits_stored: 0,
    };
    Ok((tags, look(data, remarks)))
}

/// The meaning of small values, which the shape of the look-up table may contradict.
fn polarity(
    data: &InMemDicomObject,
    remarks: &mut Vec<FilmRemark>,
) -> Result<Photometric, FilmError> {
    let photometric = Photometric::read(data.text(tags::PHOTOMETRIC_INTERPRETATION).as_deref())?;
    let shape = data.text(tags::PRESENTATION_LUT_SHAPE);
    match shape.as_deref() {
        None | Some("IDENTITY" | "INVERSE") => {}
        Some(_) => remarks.push(FilmRemark::unusable(tags::PRESENTATION_LUT_SHAPE)),
    }
    match (photometric, shape.as_deref()) {
        (Photometric::Monochrome1, Some("IDENTITY"))
        | (Photometric::Monochrome2, Some("INVERSE")) => {
            remarks.push(FilmRemark::PolarityContradicted);
        }
        (Photometric::NotStated, _) => remarks.push(FilmRemark::PolarityNotStated),
        _ => {}
    }
    Ok(photometric)
}

/// Whether the pixels show text; `None` if not stated.
fn burned_in(data: &InMemDicomObject, remarks: &mut Vec<FilmRemark>) -> Option<bool> {
    let burned_in = match data.text(tags::BURNED_IN_ANNOTATION).as_deref() {
        Some("YES") => Some(true),
        Some("NO") => Some(false),
        _ => None,
    };
    match burned_in {
        Some(true) => remarks.push(FilmRemark::BurnedIn),
        Some(false) => {}
        None => remarks.push(FilmRemark::BurnedInUnknown),
    }
    burned_in
}

fn modality(
    data: &InMemDicomObject,
    remarks: &mut Vec<FilmRemark>,
) -> Result<Option<String>, FilmError> {
    match data.text(tags::MODALITY) {
        Some(text) if RADIOGRAPHS.contains(&text.as_str()) => Ok(Some(text)),
        Some(text) => {
            let known = OTHER_MODALITIES.contains(&text.as_str());
            Err(FilmError::Modality { modality: known.then_some(text) })
        }
        None => {
            remarks.push(FilmRemark::NoModality);
            Ok(None)
        }
    }
}

/// Remarks on unreadable attributes of geometry, pixels and view; others are not used.
fn name_left_out(data: &DataSet<'_>, remarks: &mut Vec<FilmRemark>) {
    let used = |group| matches!(group, 0x0018 | 0x0020 | 0x0028 | 0x0054);
    for &attribute in data.left_out.iter().filter(|attribute| used(attribute.0)) {
        if data.object.get(attribute.into()).is_none() {
            remarks.push(FilmRemark::Unusable { attribute });
        }
    }
}

fn refuse_other_pixels(data: &DataSet<'_>) -> Result<(), FilmError> {
    if !data.object.is_blank(tags::NUMBER_OF_FRAMES) {
        match data.object.text(tags::NUMBER_OF_FRAMES).and_then(|text| text.parse::<u32>().ok()) {
            Some(1) => {}
            frames => return Err(FilmError::Frames { frames: frames.unwrap_or(0) }),
        }
    }
    let element = data.object.get(PIXEL_DATA.into());
    let is_packed = matches!(element.map(|e| e.value()), Some(Value::PixelSequence(_)));
    if data.native.is_some() || is_packed {
        Ok(())
    } else {
        Err(FilmError::NoPixels { missing: PIXEL_DATA })
    }
}

fn spacing(data: &InMemDicomObject, remarks: &mut Vec<FilmRemark>) -> SpacingEvidence {
    const CALIBRATION: Tag = tags::PIXEL_SPACING_CALIBRATION_TYPE;
    let calibration = data.text(CALIBRATION).and_then(|text| match text.as_str() {
        "GEOMETRY" => Some(CalibrationType::Geometry),
        "FIDUCIAL" => Some(CalibrationType::Fiducial),
        _ => {
            remarks.push(FilmRemark::unusable(CALIBRATION));
            None
        }
    });
    SpacingEvidence {
        pixel_mm: pair(data, tags::PIXEL_SPACING, remarks),
        calibration,
        imager_mm: pair(data, tags::IMAGER_PIXEL_SPACING, remarks),
        magnification: number(data, tags::ESTIMATED_RADIOGRAPHIC_MAGNIFICATION_FACTOR, remarks),
        source_to_detector_mm: number(data, tags::DISTANCE_SOURCE_TO_DETECTOR, remarks),
        source_to_patient_mm: number(data, tags::DISTANCE_SOURCE_TO_PATIENT, remarks),
        scanned_mm: pair(data, tags::NOMINAL_SCANNED_PIXEL_SPACING, remarks),
        pixel_aspect: aspect(data, tags::PIXEL_ASPECT_RATIO, remarks),
    }
}

fn view(data: &InMemDicomObject, remarks: &mut Vec<FilmRemark>) -> ViewEvidence {
    let orientation = data.text(tags::PATIENT_ORIENTATION).and_then(|text| {
        let known = |part: &str| {
            let part = part.trim();
            let letters = part.len() <= 3 && part.bytes().all(|b| b"LRAPHF".contains(&b));
            PatientDirection::from_dicom(part).filter(|_| letters)
        };
        let pair = text.split_once('\\').and_then(|(a, b)| known(a).zip(known(b)));
        if pair.is_none() {
            remarks.push(FilmRemark::unusable(tags::PATIENT_ORIENTATION));
        }
        pair.map(|(columns, rows)| [columns, rows])
    });
    let by_code = || {
        let code = data.item(tags::VIEW_CODE_SEQUENCE)?.text(tags::CODE_VALUE)?;
        VIEW_CODES.iter().find(|(value, _, _)| *value == code).map(|&(_, _, view)| view)
    };
    ViewEvidence {
        orientation,
        view_position: data
            .text(tags::VIEW_POSITION)
            .map(|text| ViewPosition::from_dicom(&text))
            .or_else(by_code),
        stance: data.item(tags::PATIENT_ORIENTATION_CODE_SEQUENCE).and_then(|item| {
            let code = item.text(tags::CODE_VALUE)?;
            STANCES.iter().find(|(value, _, _)| *value == code).map(|&(_, _, stance)| stance)
        }),
    }
}

/// Codes of DICOM PS3.16, CID 4010, in SNOMED RT and CT, with their meanings.
pub(super) const VIEW_CODES: [(&str, &str, ViewPosition); 6] = [
    ("R-10206", "antero-posterior", ViewPosition::Frontal),
    ("R-10214", "postero-anterior", ViewPosition::Frontal),
    ("R-10236", "left lateral", ViewPosition::Lateral),
    ("R-10232", "right lateral", ViewPosition::Lateral),
    ("399348003", "antero-posterior", ViewPosition::Frontal),
    ("272479007", "postero-anterior", ViewPosition::Frontal),
];

/// Codes of DICOM PS3.16, CID 19, in SNOMED RT and CT, with their meanings.
pub(super) const STANCES: [(&str, &str, Stance); 4] = [
    ("F-10440", "erect", Stance::Erect),
    ("F-10450", "recumbent", Stance::Recumbent),
    ("10904000", "erect", Stance::Erect),
    ("102538003", "recumbent", Stance::Recumbent),
];

fn uid(data: &InMemDicomObject, tag: Tag, remarks: &mut Vec<FilmRemark>) -> Option<String> {
    let text = data.text(tag)?;
    if is_uid(&text) {
        return Some(text);
    }
    remarks.push(FilmRemark::unusable(tag));
    None
}

/// Digits and dots, at most 64 of them, no empty component.
#[must_use]
pub fn is_uid(text: &str) -> bool {
    text.len() <= 64
        && text.split('.').all(|part| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit()))
}
