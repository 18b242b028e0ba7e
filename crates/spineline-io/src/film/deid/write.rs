//! A data set written out.

use std::borrow::Cow;

use dicom_core::VR;

use super::super::Attribute;
use super::super::element::{Encoding, is_short};

/// An element to be written.
#[derive(Clone)]
pub(super) struct Out<'a> {
    pub tag: Attribute,
    pub vr: VR,
    pub value: OutValue<'a>,
}

#[derive(Clone)]
pub(super) enum OutValue<'a> {
    Bytes(Cow<'a, [u8]>),
    Items(Vec<Vec<Out<'a>>>),
    Fragments { table: &'a [u8], fragments: Vec<&'a [u8]> },
}

impl<'a> Out<'a> {
    pub fn text(tag: Attribute, vr: VR, text: impl Into<String>) -> Self {
        Self { tag, vr, value: OutValue::Bytes(Cow::Owned(text.into().into_bytes())) }
    }
}

const UNDEFINED: u32 = u32::MAX;

/// Appends elements in the order given.
pub(super) fn data_set(elements: &[Out<'_>], encoding: Encoding, to: &mut Vec<u8>) {
    for Out { tag, vr, value } in elements {
        match value {
            OutValue::Bytes(bytes) => {
                let padding = bytes.len() % 2;
                header(*tag, *vr, (bytes.len() + padding) as u32, encoding, to);
                to.extend_from_slice(bytes);
                let blank =
                    matches!(vr, VR::AS | VR::CS | VR::DS | VR::IS | VR::LO | VR::PN | VR::SH);
                to.extend(std::iter::repeat_n(if blank { b' ' } else { 0 }, padding));
            }
            OutValue::Items(items) => {
                header(*tag, VR::SQ, UNDEFINED, encoding, to);
                for item in items {
                    mark(Attribute(0xFFFE, 0xE000), UNDEFINED, encoding, to);
                    data_set(item, encoding, to);
                    mark(Attribute(0xFFFE, 0xE00D), 0, encoding, to);
                }
                mark(Attribute(0xFFFE, 0xE0DD), 0, encoding, to);
            }
            OutValue::Fragments { table, fragments } => {
                header(*tag, *vr, UNDEFINED, encoding, to);
                for fragment in std::iter::once(table).chain(fragments) {
                    mark(Attribute(0xFFFE, 0xE000), fragment.len() as u32, encoding, to);
                    to.extend_from_slice(fragment);
                }
                mark(Attribute(0xFFFE, 0xE0DD), 0, encoding, to);
            }
        }
    }
}

fn u16(value: u16, encoding: Encoding, to: &mut Vec<u8>) {
    to.extend(if encoding.big_endian { value.to_be_bytes() } else { value.to_le_bytes() });
}

fn u32(value: u32, encoding: Encoding, to: &mut Vec<u8>) {
    to.extend(if encoding.big_endian { value.to_be_bytes() } else { value.to_le_bytes() });
}

fn mark(tag: Attribute, length: u32, encoding: Encoding, to: &mut Vec<u8>) {
    u16(tag.0, encoding, to);
    u16(tag.1, encoding, to);
    u32(length, encoding, to);
}

fn header(tag: Attribute, vr: VR, length: u32, encoding: Encoding, to: &mut Vec<u8>) {
    if !encoding.explicit {
        return mark(tag, length, encoding, to);
    }
    u16(tag.0, encoding, to);
    u16(tag.1, encoding, to);
    to.extend_from_slice(vr.to_string().as_bytes());
    if is_short(vr) {
        // Nothing longer is kept; pixels and tables of 64 KiB have long lengths.
        u16(length as u16, encoding, to);
    } else {
        to.extend([0, 0]);
        u32(length, encoding, to);
    }
}

/// A whole file: an empty preamble, file meta information with nothing of the old one, and the data set.
pub(super) fn file(
    elements: &[Out<'_>],
    encoding: Encoding,
    uids: [Option<&str>; 2],
    transfer_syntax: &str,
) -> Vec<u8> {
    let mut meta = vec![Out {
        tag: Attribute(2, 1),
        vr: VR::OB,
        value: OutValue::Bytes(Cow::Borrowed(&[0, 1])),
    }];
    for (element, uid) in (2..).zip(uids) {
        meta.extend(uid.map(|uid| Out::text(Attribute(2, element), VR::UI, uid)));
    }
    meta.push(Out::text(Attribute(2, 0x10), VR::UI, transfer_syntax));
    meta.push(Out::text(Attribute(2, 0x12), VR::UI, IMPLEMENTATION_UID));
    let mut body = Vec::new();
    data_set(&meta, Encoding::EXPLICIT, &mut body);
    let length = (body.len() as u32).to_le_bytes();
    let group_length =
        Out { tag: Attribute(2, 0), vr: VR::UL, value: OutValue::Bytes(Cow::Borrowed(&length)) };
    let mut bytes = vec![0; 128];
    bytes.extend_from_slice(b"DICM");
    data_set(&[group_length], Encoding::EXPLICIT, &mut bytes);
    bytes.append(&mut body);
    data_set(elements, encoding, &mut bytes);
    bytes
}

/// This program among all that write DICOM files: the first 128 bits of the SHA-256 of `Spineline DICOM implementation
/// class`, below the root for such numbers.
const IMPLEMENTATION_UID: &str = "2.25.199203622922572123406629644538706388068";
