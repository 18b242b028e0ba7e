//! Checks of a data set before dicom-rs reads it, which trusts lengths and recurses without limit: each length against
//! the bytes of the file, the depth of sequences, the number of elements. Headers are read by dicom-rs's decoders, so
//! that both see the same elements. Values are not read here, except that uncompressed pixels are located and not
//! copied.

use std::collections::BTreeSet;

use dicom_core::dictionary::{DataDictionary, DataDictionaryEntry, VirtualVr};
use dicom_core::header::DataElementHeader;
use dicom_core::{Tag, VR};
use dicom_dictionary_std::StandardDataDictionary;
use dicom_encoding::decode::Decode;
use dicom_encoding::decode::explicit_be::ExplicitVRBigEndianDecoder;
use dicom_encoding::decode::explicit_le::ExplicitVRLittleEndianDecoder;
use dicom_encoding::decode::implicit_le::StandardImplicitVRLittleEndianDecoder;

use super::error::{ElementFault, FilmError, Measure, Place};
use super::{Attribute, FilmLimits};

/// Encoding of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Encoding {
    pub explicit: bool,
    pub big_endian: bool,
}

impl Encoding {
    pub const IMPLICIT: Self = Self { explicit: false, big_endian: false };
    pub const EXPLICIT: Self = Self { explicit: true, big_endian: false };
}

pub(super) const PIXEL_DATA: Attribute = Attribute(0x7FE0, 0x0010);

/// Uncompressed pixels as in the file.
#[derive(Clone, Copy)]
pub(super) struct Native<'a> {
    pub vr: VR,
    pub bytes: &'a [u8],
}

/// A checked data set.
#[derive(Default)]
pub(super) struct Scan<'a> {
    /// Elements that dicom-rs reads correctly.
    pub parts: Vec<&'a [u8]>,
    pub native: Option<Native<'a>>,
    /// Elements that it would misread, and repeated ones. They are not needed.
    pub left_out: Vec<Attribute>,
}

const ITEM: Tag = Tag(0xFFFE, 0xE000);
const ITEM_END: Tag = Tag(0xFFFE, 0xE00D);
const SEQUENCE_END: Tag = Tag(0xFFFE, 0xE0DD);
const CHARACTER_SET: Attribute = Attribute(0x0008, 0x0005);

/// Checks a data set; file meta information ends with group 0002. Returns where it ends.
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
        let header = scanner.header(encoding, Place::InElement)?;
        let native = scanner.element(header, encoding, 0)?;
        let tag = header.tag.into();
        let first = seen.insert(tag);
        match native {
            Some(native) if tag == PIXEL_DATA && first => scan.native = Some(native),
            // Only ASCII is read of a film, in any character set.
            _ if scanner.unfit || !first || tag == CHARACTER_SET => scan.left_out.push(tag),
            _ => scan.parts.push(&data[start..scanner.position]),
        }
    }
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
    fn header(&mut self, encoding: Encoding, place: Place) -> Result<DataElementHeader, FilmError> {
        self.elements += 1;
        Measure::Elements.within(self.elements as u64, self.limits.elements as u64)?;
        let mut rest = &self.data[self.position..];
        let letters = rest.get(4..6).filter(|_| encoding.explicit);
        let read = match encoding {
            Encoding { explicit: false, .. } => {
                StandardImplicitVRLittleEndianDecoder::default().decode_header(&mut rest)
            }
            Encoding { big_endian: false, .. } => {
                ExplicitVRLittleEndianDecoder::default().decode_header(&mut rest)
            }
            _ => ExplicitVRBigEndianDecoder::default().decode_header(&mut rest),
        };
        // A read can only fail for lack of bytes.
        let (header, length) = read.map_err(|_| FilmError::Truncated { place })?;
        if header.tag.0 != ITEM.0
            && letters.is_some_and(|vr| !vr.iter().all(u8::is_ascii_uppercase))
        {
            let (attribute, fault) = (header.tag.into(), ElementFault::ValueRepresentation);
            return Err(FilmError::Element { attribute, fault });
        }
        self.position += length;
        Ok(header)
    }

    /// The end of a value of this length, which must be before `end`.
    fn end(&self, tag: Tag, length: u32, end: usize) -> Result<usize, FilmError> {
        let remaining = end.saturating_sub(self.position) as u64;
        let (attribute, length) = (tag.into(), u64::from(length));
        if length > remaining {
            return Err(FilmError::Length { attribute, length, remaining });
        }
        Ok(self.position + length as usize)
    }

    /// Passes the content after a header; returns its bytes, if they are a value.
    fn element(
        &mut self,
        header: DataElementHeader,
        encoding: Encoding,
        depth: usize,
    ) -> Result<Option<Native<'a>>, FilmError> {
        let DataElementHeader { tag, vr, len } = header;
        let broken = |fault| Err(FilmError::Element { attribute: tag.into(), fault });
        if tag.0 == ITEM.0 {
            return broken(ElementFault::NotAnItem);
        }
        self.unfit |= depth > 0 && tag == CHARACTER_SET.into();
        let Some(length) = len.get() else {
            if tag == PIXEL_DATA.into() {
                self.fragments(encoding)?;
            } else if encoding.explicit && vr == VR::UN {
                // Implicit inside, whatever the outer syntax (PS3.5, 6.2.2); dicom-rs would read it in the
                // outer syntax.
                self.unfit = true;
                self.items(tag, Encoding::IMPLICIT, None, depth)?;
            } else if !encoding.explicit || vr == VR::SQ {
                self.items(tag, encoding, None, depth)?;
            } else {
                return broken(ElementFault::UndefinedLength);
            }
            return Ok(None);
        };
        let end = self.end(tag, length, self.data.len())?;
        // The rest of a value would be read as the next element.
        self.unfit |= length % unit(tag, vr) != 0;
        if vr == VR::SQ {
            self.items(tag, encoding, Some(end), depth)?;
            return Ok(None);
        }
        let bytes = &self.data[self.position..end];
        self.position = end;
        Ok(Some(Native { vr, bytes }))
    }

    /// Passes the items of a sequence, to a known end or to a delimiter.
    fn items(
        &mut self,
        tag: Tag,
        encoding: Encoding,
        end: Option<usize>,
        depth: usize,
    ) -> Result<(), FilmError> {
        Measure::Depth.within(depth as u64 + 1, self.limits.depth as u64)?;
        while !self.is_at(end, tag)? {
            let mark = self.header(encoding, Place::InSequence)?;
            if mark.tag == SEQUENCE_END && end.is_none() {
                return Ok(());
            }
            if mark.tag != ITEM {
                let (attribute, fault) = (tag.into(), ElementFault::NotAnItem);
                return Err(FilmError::Element { attribute, fault });
            }
            let outer = end.unwrap_or(self.data.len());
            let end = mark.len.get().map(|length| self.end(ITEM, length, outer)).transpose()?;
            while !self.is_at(end, tag)? {
                let header = self.header(encoding, Place::InElement)?;
                if header.tag == ITEM_END && end.is_none() {
                    break;
                }
                self.element(header, encoding, depth + 1)?;
            }
        }
        Ok(())
    }

    /// Whether a known end is reached. A position past it, or past all bytes, is an error.
    fn is_at(&self, end: Option<usize>, tag: Tag) -> Result<bool, FilmError> {
        match end {
            Some(end) if self.position > end => {
                Err(FilmError::Element { attribute: tag.into(), fault: ElementFault::Value })
            }
            Some(end) => Ok(self.position == end),
            None if self.position == self.data.len() => {
                Err(FilmError::Truncated { place: Place::InSequence })
            }
            None => Ok(false),
        }
    }

    fn fragments(&mut self, encoding: Encoding) -> Result<(), FilmError> {
        let broken = |fault| Err(FilmError::Element { attribute: PIXEL_DATA, fault });
        let mut is_table = true;
        loop {
            let mark = self.header(encoding, Place::InFragments)?;
            match mark.tag {
                SEQUENCE_END => return Ok(()),
                // Offsets have four bytes.
                ITEM if is_table && mark.len.0 % 4 != 0 => return broken(ElementFault::Value),
                ITEM => self.position = self.end(PIXEL_DATA.into(), mark.len.0, self.data.len())?,
                _ => return broken(ElementFault::NotAnItem),
            }
            is_table = false;
        }
    }
}

fn is_zero(bytes: &[u8]) -> bool {
    bytes.len() >= 8 && bytes[..8].iter().all(|&b| b == 0) && bytes.iter().all(|&b| b == 0)
}

/// Bytes per value, as dicom-rs reads them.
fn unit(tag: Tag, vr: VR) -> u32 {
    let known = StandardDataDictionary.by_tag(tag).map(DataDictionaryEntry::vr);
    match vr {
        VR::US | VR::SS | VR::OW => 2,
        VR::AT | VR::FL | VR::OF | VR::OL | VR::SL | VR::UL => 4,
        VR::FD | VR::OD | VR::OV | VR::SV | VR::UV => 8,
        // Words, for signed pixels, whatever the file states.
        _ if known == Some(VirtualVr::Xs) => 2,
        _ => 1,
    }
}
