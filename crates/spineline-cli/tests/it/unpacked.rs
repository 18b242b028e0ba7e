//! Unpacks compressed and encoded parts of a file, so that a search finds texts in them too.

use std::io::Read;

use flate2::read::{DeflateDecoder, GzDecoder, ZlibDecoder};
use memchr::memmem;

/// Streams within streams.
const DEPTH: usize = 4;
/// Bytes of one stream; what comes after them is not searched.
const LARGEST: u64 = 64 << 20;

/// A file, and the contents of every compressed stream and Base64 text in it: of PDF, PNG, ZIP, gzip, deflated DICOM, and
/// pictures within HTML and SVG.
pub fn unpacked(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut all = vec![bytes.to_vec()];
    let mut newest = 0..1;
    for _ in 0..DEPTH {
        let inner: Vec<Vec<u8>> = all[newest.clone()].iter().flat_map(|one| packed(one)).collect();
        newest = all.len()..all.len() + inner.len();
        all.extend(inner);
    }
    all
}

/// Whether a file holds a text: as it is, in UTF-16, in hexadecimal digits, or written for an address.
pub fn holds(bytes: &[u8], text: &str) -> bool {
    first_held(bytes, &[text]).is_some()
}

/// The first of some texts that a file holds. It is unpacked once for all of them.
pub fn first_held<'a>(bytes: &[u8], texts: &[&'a str]) -> Option<&'a str> {
    let parts = unpacked(bytes);
    let is_held = |form: &String| {
        let finder = memmem::Finder::new(form);
        parts.iter().any(|part| finder.find(part).is_some())
    };
    texts.iter().find(|text| forms(text).iter().any(is_held)).copied()
}

/// The ways in which a text may stand in a file.
fn forms(text: &str) -> [String; 7] {
    let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    // Of UTF-16 the zero bytes between letters, which either order of bytes has.
    let wide = text.chars().map(String::from).collect::<Vec<_>>().join("\0");
    [
        text.to_owned(),
        text.replace('-', "%2D"),
        hex(text.as_bytes()),
        hex(text.as_bytes()).to_ascii_uppercase(),
        hex(wide.as_bytes()),
        hex(wide.as_bytes()).to_ascii_uppercase(),
        wide,
    ]
}

/// The contents of the streams that stand in some bytes.
fn packed(bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut found = Vec::new();
    for at in 0..bytes.len() {
        let rest = &bytes[at..];
        // Most bytes do not begin a stream.
        if !matches!(rest[0], 0x1f | b'P' | b'b') && rest[0] & 0x0f != 8 {
            continue;
        }
        if rest.starts_with(b"\x1f\x8b\x08") {
            found.extend(decoded(GzDecoder::new(rest)));
        } else if rest.starts_with(b"PK\x03\x04") {
            found.extend(zip_entry(rest));
        } else if is_zlib(rest) {
            found.extend(decoded(ZlibDecoder::new(rest)));
        } else if rest.starts_with(b"base64,") {
            found.push(base64(&rest[7..]));
        }
    }
    found.extend(deflated_data_set(bytes).and_then(|rest| decoded(DeflateDecoder::new(rest))));
    found
}

/// The header of a zlib stream: its method, a window of at most 32 KiB, and its check bits.
fn is_zlib(bytes: &[u8]) -> bool {
    let [method, flags, ..] = bytes else { return false };
    method & 0x0f == 8
        && method >> 4 <= 7
        && flags & 0x20 == 0
        && u16::from_be_bytes([*method, *flags]).is_multiple_of(31)
}

/// As much of a stream as can be decoded; `None` where that is nothing.
fn decoded(stream: impl Read) -> Option<Vec<u8>> {
    let mut contents = Vec::new();
    let mut part = [0; 4096];
    let mut stream = stream.take(LARGEST);
    // A stream that is cut off or damaged still holds what comes before.
    while let Ok(count @ 1..) = stream.read(&mut part) {
        contents.extend_from_slice(&part[..count]);
    }
    (contents.len() > 4).then_some(contents)
}

/// The contents of a deflated entry of an archive, from its local header on.
fn zip_entry(bytes: &[u8]) -> Option<Vec<u8>> {
    let word =
        |at: usize| Some(usize::from(u16::from_le_bytes([*bytes.get(at)?, *bytes.get(at + 1)?])));
    let start = 30 + word(26)? + word(28)?;
    if word(8)? == 8 { decoded(DeflateDecoder::new(bytes.get(start..)?)) } else { None }
}

/// The deflated data set of a DICOM file, after its meta elements.
fn deflated_data_set(bytes: &[u8]) -> Option<&[u8]> {
    let mut rest = bytes.get(132..).filter(|_| bytes.get(128..132) == Some(b"DICM"))?;
    let mut is_deflated = false;
    while rest.starts_with(&[2, 0]) {
        let is_long = [b"OB", b"OW", b"UN"].iter().any(|vr| rest.get(4..6) == Some(vr.as_slice()));
        let (head, length) = if is_long {
            (12, u32::from_le_bytes(rest.get(8..12)?.try_into().ok()?) as usize)
        } else {
            (8, usize::from(u16::from_le_bytes(rest.get(6..8)?.try_into().ok()?)))
        };
        let value = rest.get(head..head + length)?;
        is_deflated |= rest[2] == 0x10 && value.starts_with(b"1.2.840.10008.1.2.1.99");
        rest = &rest[head + length..];
    }
    is_deflated.then_some(rest)
}

/// Base64 up to the first byte that is not of it.
fn base64(bytes: &[u8]) -> Vec<u8> {
    let digit = |&byte: &u8| {
        Some(match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        })
    };
    let (mut held, mut bits, mut out) = (0_u32, 0, Vec::new());
    for value in bytes.iter().map_while(digit) {
        held = ((held << 6) | u32::from(value)) & 0xfff;
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            out.push(((held >> bits) & 0xff) as u8);
        }
    }
    out
}

/// One canary in every kind of wrapping that an output can have, each by name.
pub fn wrapped(canary: &str) -> Vec<(&'static str, Vec<u8>)> {
    use std::io::Write;
    let zlib = |bytes: &[u8]| {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(bytes).expect("into memory");
        encoder.finish().expect("into memory")
    };
    let raw = |bytes: &[u8]| {
        let mut encoder =
            flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(bytes).expect("into memory");
        encoder.finish().expect("into memory")
    };
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    gzip.write_all(canary.as_bytes()).expect("into memory");
    // Twice, so that no packing leaves the text as it is.
    let text = format!("{canary} {canary}");
    let pdf = [b"%PDF-1.7\n1 0 obj <</Filter /FlateDecode>> stream\n", &*zlib(text.as_bytes())];
    let mut zip = b"PK\x03\x04\x14\0\0\0\x08\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x01\0\0\0a".to_vec();
    zip.extend(raw(text.as_bytes()));
    let wide: Vec<u8> = canary.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let hex: String = wide.iter().map(|byte| format!("{byte:02X}")).collect();
    let nested = zlib(&[b"a picture: ", &*zlib(text.as_bytes())].concat());
    vec![
        ("UTF-16", wide),
        ("a string of PDF in hexadecimal digits", format!("<FEFF{hex}>").into_bytes()),
        ("a stream of PDF", pdf.concat()),
        ("gzip", gzip.finish().expect("into memory")),
        ("ZIP", zip),
        ("a stream in a stream", nested),
    ]
}
