//! The attributes of a data set, read by dicom-rs after the scan.

use dicom_core::header::Length;
use dicom_core::value::{DataSetSequence, PrimitiveValue, Value};
use dicom_core::{DataElement, Tag, VR};
use dicom_dictionary_std::tags;
use dicom_object::InMemDicomObject;
use dicom_object::mem::InMemElement;
use dicom_transfer_syntax_registry::entries::{
    EXPLICIT_VR_BIG_ENDIAN, EXPLICIT_VR_LITTLE_ENDIAN, IMPLICIT_VR_LITTLE_ENDIAN,
};

use super::codec::{ensure_memory, foreign};
use super::error::{ElementFault, FilmError, Place};
use super::scan::{Encoding, Native, Scan, scan};
use super::{Attribute, FilmLimits, FilmRemark};

/// A data set without uncompressed pixels, which stay in the file, and without unused elements.
pub(super) struct DataSet<'a> {
    pub object: InMemDicomObject,
    pub native: Option<Native<'a>>,
    /// Elements of the file that are not in `object`.
    pub left_out: Vec<Attribute>,
}

/// Reads a data set that fills `data`.
pub(super) fn parse<'a>(
    data: &'a [u8],
    encoding: Encoding,
    limits: &FilmLimits,
) -> Result<DataSet<'a>, FilmError> {
    let (scan, _) = scan(data, encoding, false, limits)?;
    read(scan, encoding)
}

/// Reads the leading elements of group 0002; returns where they end.
pub(super) fn parse_meta<'a>(
    data: &'a [u8],
    limits: &FilmLimits,
) -> Result<(DataSet<'a>, usize), FilmError> {
    let in_meta = |error| match error {
        FilmError::Truncated { .. } => FilmError::Truncated { place: Place::InMeta },
        other => other,
    };
    let (scan, end) = scan(data, Encoding::EXPLICIT, true, limits).map_err(in_meta)?;
    Ok((read(scan, Encoding::EXPLICIT)?, end))
}

fn read(scan: Scan<'_>, encoding: Encoding) -> Result<DataSet<'_>, FilmError> {
    let syntax = match encoding {
        Encoding { explicit: false, .. } => IMPLICIT_VR_LITTLE_ENDIAN.erased(),
        Encoding { big_endian: false, .. } => EXPLICIT_VR_LITTLE_ENDIAN.erased(),
        Encoding { big_endian: true, .. } => EXPLICIT_VR_BIG_ENDIAN.erased(),
    };
    let Scan { parts, native, left_out } = scan;
    let bytes = parts.concat();
    ensure_memory(bytes.len());
    let read = || InMemDicomObject::read_dataset_with_ts(&bytes[..], &syntax);
    // The error's text may quote the file.
    let object = foreign(read).map_err(|_| FilmError::DataSet)?;
    Ok(DataSet { object, native, left_out })
}

impl DataSet<'_> {
    /// Whether the file lacks this element.
    pub fn is_without(&self, tag: Tag) -> bool {
        self.object.get(tag).is_none() && !self.left_out.contains(&tag.into())
    }
}

/// Access to attributes of a data set or an item.
pub(super) trait Attributes {
    fn primitive(&self, tag: impl Into<Tag>) -> Option<(VR, &PrimitiveValue)>;

    /// The first item of a sequence.
    fn item(&self, tag: impl Into<Tag>) -> Option<&InMemDicomObject>;

    /// Whether an attribute is absent, or blank.
    fn is_blank(&self, tag: impl Into<Tag>) -> bool;

    /// The text of an attribute without its padding; `None` where it is absent, empty or not ASCII.
    fn text(&self, tag: impl Into<Tag>) -> Option<String> {
        let text = text(self.primitive(tag)?.1)?;
        let text = text.trim_matches([' ', '\0']);
        (text.is_ascii() && !text.is_empty()).then(|| text.to_owned())
    }

    /// All 16-bit values of an attribute.
    fn words(&self, tag: impl Into<Tag>) -> Option<Vec<u16>> {
        match self.primitive(tag)?.1 {
            PrimitiveValue::U16(words) => Some(words.to_vec()),
            PrimitiveValue::I16(words) => Some(words.iter().map(|w| w.cast_unsigned()).collect()),
            // Unknown value representations are little endian.
            PrimitiveValue::U8(bytes) => Some(
                bytes.as_chunks::<2>().0.iter().map(|&pair| u16::from_le_bytes(pair)).collect(),
            ),
            _ => None,
        }
    }

    /// The single 16-bit value of an attribute.
    ///
    /// # Errors
    /// [`FilmError::Element`] for another value.
    fn word(&self, tag: Tag) -> Result<Option<u16>, FilmError> {
        let wrong = FilmError::Element { attribute: tag.into(), fault: ElementFault::Value };
        match self.primitive(tag) {
            Some((_, PrimitiveValue::Empty)) => Ok(None),
            Some((VR::US | VR::SS | VR::UN, value)) if value.calculate_byte_len() == 2 => {
                match self.words(tag).as_deref() {
                    Some(&[word]) => Ok(Some(word)),
                    _ => Err(wrong),
                }
            }
            None if self.item(tag).is_none() => Ok(None),
            _ => Err(wrong),
        }
    }
}

impl Attributes for InMemDicomObject {
    fn primitive(&self, tag: impl Into<Tag>) -> Option<(VR, &PrimitiveValue)> {
        let element = self.get(tag.into())?;
        Some((element.vr(), element.value().primitive()?))
    }

    fn item(&self, tag: impl Into<Tag>) -> Option<&InMemDicomObject> {
        match self.get(tag.into())?.value() {
            Value::Sequence(items) => items.items().first(),
            _ => None,
        }
    }

    fn is_blank(&self, tag: impl Into<Tag>) -> bool {
        let Some(element) = self.get(tag.into()) else { return true };
        element.value().primitive().is_some_and(|value| match value {
            PrimitiveValue::Empty => true,
            value => text(value).is_some_and(|text| text.chars().all(|c| c == ' ' || c == '\0')),
        })
    }
}

fn text(value: &PrimitiveValue) -> Option<String> {
    match value {
        PrimitiveValue::Str(text) => Some(text.clone()),
        PrimitiveValue::Strs(parts) => Some(parts.join("\\")),
        PrimitiveValue::U8(bytes) => std::str::from_utf8(bytes).ok().map(str::to_owned),
        _ => None,
    }
}

/// An element with one value.
pub(super) fn element(
    tag: impl Into<Tag>,
    vr: VR,
    value: impl Into<PrimitiveValue>,
) -> InMemElement {
    DataElement::new(tag.into(), vr, value.into())
}

/// A sequence with these items.
pub(super) fn sequence(tag: impl Into<Tag>, items: Vec<InMemDicomObject>) -> InMemElement {
    DataElement::new(tag.into(), VR::SQ, DataSetSequence::new(items, Length::UNDEFINED))
}

/// An item with a code of a scheme.
pub(super) fn code_item(value: &str, scheme: &str, meaning: &str) -> InMemDicomObject {
    InMemDicomObject::from_element_iter([
        element(tags::CODE_VALUE, VR::SH, value),
        element(tags::CODING_SCHEME_DESIGNATOR, VR::SH, scheme),
        element(tags::CODE_MEANING, VR::LO, meaning),
    ])
}

/// A decimal string: digits, sign, point and exponent of ten. Commas, texts and overflows are refused.
pub(super) fn decimal(text: &str) -> Option<f64> {
    let text = text.trim_matches(|c: char| c == ' ' || c == '\0');
    let plain = text.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
    // Rust would also read `inf` and `nan`.
    text.parse::<f64>().ok().filter(|value| plain && value.is_finite())
}

/// One number; a remark for any other value.
pub(super) fn number(
    data: &InMemDicomObject,
    tag: Tag,
    remarks: &mut Vec<FilmRemark>,
) -> Option<f64> {
    numbers(data, tag, remarks).and_then(|values| match values[..] {
        [value] => Some(value),
        _ => {
            remarks.push(FilmRemark::unusable(tag));
            None
        }
    })
}

/// All numbers of an attribute; a remark if a value is not a number.
pub(super) fn numbers(
    data: &InMemDicomObject,
    tag: Tag,
    remarks: &mut Vec<FilmRemark>,
) -> Option<Vec<f64>> {
    if data.is_blank(tag) {
        return None;
    }
    let values = data.text(tag).and_then(|text| text.split('\\').map(decimal).collect());
    if values.is_none() {
        remarks.push(FilmRemark::unusable(tag));
    }
    values
}
