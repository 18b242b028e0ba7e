//! De-identification of films after the Basic Application Level Confidentiality Profile of DICOM PS3.15, annex E.
//! Kept attributes are listed (the `policy` module), and each kept value is checked: a number, a word of the standard,
//! a direction. So no text of the file reaches the output. Compressed pictures lose their comments and the segments of
//! applications, and unused bits are cleared. The pixels stay otherwise unchanged: lead markers and burned-in text
//! remain. Only a person can find such text, and the report says so.

mod clean;
mod policy;
mod stream;

use dicom_core::dictionary::{DataDictionary, DataDictionaryEntry};
use dicom_core::value::{PixelFragmentSequence, PrimitiveValue};
use dicom_core::{DataElement, Tag, VR};
use dicom_dictionary_std::{StandardDataDictionary, tags};
use dicom_object::mem::InMemElement;
use dicom_object::{FileMetaTableBuilder, InMemDicomObject};
use png::BitDepth;
use spineline::analysis::is_case_id;

use super::codec::foreign;
use super::container::{self, Container};
use super::element::{Attributes, code_item, element, parse, sequence};
use super::error::{Codec, CodecFault, FilmError, Measure};
use super::png_file::PngFile;
use super::scan::PIXEL_DATA;
use super::tags::{STANCES, VIEW_CODES, is_uid, read as read_tags};
use super::uid;
use super::{Attribute, FilmKind, FilmLimits, FilmRemark, StoredPixels, lookup, raster};
use clean::{Clean, clean};
use policy::{Rule, is_term, rule};

/// Options of de-identification.
#[derive(Clone)]
pub struct DeidOptions {
    /// Replaces the patient's name and number: 1 to 64 letters, digits, dots, dashes or underscores.
    pub case_id: String,
    /// A secret: with the same one, the same old UID becomes the same new UID, so that the films of a study stay together;
    /// without it, the old UID cannot be found.
    pub salt: [u8; 32],
    /// Keep sex and age (90 years at most), the Retain Patient Characteristics Option.
    pub retain_sex_and_age: bool,
}

impl std::fmt::Debug for DeidOptions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = f.debug_struct("DeidOptions");
        shown.field("case_id", &self.case_id).field("retain_sex_and_age", &self.retain_sex_and_age);
        // With the salt, the old UIDs could be guessed.
        shown.finish_non_exhaustive()
    }
}

/// What was done with an attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeidAction {
    /// Kept, because its value is harmless.
    Kept,
    /// Removed with its value.
    Removed,
    /// Emptied.
    Emptied,
    /// Replaced by the case's identifier.
    Replaced,
    /// A new UID for the old one.
    UidReplaced,
    /// Added.
    Added,
}

/// One attribute of the report, without its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DeidEntry {
    /// Which.
    pub attribute: Attribute,
    /// What was done.
    pub action: DeidAction,
}

/// What was done with a film.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DeidReport {
    /// Every attribute of the data set and of the file meta information; a sequence includes its items.
    pub entries: Vec<DeidEntry>,
    /// Checks that a person must do.
    pub remarks: Vec<FilmRemark>,
}

/// A de-identified film.
#[derive(Debug, Clone, PartialEq)]
pub struct Deidentified {
    /// The new file: DICOM for DICOM, PNG for pictures.
    pub bytes: Vec<u8>,
    /// What was done.
    pub report: DeidReport,
}

/// De-identifies a film.
///
/// The transfer syntax is kept, except that deflated files become Explicit VR Little Endian. The values of all pixels
/// are kept. Unused bits become zero, and run lengths are written again; other compressed pixels stay unchanged.
/// Pictures are decoded and written as PNG of 8 or 16 bits, with the shape of their pixels and the text of a synthetic
/// film.
///
/// # Errors
/// [`FilmError::CaseId`], [`FilmError::HiddenBits`], and all errors of reading a film.
pub fn deidentify(
    bytes: &[u8],
    options: &DeidOptions,
    limits: &FilmLimits,
) -> Result<Deidentified, FilmError> {
    if !is_case_id(&options.case_id) {
        return Err(FilmError::CaseId);
    }
    Measure::FileBytes.within(bytes.len() as u64, limits.file_bytes)?;
    match container::sniff(bytes)? {
        FilmKind::Dicom => dicom(bytes, options, limits),
        kind => picture(bytes, kind, limits),
    }
}

fn picture(bytes: &[u8], kind: FilmKind, limits: &FilmLimits) -> Result<Deidentified, FilmError> {
    let film = raster::read(bytes, kind, limits)?;
    let StoredPixels::Unsigned(words) = &film.stored else {
        unreachable!("pictures are unsigned");
    };
    let (depth, samples): (BitDepth, Vec<u8>) = if film.tags.bits_stored == 8 {
        (BitDepth::Eight, words.iter().map(|&word| word as u8).collect())
    } else {
        (BitDepth::Sixteen, words.iter().flat_map(|word| word.to_be_bytes()).collect())
    };
    let file = PngFile {
        columns: film.columns,
        rows: film.rows,
        samples: &samples,
        depth,
        pixel_aspect: film.tags.spacing.pixel_aspect,
        is_phantom: film.tags.is_phantom,
    };
    let bytes = file.bytes().map_err(|_| CodecFault::Unsupported.of(Codec::Raster))?;
    let report = DeidReport { entries: Vec::new(), remarks: film.remarks };
    Ok(Deidentified { bytes, report })
}

fn dicom(
    bytes: &[u8],
    options: &DeidOptions,
    limits: &FilmLimits,
) -> Result<Deidentified, FilmError> {
    let Container { syntax, body, .. } = container::open(bytes, limits)?;
    let data = parse(&body, syntax.encoding, limits)?;
    // Refuses files that are not films; remarks of reading are dropped.
    let (film, _) = read_tags(&data, syntax.name, &mut Vec::new())?;
    let mut clean = clean(&data, &syntax, film.photometric, limits)?;
    let mut report = DeidReport::default();
    report.remarks.extend(match film.burned_in_annotation {
        Some(true) => Some(FilmRemark::BurnedIn),
        None => Some(FilmRemark::BurnedInUnknown),
        Some(false) => None,
    });
    let mut out = InMemDicomObject::new_empty();
    let native = data.native.map(|native| (PIXEL_DATA, native.vr));
    let elements = data.object.iter().map(|element| (element.header().tag.into(), element.vr()));
    for (tag, vr) in elements.chain(native) {
        let kept = match clean.take_if(|_| tag == PIXEL_DATA) {
            Some(clean) => Some((pixel_data(clean, vr), DeidAction::Kept)),
            None => keep(tag, vr, &data.object, options),
        };
        let action = kept.as_ref().map_or(DeidAction::Removed, |&(_, action)| action);
        report.entries.push(DeidEntry { attribute: tag, action });
        if let Some((element, _)) = kept {
            out.put(element);
        }
    }
    let gone = |&attribute| DeidEntry { attribute, action: DeidAction::Removed };
    report.entries.extend(data.left_out.iter().map(gone));
    for added in additions(options) {
        let attribute = added.header().tag.into();
        if out.put(added).is_none() {
            report.entries.push(DeidEntry { attribute, action: DeidAction::Added });
        }
    }
    report.entries.sort_by_key(|entry| entry.attribute);
    let written_as = if syntax.deflated { container::EXPLICIT } else { syntax };
    Ok(Deidentified { bytes: write(out, written_as.uid)?, report })
}

/// A whole file: an empty preamble, new file meta information, and the data set.
fn write(object: InMemDicomObject, transfer_syntax: &str) -> Result<Vec<u8>, FilmError> {
    let uid_of = |tag: Tag| object.text(tag).unwrap_or_default();
    let meta = FileMetaTableBuilder::new()
        .transfer_syntax(transfer_syntax)
        .media_storage_sop_class_uid(uid_of(tags::SOP_CLASS_UID))
        .media_storage_sop_instance_uid(uid_of(tags::SOP_INSTANCE_UID))
        .implementation_class_uid(uid::from_name("implementation"))
        .implementation_version_name("SPINELINE");
    let mut bytes = Vec::new();
    let file = object.with_meta(meta).map_err(|_| FilmError::DataSet)?;
    foreign(|| file.write_all(&mut bytes).map_err(drop)).map_err(|_| FilmError::DataSet)?;
    Ok(bytes)
}

/// The kept element; `None` if it is removed.
fn keep(
    tag: Attribute,
    stated: VR,
    object: &InMemDicomObject,
    options: &DeidOptions,
) -> Option<(InMemElement, DeidAction)> {
    // For an unknown value representation, the standard's.
    let known = StandardDataDictionary.by_tag(tag.into()).map(|entry| entry.vr().relaxed());
    let vr = known.filter(|_| stated == VR::UN).unwrap_or(stated);
    let text = || short_text(tag, object);
    let as_text = |vr: VR, text: &str| (element(tag, vr, text), DeidAction::Kept);
    match rule(tag) {
        Rule::Remove => None,
        Rule::Empty => Some((DataElement::empty(tag.into(), vr), DeidAction::Emptied)),
        Rule::Case => {
            let vr = if tag.1 == 0x0010 { VR::PN } else { VR::LO };
            Some((element(tag, vr, options.case_id.as_str()), DeidAction::Replaced))
        }
        Rule::Uid => text()
            .filter(|text| is_uid(text))
            .map(|text| (element(tag, VR::UI, new_uid(&text, options)), DeidAction::UidReplaced)),
        Rule::StandardUid => text()
            .filter(|text| is_uid(text) && text.starts_with("1.2.840.10008."))
            .map(|text| as_text(VR::UI, &text)),
        Rule::Terms => text()
            .filter(|text| text.split('\\').all(|term| is_term(term.trim())))
            // Rescale Type is a long string in the standard.
            .map(|text| as_text(if vr == VR::LO { VR::LO } else { VR::CS }, &text)),
        Rule::Direction => text()
            .filter(|text| text.bytes().all(|b| b"LRAPHF\\".contains(&b)) && text.len() <= 7)
            .map(|text| as_text(VR::CS, &text)),
        Rule::Number => number(tag, vr, object).map(|element| (element, DeidAction::Kept)),
        Rule::Code => {
            let item = object.item(tag).and_then(known_code);
            item.map(|item| (sequence(tag, vec![item]), DeidAction::Kept))
        }
        Rule::Table => object
            .item(tag)
            .and_then(lookup::whole_table)
            .map(|parts| (table(tag, parts), DeidAction::Kept)),
        Rule::Sex if options.retain_sex_and_age => {
            let known = text().filter(|text| ["M", "F", "O"].contains(&text.as_str()));
            known.map(|text| as_text(VR::CS, &text))
        }
        Rule::Sex => Some((DataElement::empty(tag.into(), VR::CS), DeidAction::Emptied)),
        Rule::Age if options.retain_sex_and_age => {
            text().and_then(|text| age(&text)).map(|age| as_text(VR::AS, &age))
        }
        Rule::Age => None,
    }
}

/// A text of at most 1024 bytes.
fn short_text(tag: Attribute, object: &InMemDicomObject) -> Option<String> {
    object.text(tag).filter(|text| text.len() <= 1024)
}

/// One number, or a few, as text or in binary form.
fn number(tag: Attribute, vr: VR, object: &InMemDicomObject) -> Option<InMemElement> {
    match (vr, object.primitive(tag)) {
        (VR::DS | VR::IS, Some(_)) => {
            let text = short_text(tag, object).filter(|text| is_numeric(text))?;
            Some(element(tag, vr, text.as_str()))
        }
        (VR::US | VR::SS | VR::UL | VR::SL | VR::FL | VR::FD, Some((_, value))) => {
            (value.calculate_byte_len() <= 8).then(|| element(tag, vr, value.clone()))
        }
        _ => None,
    }
}

fn pixel_data(clean: Clean, stated: VR) -> InMemElement {
    match clean {
        Clean::Native(bytes) => {
            let vr = if stated == VR::OB { VR::OB } else { VR::OW };
            element(PIXEL_DATA, vr, PrimitiveValue::U8(bytes.into()))
        }
        Clean::Packed(mut frame) => {
            frame.resize(frame.len().next_multiple_of(2), 0);
            let sequence = PixelFragmentSequence::new(Vec::<u32>::new(), vec![frame]);
            DataElement::new(PIXEL_DATA.into(), VR::OB, sequence)
        }
    }
}

fn is_numeric(text: &str) -> bool {
    text.split('\\').all(|part| {
        let part = part.trim();
        let plain = part.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
        plain && (part.is_empty() || part.parse::<f64>().is_ok())
    })
}

/// Three digits and a unit; 90 years and more are 90.
fn age(text: &str) -> Option<String> {
    let digits = text.get(..3)?.parse::<u16>().ok().filter(|_| text.len() == 4)?;
    let plain = text.bytes().take(3).all(|b| b.is_ascii_digit());
    let unit = text.chars().last().filter(|unit| plain && "DWMY".contains(*unit))?;
    Some(if unit == 'Y' && digits > 90 { "090Y".to_owned() } else { format!("{digits:03}{unit}") })
}

/// An item for a known code, with this program's text.
fn known_code(item: &InMemDicomObject) -> Option<InMemDicomObject> {
    let code = item.text(tags::CODE_VALUE)?;
    let views = VIEW_CODES.iter().map(|&(value, meaning, _)| (value, meaning));
    let stances = STANCES.iter().map(|&(value, meaning, _)| (value, meaning));
    let (value, meaning) = views.chain(stances).find(|&(value, _)| value == code)?;
    let scheme = if value.contains('-') { "SRT" } else { "SCT" };
    Some(code_item(value, scheme, meaning))
}

fn table(tag: Attribute, [descriptor, values]: [PrimitiveValue; 2]) -> InMemElement {
    let mut item = InMemDicomObject::new_empty();
    item.put(element(tags::LUT_DESCRIPTOR, VR::US, descriptor));
    if tag == tags::MODALITY_LUT_SEQUENCE.into() {
        // Its type is required; "unspecified" is always true.
        item.put(element(tags::MODALITY_LUT_TYPE, VR::LO, "US"));
    }
    let vr = if matches!(values, PrimitiveValue::U8(_)) { VR::OB } else { VR::OW };
    item.put(element(tags::LUT_DATA, vr, values));
    sequence(tag, vec![item])
}

fn additions(options: &DeidOptions) -> Vec<InMemElement> {
    // DICOM PS3.16, CID 7050. Pixels are not cleaned, so the code of that option is absent.
    let mut codes = vec![code_item("113100", "DCM", "Basic Application Confidentiality Profile")];
    if options.retain_sex_and_age {
        codes.push(code_item("113108", "DCM", "Retain Patient Characteristics Option"));
    }
    let case = options.case_id.as_str();
    vec![
        element(tags::PATIENT_NAME, VR::PN, case),
        element(tags::PATIENT_ID, VR::LO, case),
        element(tags::PATIENT_IDENTITY_REMOVED, VR::CS, "YES"),
        element(
            tags::DEIDENTIFICATION_METHOD,
            VR::LO,
            "Spineline: allow-list, PS3.15 Annex E Basic Profile",
        ),
        sequence(tags::DEIDENTIFICATION_METHOD_CODE_SEQUENCE, codes),
        element(tags::LONGITUDINAL_TEMPORAL_INFORMATION_MODIFIED, VR::CS, "REMOVED"),
    ]
}

/// A new UID from the salt and the old UID.
fn new_uid(old: &str, options: &DeidOptions) -> String {
    uid::from_bytes(&[options.salt.as_slice(), old.as_bytes()].concat())
}
