//! A look at the structure of a report before it is read.
//!
//! The reader of the DICOM library calls itself for every sequence within a sequence, so a file of nothing but their
//! beginnings would exhaust the stack. This looks along the file once, without calling itself, and refuses such files,
//! lengths beyond the end of the file, and encodings other than ours.

use dicom_core::Tag;
use dicom_dictionary_std::{tags, uids};

/// A report of ours has eight.
const DEEPEST: usize = 16;
const UNDEFINED: u32 = u32::MAX;
const ITEM: Tag = Tag(0xfffe, 0xe000);
const END_OF_ITEM: Tag = Tag(0xfffe, 0xe00d);
const END_OF_SEQUENCE: Tag = Tag(0xfffe, 0xe0dd);

/// What is wrong with the structure of a file; nothing for one that may be read.
pub fn check(bytes: &[u8]) -> Result<(), &'static str> {
    let mut at = 132;
    // Where each open sequence ends, where that is known.
    let mut open: Vec<Option<usize>> = Vec::new();
    let mut syntax_seen = false;
    while at < bytes.len() {
        while let Some(Some(end)) = open.last()
            && at >= *end
        {
            open.pop();
        }
        let header = bytes.get(at..at + 8).ok_or("it is cut off")?;
        let half = |i: usize| u16::from_le_bytes([header[i], header[i + 1]]);
        let tag = Tag(half(0), half(2));
        match tag {
            ITEM | END_OF_ITEM => at += 8,
            END_OF_SEQUENCE => {
                open.pop();
                at += 8;
            }
            _ => {
                let vr = &header[4..6];
                let (length, data) = if is_long(vr) {
                    let long = bytes.get(at + 8..at + 12).ok_or("it is cut off")?;
                    (u32::from_le_bytes([long[0], long[1], long[2], long[3]]), at + 12)
                } else {
                    (u32::from(half(6)), at + 8)
                };
                if vr == b"SQ" {
                    open.push((length != UNDEFINED).then(|| data + length as usize));
                    if open.len() > DEEPEST {
                        return Err("its sequences are nested deeper than any report's");
                    }
                    at = data;
                } else {
                    let end = data.checked_add(length as usize).filter(|&end| end <= bytes.len());
                    let end = end.ok_or("an element is longer than the file")?;
                    if tag == tags::TRANSFER_SYNTAX_UID {
                        syntax_seen = true;
                        let syntax = bytes[data..end].trim_ascii_end();
                        let syntax = syntax.strip_suffix(b"\0").unwrap_or(syntax);
                        if syntax != uids::EXPLICIT_VR_LITTLE_ENDIAN.as_bytes() {
                            return Err("it is not in explicit VR little endian");
                        }
                    }
                    at = end;
                }
            }
        }
    }
    if syntax_seen { Ok(()) } else { Err("it has no transfer syntax") }
}

fn is_long(vr: &[u8]) -> bool {
    matches!(
        vr,
        b"OB"
            | b"OD"
            | b"OF"
            | b"OL"
            | b"OV"
            | b"OW"
            | b"SQ"
            | b"SV"
            | b"UC"
            | b"UN"
            | b"UR"
            | b"UT"
            | b"UV"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(rest: &[u8]) -> Vec<u8> {
        let mut bytes = vec![0; 128];
        bytes.extend(b"DICM");
        bytes.extend([2, 0, 0x10, 0, b'U', b'I', 20, 0]);
        bytes.extend(b"1.2.840.10008.1.2.1\0");
        bytes.extend(rest);
        bytes
    }

    #[test]
    fn sequences_within_sequences_end_somewhere() {
        let begin = [0x40, 0, 0x30, 0xa7, b'S', b'Q', 0, 0, 0xff, 0xff, 0xff, 0xff];
        let item = [0xfe, 0xff, 0, 0xe0, 0xff, 0xff, 0xff, 0xff];
        let deep: Vec<u8> = (0..100_000).flat_map(|_| begin.into_iter().chain(item)).collect();
        assert!(check(&file(&deep)).is_err_and(|reason| reason.contains("nested")));
        assert_eq!(check(&file(&[])), Ok(()));
    }

    #[test]
    fn a_length_beyond_the_end_is_refused() {
        let long = [0x40, 0, 0x60, 0xa1, b'U', b'T', 0, 0, 0xff, 0xff, 0xff, 0x7f, b'a'];
        assert!(check(&file(&long)).is_err_and(|reason| reason.contains("longer")));
        assert!(check(&file(&long[..6])).is_err_and(|reason| reason.contains("cut off")));
    }
}
