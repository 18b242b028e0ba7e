//! The container of a data set: preamble, file meta information, transfer syntax and file-wide compression.

use std::borrow::Cow;
use std::io::Read;

use dicom_dictionary_std::tags;

use super::element::{Attributes, parse_meta};
use super::error::{Codec, CodecFault, FilmError, Lookalike, Measure, Place};
use super::scan::Encoding;
use super::{FilmKind, FilmLimits, FilmRemark};

/// How the pixels of a transfer syntax are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Native,
    Codec(Codec),
}

/// A transfer syntax of DICOM PS3.5, annex A.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Syntax {
    pub uid: &'static str,
    pub name: &'static str,
    pub encoding: Encoding,
    pub packing: Packing,
    pub deflated: bool,
}

const fn packed(uid: &'static str, name: &'static str, codec: Codec) -> Syntax {
    Syntax {
        uid,
        name,
        encoding: Encoding::EXPLICIT,
        packing: Packing::Codec(codec),
        deflated: false,
    }
}

const fn native(uid: &'static str, name: &'static str, encoding: Encoding) -> Syntax {
    Syntax { uid, name, encoding, packing: Packing::Native, deflated: false }
}

const BIG_ENDIAN: Encoding = Encoding { explicit: true, big_endian: true };

pub(super) const IMPLICIT: Syntax =
    native("1.2.840.10008.1.2", "Implicit VR Little Endian", Encoding::IMPLICIT);
pub(super) const EXPLICIT: Syntax =
    native("1.2.840.10008.1.2.1", "Explicit VR Little Endian", Encoding::EXPLICIT);
const EXPLICIT_BIG: Syntax = native("1.2.840.10008.1.2.2", "Explicit VR Big Endian", BIG_ENDIAN);

const SYNTAXES: [Syntax; 16] = [
    IMPLICIT,
    EXPLICIT,
    Syntax {
        deflated: true,
        ..native("1.2.840.10008.1.2.1.99", "Deflated Explicit VR Little Endian", Encoding::EXPLICIT)
    },
    EXPLICIT_BIG,
    packed("1.2.840.10008.1.2.4.50", "JPEG Baseline (Process 1)", Codec::Jpeg),
    packed("1.2.840.10008.1.2.4.51", "JPEG Extended (Process 2 and 4)", Codec::Jpeg),
    packed("1.2.840.10008.1.2.4.57", "JPEG Lossless (Process 14)", Codec::JpegLossless),
    packed(
        "1.2.840.10008.1.2.4.70",
        "JPEG Lossless (Process 14, Selection Value 1)",
        Codec::JpegLossless,
    ),
    packed("1.2.840.10008.1.2.4.80", "JPEG-LS Lossless", Codec::JpegLs),
    packed("1.2.840.10008.1.2.4.81", "JPEG-LS Near-Lossless", Codec::JpegLs),
    packed("1.2.840.10008.1.2.4.90", "JPEG 2000 (Lossless Only)", Codec::Jpeg2000),
    packed("1.2.840.10008.1.2.4.91", "JPEG 2000", Codec::Jpeg2000),
    packed("1.2.840.10008.1.2.4.201", "HTJ2K (Lossless Only)", Codec::Jpeg2000),
    packed("1.2.840.10008.1.2.4.202", "HTJ2K with RPCL (Lossless Only)", Codec::Jpeg2000),
    packed("1.2.840.10008.1.2.4.203", "HTJ2K", Codec::Jpeg2000),
    packed("1.2.840.10008.1.2.5", "RLE Lossless", Codec::Rle),
];

/// Parts of a DICOM file.
pub(super) struct Container<'a> {
    pub syntax: Syntax,
    pub body: Cow<'a, [u8]>,
    pub remarks: Vec<FilmRemark>,
}

/// The kind of a film by its first bytes.
///
/// # Errors
/// [`FilmError::NotAFilm`].
pub fn sniff(bytes: &[u8]) -> Result<FilmKind, FilmError> {
    let at = |offset: usize, magic: &[u8]| {
        bytes.get(offset..).is_some_and(|rest| rest.starts_with(magic))
    };
    // A DICOM file may have another format's header in its preamble, so DICOM is checked first.
    if at(128, b"DICM") {
        return Ok(FilmKind::Dicom);
    }
    let kinds: [(&[u8], FilmKind); 6] = [
        (b"\x89PNG\r\n\x1a\n", FilmKind::Png),
        (b"\xff\xd8\xff", FilmKind::Jpeg),
        (b"II*\0", FilmKind::Tiff),
        (b"MM\0*", FilmKind::Tiff),
        (b"II+\0", FilmKind::Tiff),
        (b"MM\0+", FilmKind::Tiff),
    ];
    if let Some((_, kind)) = kinds.into_iter().find(|(magic, _)| at(0, magic)) {
        return Ok(kind);
    }
    let letters = bytes.get(4..6).is_some_and(|vr| vr.iter().all(u8::is_ascii_uppercase));
    if guess_encoding(bytes).is_some() || at(0, &[2, 0]) && letters {
        return Ok(FilmKind::Dicom);
    }
    let others: [(usize, &[u8], Lookalike); 12] = [
        (0, b"PK", Lookalike::Zip),
        (0, b"\x1f\x8b", Lookalike::Gzip),
        (0, b"%PDF", Lookalike::Pdf),
        (4, b"ftyp", Lookalike::Heic),
        (0, b"GIF8", Lookalike::Gif),
        (0, b"BM", Lookalike::Bmp),
        (8, b"WEBP", Lookalike::Webp),
        (0, b"MZ", Lookalike::Program),
        (0, b"\x7fELF", Lookalike::Program),
        (0, b"<", Lookalike::Text),
        (0, b"{", Lookalike::Text),
        (0, b"\xef\xbb\xbf", Lookalike::Text),
    ];
    let looks_like = match others.into_iter().find(|&(offset, magic, _)| at(offset, magic)) {
        _ if bytes.is_empty() => Lookalike::Empty,
        Some((_, _, looks_like)) => looks_like,
        None => Lookalike::Unknown,
    };
    Err(FilmError::NotAFilm { looks_like })
}

/// The encoding of a data set without file meta information, if its first element can be one: of group 0008, where
/// every image begins, and no longer than the file.
fn guess_encoding(bytes: &[u8]) -> Option<Syntax> {
    let header = bytes.first_chunk::<8>()?;
    let little = header[0] == 8 && header[1] == 0;
    let big = header[0] == 0 && header[1] == 8;
    let letters = header[4..6].iter().all(u8::is_ascii_uppercase);
    if letters && (little || big) {
        return Some(if little { EXPLICIT } else { EXPLICIT_BIG });
    }
    let length = u32::from_le_bytes([header[4], header[5], header[6], header[7]]);
    let fits = u64::from(length) <= bytes.len() as u64 || length == u32::MAX;
    (little && fits).then_some(IMPLICIT)
}

/// Splits a DICOM file and undoes its file-wide compression.
pub(super) fn open<'a>(bytes: &'a [u8], limits: &FilmLimits) -> Result<Container<'a>, FilmError> {
    let mut remarks = Vec::new();
    let start = if bytes.get(128..132) == Some(b"DICM".as_slice()) {
        132
    } else {
        remarks.push(FilmRemark::NoPreamble);
        0
    };
    let rest = &bytes[start..];
    let (meta, length) = parse_meta(rest, limits)?;
    let body = &rest[length..];
    let syntax = match meta.object.text(tags::TRANSFER_SYNTAX_UID) {
        Some(uid) => SYNTAXES.into_iter().find(|syntax| syntax.uid == uid).ok_or_else(|| {
            let known = uid.starts_with("1.2.840.10008.") && uid.len() <= 64;
            let clean = uid.bytes().all(|b| b.is_ascii_digit() || b == b'.');
            FilmError::TransferSyntax { uid: (known && clean).then_some(uid) }
        })?,
        None if !meta.is_without(tags::TRANSFER_SYNTAX_UID) => {
            return Err(FilmError::TransferSyntax { uid: None });
        }
        None => {
            let syntax =
                guess_encoding(body).ok_or(FilmError::Truncated { place: Place::InMeta })?;
            remarks.push(FilmRemark::TransferSyntaxGuessed { name: syntax.name.into() });
            syntax
        }
    };
    let body =
        if syntax.deflated { Cow::Owned(inflate(body, limits)?) } else { Cow::Borrowed(body) };
    Ok(Container { syntax, body, remarks })
}

fn inflate(body: &[u8], limits: &FilmLimits) -> Result<Vec<u8>, FilmError> {
    let mut inflated = Vec::new();
    let mut decoder = flate2::read::DeflateDecoder::new(body).take(limits.inflated_bytes + 1);
    let fault = match decoder.read_to_end(&mut inflated) {
        Ok(_) => {
            let found = inflated.len() as u64;
            return Measure::InflatedBytes.within(found, limits.inflated_bytes).map(|()| inflated);
        }
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => CodecFault::Truncated,
        Err(_) => CodecFault::Corrupt,
    };
    Err(FilmError::Codec { codec: Codec::Deflate, fault })
}
