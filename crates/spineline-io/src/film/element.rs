//! DICOM data sets as borrowed bytes: every length is checked against the bytes that are there, sequences have a depth
//! limit, and all elements a common one. Nothing is copied, so that a copy of a film can be exact to the byte.

use dicom_core::dictionary::{DataDictionary, DataDictionaryEntry, VirtualVr};
use dicom_core::{Tag, VR};
use dicom_dictionary_std::StandardDataDictionary;

use super::error::{ElementFault, FilmError, Measure, Place};
use super::{Attribute, FilmLimits};

/// How elements are written down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Encoding {
    pub explicit: bool,
    pub big_endian: bool,
}

impl Encoding {
    pub const IMPLICIT: Self = Self { explicit: false, big_endian: false };
    pub const EXPLICIT: Self = Self { explicit: true, big_endian: false };

    pub fn u16(self, bytes: [u8; 2]) -> u16 {
        if self.big_endian { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) }
    }

    fn u32(self, bytes: [u8; 4]) -> u32 {
        if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }
}

#[derive(Debug, Clone)]
pub(super) enum Value<'a> {
    Bytes(&'a [u8]),
    Items(Vec<DataSet<'a>>),
    /// Encapsulated pixels: the basic offset table, and what follows it.
    Fragments {
        table: &'a [u8],
        fragments: Vec<&'a [u8]>,
    },
}

#[derive(Debug, Clone)]
pub(super) struct Element<'a> {
    pub tag: Attribute,
    pub vr: VR,
    pub value: Value<'a>,
}

#[derive(Debug, Clone)]
pub(super) struct DataSet<'a> {
    pub elements: Vec<Element<'a>>,
    pub encoding: Encoding,
}

const ITEM: Attribute = Attribute(0xFFFE, 0xE000);
const ITEM_END: Attribute = Attribute(0xFFFE, 0xE00D);
const SEQUENCE_END: Attribute = Attribute(0xFFFE, 0xE0DD);
pub(super) const PIXEL_DATA: Attribute = Attribute(0x7FE0, 0x0010);
const UNDEFINED: u32 = u32::MAX;

/// Reads a data set that fills `data`.
pub(super) fn parse<'a>(
    data: &'a [u8],
    encoding: Encoding,
    limits: &FilmLimits,
) -> Result<DataSet<'a>, FilmError> {
    Parser { data, position: 0, elements: 0, limits }.data_set(encoding, End::At(data.len()), 0)
}

/// Reads the leading elements of group 0002, and says where they end.
pub(super) fn parse_meta<'a>(
    data: &'a [u8],
    limits: &FilmLimits,
) -> Result<(DataSet<'a>, usize), FilmError> {
    let mut parser = Parser { data, position: 0, elements: 0, limits };
    let encoding = Encoding::EXPLICIT;
    let mut elements = Vec::new();
    while parser.remaining() >= 2 && data[parser.position..].starts_with(&[2, 0]) {
        let in_meta = |error| match error {
            FilmError::Truncated { .. } => FilmError::Truncated { place: Place::InMeta },
            other => other,
        };
        elements.push(parser.element(encoding, 0).map_err(in_meta)?);
    }
    Ok((DataSet { elements, encoding }, parser.position))
}

#[derive(Clone, Copy)]
enum End {
    At(usize),
    Delimiter,
}

struct Header {
    tag: Attribute,
    vr: Option<VR>,
    length: u32,
}

struct Parser<'a, 'l> {
    data: &'a [u8],
    position: usize,
    elements: usize,
    limits: &'l FilmLimits,
}

impl<'a> Parser<'a, '_> {
    fn remaining(&self) -> usize {
        self.data.len() - self.position
    }

    fn array<const N: usize>(&mut self, place: Place) -> Result<[u8; N], FilmError> {
        let bytes = self.data[self.position..].first_chunk::<N>();
        self.position += N;
        bytes.copied().ok_or(FilmError::Truncated { place })
    }

    fn header(&mut self, encoding: Encoding, place: Place) -> Result<Header, FilmError> {
        let group = encoding.u16(self.array(place)?);
        let tag = Attribute(group, encoding.u16(self.array(place)?));
        if !encoding.explicit || group == ITEM.0 {
            return Ok(Header { tag, vr: None, length: encoding.u32(self.array(place)?) });
        }
        let letters: [u8; 2] = self.array(place)?;
        if !letters.iter().all(u8::is_ascii_uppercase) {
            let fault = ElementFault::ValueRepresentation;
            return Err(FilmError::Element { attribute: tag, fault });
        }
        let vr = VR::from_binary(letters).unwrap_or(VR::UN);
        let length = if is_short(vr) {
            u32::from(encoding.u16(self.array(place)?))
        } else {
            self.array::<2>(place)?;
            encoding.u32(self.array(place)?)
        };
        Ok(Header { tag, vr: Some(vr), length })
    }

    fn bytes(&mut self, tag: Attribute, length: u32, end: usize) -> Result<&'a [u8], FilmError> {
        let remaining = end.saturating_sub(self.position);
        match usize::try_from(length) {
            Ok(length) if length <= remaining => {
                let start = self.position;
                self.position += length;
                Ok(&self.data[start..self.position])
            }
            _ => Err(FilmError::Length {
                attribute: tag,
                length: u64::from(length),
                remaining: remaining as u64,
            }),
        }
    }

    fn data_set(
        &mut self,
        encoding: Encoding,
        end: End,
        depth: usize,
    ) -> Result<DataSet<'a>, FilmError> {
        let mut elements = Vec::new();
        loop {
            match end {
                End::At(end) if self.position == end => break,
                // Some writers fill the last block of a medium with zeros.
                End::At(end) if depth == 0 && is_zero(&self.data[self.position..end]) => break,
                End::Delimiter if self.remaining() == 0 => {
                    return Err(FilmError::Truncated { place: Place::InSequence });
                }
                End::Delimiter if self.at_tag(ITEM_END, encoding) => {
                    self.header(encoding, Place::InSequence)?;
                    break;
                }
                _ => {}
            }
            elements.push(self.element(encoding, depth)?);
            if let End::At(end) = end
                && self.position > end
            {
                let last = elements.last().map_or(ITEM, |e| e.tag);
                return Err(FilmError::Element { attribute: last, fault: ElementFault::Value });
            }
        }
        Ok(DataSet { elements, encoding })
    }

    fn at_tag(&self, tag: Attribute, encoding: Encoding) -> bool {
        let found = self.data[self.position..].first_chunk::<4>();
        found.is_some_and(|&[a, b, c, d]| {
            tag == Attribute(encoding.u16([a, b]), encoding.u16([c, d]))
        })
    }

    fn element(&mut self, encoding: Encoding, depth: usize) -> Result<Element<'a>, FilmError> {
        self.count()?;
        let Header { tag, vr: stated, length } = self.header(encoding, Place::InElement)?;
        if tag.0 == ITEM.0 {
            return Err(FilmError::Element { attribute: tag, fault: ElementFault::NotAnItem });
        }
        let vr = match stated {
            Some(vr) if vr != VR::UN => vr,
            _ => dictionary_vr(tag),
        };
        let value = if length == UNDEFINED {
            if tag == PIXEL_DATA {
                self.fragments(encoding)?
            } else if matches!(stated, None | Some(VR::SQ | VR::UN)) {
                // A sequence of unknown attributes is implicit, whatever is around it (PS3.5, 6.2.2).
                let inner = if stated == Some(VR::UN) { Encoding::IMPLICIT } else { encoding };
                let items = self.items(tag, inner, End::Delimiter, depth)?;
                return Ok(Element { tag, vr: VR::SQ, value: items });
            } else {
                let fault = ElementFault::UndefinedLength;
                return Err(FilmError::Element { attribute: tag, fault });
            }
        } else if vr == VR::SQ && !tag.is_private() {
            let start = self.position;
            let bytes = self.bytes(tag, length, self.data.len())?;
            self.position = start;
            let inner = if stated == Some(VR::UN) { Encoding::IMPLICIT } else { encoding };
            self.items(tag, inner, End::At(start + bytes.len()), depth)?
        } else {
            Value::Bytes(self.bytes(tag, length, self.data.len())?)
        };
        Ok(Element { tag, vr, value })
    }

    fn items(
        &mut self,
        tag: Attribute,
        encoding: Encoding,
        end: End,
        depth: usize,
    ) -> Result<Value<'a>, FilmError> {
        if depth >= self.limits.depth {
            let (found, limit) = (depth as u64 + 1, self.limits.depth as u64);
            return Err(FilmError::TooLarge { what: Measure::Depth, found, limit });
        }
        let mut items = Vec::new();
        loop {
            match end {
                End::At(end) if self.position == end => return Ok(Value::Items(items)),
                End::At(end) if self.position > end => {
                    return Err(FilmError::Element { attribute: tag, fault: ElementFault::Value });
                }
                _ => {}
            }
            self.count()?;
            let header = self.header(encoding, Place::InSequence)?;
            if header.tag == SEQUENCE_END && matches!(end, End::Delimiter) {
                return Ok(Value::Items(items));
            }
            if header.tag != ITEM {
                return Err(FilmError::Element { attribute: tag, fault: ElementFault::NotAnItem });
            }
            let item_end = if header.length == UNDEFINED {
                End::Delimiter
            } else {
                let start = self.position;
                let outer = match end {
                    End::At(end) => end,
                    End::Delimiter => self.data.len(),
                };
                let bytes = self.bytes(ITEM, header.length, outer)?;
                self.position = start;
                End::At(start + bytes.len())
            };
            items.push(self.data_set(encoding, item_end, depth + 1)?);
        }
    }

    fn fragments(&mut self, encoding: Encoding) -> Result<Value<'a>, FilmError> {
        let mut parts = Vec::new();
        loop {
            self.count()?;
            let header = self.header(encoding, Place::InFragments)?;
            match header.tag {
                SEQUENCE_END => break,
                ITEM => parts.push(self.bytes(PIXEL_DATA, header.length, self.data.len())?),
                _ => {
                    let fault = ElementFault::NotAnItem;
                    return Err(FilmError::Element { attribute: PIXEL_DATA, fault });
                }
            }
        }
        let fragments = parts.split_off(parts.len().min(1));
        let table = parts.first().copied().unwrap_or_default();
        Ok(Value::Fragments { table, fragments })
    }

    fn count(&mut self) -> Result<(), FilmError> {
        self.elements += 1;
        let (found, limit) = (self.elements as u64, self.limits.elements as u64);
        if found > limit {
            return Err(FilmError::TooLarge { what: Measure::Elements, found, limit });
        }
        Ok(())
    }
}

fn is_zero(bytes: &[u8]) -> bool {
    bytes.len() >= 8 && bytes[..8].iter().all(|&b| b == 0) && bytes.iter().all(|&b| b == 0)
}

/// Value representations whose explicit length has 16 bits.
pub(super) fn is_short(vr: VR) -> bool {
    !matches!(
        vr,
        VR::OB
            | VR::OD
            | VR::OF
            | VR::OL
            | VR::OV
            | VR::OW
            | VR::SQ
            | VR::SV
            | VR::UC
            | VR::UN
            | VR::UR
            | VR::UT
            | VR::UV
    )
}

fn dictionary_vr(tag: Attribute) -> VR {
    if tag.is_private() {
        return VR::UN;
    }
    match StandardDataDictionary.by_tag(Tag(tag.0, tag.1)).map(DataDictionaryEntry::vr) {
        Some(VirtualVr::Exact(vr)) => vr,
        Some(VirtualVr::Xs) => VR::US,
        Some(VirtualVr::Ox | VirtualVr::Px | VirtualVr::Lt) => VR::OW,
        _ => VR::UN,
    }
}

impl<'a> DataSet<'a> {
    pub fn get(&self, tag: Attribute) -> Option<&Element<'a>> {
        self.elements.iter().find(|element| element.tag == tag)
    }

    pub fn bytes(&self, tag: Attribute) -> Option<&'a [u8]> {
        match self.get(tag)?.value {
            Value::Bytes(bytes) => Some(bytes),
            _ => None,
        }
    }

    /// The text of an attribute without its padding; `None` where it is absent, empty or not ASCII.
    pub fn text(&self, tag: Attribute) -> Option<&'a str> {
        let text = std::str::from_utf8(self.bytes(tag)?).ok()?;
        let text = text.trim_matches(|c: char| c == ' ' || c == '\0');
        (text.is_ascii() && !text.is_empty()).then_some(text)
    }

    /// The first item of a sequence.
    pub fn item(&self, tag: Attribute) -> Option<&DataSet<'a>> {
        match &self.get(tag)?.value {
            Value::Items(items) => items.first(),
            _ => None,
        }
    }

    /// All 16-bit values of an attribute.
    pub fn words(&self, tag: Attribute) -> Option<Vec<u16>> {
        let pairs = self.bytes(tag)?.as_chunks::<2>().0;
        Some(pairs.iter().map(|&pair| self.encoding.u16(pair)).collect())
    }

    /// The one 16-bit value of an attribute.
    ///
    /// # Errors
    /// [`FilmError::Element`] if it is there and is something else.
    pub fn word(&self, tag: Attribute) -> Result<Option<u16>, FilmError> {
        let Some(element) = self.get(tag) else { return Ok(None) };
        match (&element.value, element.vr) {
            (&Value::Bytes(&[a, b]), VR::US | VR::SS) => Ok(Some(self.encoding.u16([a, b]))),
            (Value::Bytes([]), _) => Ok(None),
            _ => Err(FilmError::Element { attribute: tag, fault: ElementFault::Value }),
        }
    }
}
