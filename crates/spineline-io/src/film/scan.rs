//! What is checked of a data set before dicom-rs reads it, which believes lengths and recurses as deep as a file says: each
//! length against the bytes that are there, the depth of sequences, the number of elements. Values are nobody's business
//! here, but for the place of uncompressed pixels, which are not copied.

use std::collections::BTreeSet;

use dicom_core::dictionary::{DataDictionary, DataDictionaryEntry, VirtualVr};
use dicom_core::{Tag, VR};
use dicom_dictionary_std::StandardDataDictionary;

use super::element::{Encoding, PIXEL_DATA};
use super::error::{ElementFault, FilmError, Measure, Place};
use super::{Attribute, FilmLimits};

/// Uncompressed pixels as they stand in the file.
#[derive(Clone, Copy)]
pub(super) struct Native<'a> {
    pub vr: VR,
    pub bytes: &'a [u8],
}

/// A data set that may be read.
#[derive(Default)]
pub(super) struct Scan<'a> {
    /// Elements that dicom-rs reads as they are meant.
    pub parts: Vec<&'a [u8]>,
    pub native: Option<Native<'a>>,
    /// Elements that it would misread, and those that are there for a second time. Nothing here needs them.
    pub left_out: Vec<Attribute>,
}

const ITEM: Attribute = Attribute(0xFFFE, 0xE000);
const ITEM_END: Attribute = Attribute(0xFFFE, 0xE00D);
const SEQUENCE_END: Attribute = Attribute(0xFFFE, 0xE0DD);
const CHARACTER_SET: Attribute = Attribute(0x0008, 0x0005);
const UNDEFINED: u32 = u32::MAX;

/// Checks a data set; one of file meta information ends with group 0002. Says where it ends.
pub(super) fn scan<'a>(
    data: &'a [u8],
    encoding: Encoding,
    only_meta: bool,
    limits: &FilmLimits,
) -> Result<(Scan<'a>, usize), FilmError> {
    let mut scanner = Scanner { data, position: 0, elements: 0, unfit: false, limits };
    let (mut scan, mut seen) = (Scan::default(), BTreeSet::new());
    loop {
        let rest = &data[scanner.position..];
        // Some writers fill the last block of a medium with zeros.
        let ends = if only_meta { !rest.starts_with(&[2, 0]) } else { is_zero(rest) };
        if rest.is_empty() || ends {
            return Ok((scan, scanner.position));
        }
        let start = scanner.position;
        scanner.unfit = false;
        let (tag, native) = scanner.element(encoding, 0)?;
        let first = seen.insert(tag);
        match native {
            Some(native) if tag == PIXEL_DATA && first => scan.native = Some(native),
            // All that is read of a film is ASCII, whatever the other texts are.
            _ if scanner.unfit || !first || tag == CHARACTER_SET => scan.left_out.push(tag),
            _ => scan.parts.push(&data[start..scanner.position]),
        }
    }
}

#[derive(Clone, Copy)]
enum End {
    At(usize),
    Delimiter,
}

struct Scanner<'a, 'l> {
    data: &'a [u8],
    position: usize,
    elements: usize,
    /// Whether dicom-rs would misread the element, or one within.
    unfit: bool,
    limits: &'l FilmLimits,
}

impl<'a> Scanner<'a, '_> {
    fn array<const N: usize>(&mut self, place: Place) -> Result<[u8; N], FilmError> {
        let bytes = self.data[self.position..].first_chunk::<N>();
        let bytes = bytes.copied().ok_or(FilmError::Truncated { place })?;
        self.position += N;
        Ok(bytes)
    }

    /// Tag, value representation where it is stated, and length.
    fn header(
        &mut self,
        encoding: Encoding,
        place: Place,
    ) -> Result<(Attribute, Option<VR>, u32), FilmError> {
        self.elements += 1;
        let (found, limit) = (self.elements as u64, self.limits.elements as u64);
        if found > limit {
            return Err(FilmError::TooLarge { what: Measure::Elements, found, limit });
        }
        let group = encoding.u16(self.array(place)?);
        let tag = Attribute(group, encoding.u16(self.array(place)?));
        if !encoding.explicit || group == ITEM.0 {
            return Ok((tag, None, encoding.u32(self.array(place)?)));
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
        Ok((tag, Some(vr), length))
    }

    /// The end of a value of this length, which must be before `end`.
    fn end(&self, attribute: Attribute, length: u32, end: usize) -> Result<usize, FilmError> {
        let remaining = end.saturating_sub(self.position) as u64;
        let length = u64::from(length);
        if length > remaining {
            return Err(FilmError::Length { attribute, length, remaining });
        }
        Ok(self.position + length as usize)
    }

    fn element(
        &mut self,
        encoding: Encoding,
        depth: usize,
    ) -> Result<(Attribute, Option<Native<'a>>), FilmError> {
        let (tag, stated, length) = self.header(encoding, Place::InElement)?;
        let broken = |fault| Err(FilmError::Element { attribute: tag, fault });
        if tag.0 == ITEM.0 {
            return broken(ElementFault::NotAnItem);
        }
        let (vr, unit) = representation(tag, stated);
        self.unfit |= depth > 0 && tag == CHARACTER_SET;
        if length == UNDEFINED {
            if tag == PIXEL_DATA {
                self.fragments(encoding)?;
            } else if stated == Some(VR::UN) {
                // Implicit inside, whatever is around it (PS3.5, 6.2.2); dicom-rs reads it like what is around.
                self.unfit = true;
                self.items(tag, Encoding::IMPLICIT, End::Delimiter, depth)?;
            } else if matches!(stated, None | Some(VR::SQ)) {
                self.items(tag, encoding, End::Delimiter, depth)?;
            } else {
                return broken(ElementFault::UndefinedLength);
            }
            return Ok((tag, None));
        }
        let end = self.end(tag, length, self.data.len())?;
        // What is left over of a value would be taken for the next element.
        self.unfit |= length % unit != 0;
        if vr == VR::SQ {
            self.items(tag, encoding, End::At(end), depth)?;
            return Ok((tag, None));
        }
        let bytes = &self.data[self.position..end];
        self.position = end;
        Ok((tag, Some(Native { vr, bytes })))
    }

    fn items(
        &mut self,
        tag: Attribute,
        encoding: Encoding,
        end: End,
        depth: usize,
    ) -> Result<(), FilmError> {
        if depth >= self.limits.depth {
            let (found, limit) = (depth as u64 + 1, self.limits.depth as u64);
            return Err(FilmError::TooLarge { what: Measure::Depth, found, limit });
        }
        loop {
            if self.is_at(end, tag)? {
                return Ok(());
            }
            let (mark, _, length) = self.header(encoding, Place::InSequence)?;
            if mark == SEQUENCE_END && matches!(end, End::Delimiter) {
                return Ok(());
            }
            if mark != ITEM {
                return Err(FilmError::Element { attribute: tag, fault: ElementFault::NotAnItem });
            }
            let outer = if let End::At(end) = end { end } else { self.data.len() };
            let item_end = match length {
                UNDEFINED => End::Delimiter,
                length => End::At(self.end(ITEM, length, outer)?),
            };
            while !self.is_at(item_end, tag)? {
                if matches!(item_end, End::Delimiter) && self.is_next(ITEM_END, encoding) {
                    self.header(encoding, Place::InSequence)?;
                    break;
                }
                self.element(encoding, depth + 1)?;
            }
        }
    }

    /// Whether a known end is reached. To be past it, or past all bytes, is an error.
    fn is_at(&self, end: End, attribute: Attribute) -> Result<bool, FilmError> {
        match end {
            End::At(end) if self.position > end => {
                Err(FilmError::Element { attribute, fault: ElementFault::Value })
            }
            End::At(end) => Ok(self.position == end),
            End::Delimiter if self.position == self.data.len() => {
                Err(FilmError::Truncated { place: Place::InSequence })
            }
            End::Delimiter => Ok(false),
        }
    }

    fn is_next(&self, tag: Attribute, encoding: Encoding) -> bool {
        let found = self.data[self.position..].first_chunk::<4>();
        found.is_some_and(|&[a, b, c, d]| {
            tag == Attribute(encoding.u16([a, b]), encoding.u16([c, d]))
        })
    }

    fn fragments(&mut self, encoding: Encoding) -> Result<(), FilmError> {
        let fault = |fault| FilmError::Element { attribute: PIXEL_DATA, fault };
        let mut is_table = true;
        loop {
            let (mark, _, length) = self.header(encoding, Place::InFragments)?;
            match mark {
                SEQUENCE_END => return Ok(()),
                // Offsets have four bytes.
                ITEM if is_table && length % 4 != 0 => return Err(fault(ElementFault::Value)),
                ITEM => self.position = self.end(PIXEL_DATA, length, self.data.len())?,
                _ => return Err(fault(ElementFault::NotAnItem)),
            }
            is_table = false;
        }
    }
}

fn is_zero(bytes: &[u8]) -> bool {
    bytes.len() >= 8 && bytes[..8].iter().all(|&b| b == 0) && bytes.iter().all(|&b| b == 0)
}

/// Value representations whose explicit length has 16 bits.
fn is_short(vr: VR) -> bool {
    use VR::{OB, OD, OF, OL, OV, OW, SQ, SV, UC, UN, UR, UT, UV};
    !matches!(vr, OB | OD | OF | OL | OV | OW | SQ | SV | UC | UN | UR | UT | UV)
}

/// The value representation as dicom-rs sees it, and the bytes of one value.
fn representation(tag: Attribute, stated: Option<VR>) -> (VR, u32) {
    let known = StandardDataDictionary.by_tag(Tag(tag.0, tag.1)).map(DataDictionaryEntry::vr);
    let is_words = tag == PIXEL_DATA || tag.0 >> 8 == 0x60 && tag.1 == 0x3000;
    let implied = if is_words { VR::OW } else { known.map_or(VR::UN, VirtualVr::relaxed) };
    let vr = stated.unwrap_or(implied);
    let unit = match vr {
        VR::US | VR::SS | VR::OW => 2,
        VR::AT | VR::FL | VR::OF | VR::OL | VR::SL | VR::UL => 4,
        VR::FD | VR::OD | VR::OV | VR::SV | VR::UV => 8,
        // Words, once the pixels are signed, whatever is stated.
        _ if known == Some(VirtualVr::Xs) => 2,
        _ => 1,
    };
    (vr, unit)
}
