//! The markers of JPEG and JPEG-LS up to the first scan, checked before decoding.

use super::Format;
use crate::error::CodecFault;

/// Start of frame of JPEG-LS.
pub(super) const JPEG_LS: u8 = 0xF7;
/// Start of frame of lossless JPEG with Huffman codes.
const LOSSLESS: u8 = 0xC3;
/// The end of an image, or of a codestream of JPEG 2000.
pub(crate) const END: [u8; 2] = [0xFF, 0xD9];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Frame {
    /// The second byte of its marker.
    pub kind: u8,
    pub bits: u8,
    pub columns: u16,
    pub rows: u16,
    pub components: u8,
}

impl Frame {
    /// Checks the frame against the data set.
    pub fn check(self, format: Format, components: u8) -> Result<(), CodecFault> {
        let stated = [u32::from(format.columns), u32::from(format.rows)];
        let coded = [u32::from(self.columns), u32::from(self.rows)];
        if coded != stated {
            return Err(CodecFault::Size { coded, stated });
        }
        if self.components != components || format.samples != components {
            return Err(CodecFault::Components { count: u16::from(self.components) });
        }
        if !(2..=format.allocated).contains(&self.bits) {
            return Err(CodecFault::Precision { bits: self.bits });
        }
        Ok(())
    }
}

/// Checks a lossy picture against the data set; returns the bits of its decoded samples.
pub(super) fn check_lossy(data: &[u8], format: Format) -> Result<u8, CodecFault> {
    let (segments, start) = segments(data)?;
    let frame = only_frame(&segments)?;
    if !matches!(frame.kind, 0xC0..=0xC2) {
        return Err(CodecFault::Unsupported);
    }
    frame.check(format, format.samples)?;
    if frame.bits != 8 {
        return Err(CodecFault::LossyPrecision { bits: frame.bits });
    }
    has_end(&data[start..])?;
    Ok(frame.bits)
}

/// Checks a lossless picture against the data set, and refuses features that the decoder gets wrong: restart markers,
/// after which the prediction begins anew, and dropped low bits. Returns the bits of its decoded samples.
pub(super) fn check_lossless(data: &[u8], format: Format) -> Result<u8, CodecFault> {
    let (segments, start) = segments(data)?;
    let frame = only_frame(&segments)?;
    if frame.kind != LOSSLESS {
        return Err(CodecFault::Unsupported);
    }
    frame.check(format, 1)?;
    let restarts = segments.iter().filter(|segment| segment.kind == 0xDD).any(|segment| {
        let interval = segment.body.first_chunk::<2>().map_or(0, |&pair| u16::from_be_bytes(pair));
        interval != 0 && usize::from(interval) < format.pixels()
    });
    let Some(&[1, _, _, 1..=7, 0, shifts]) = segments.last().map(|s| s.body) else {
        return Err(CodecFault::Unsupported);
    };
    if restarts || shifts & 0x0F != 0 {
        return Err(CodecFault::Unsupported);
    }
    has_end(&data[start..])?;
    Ok(if frame.bits == 8 { 8 } else { 16 })
}

/// Checks that the end of the image exists: the decoder would invent a missing part. JPEG 2000 has the same marker. It
/// cannot occur within a scan.
pub(super) fn has_end(scan: &[u8]) -> Result<(), CodecFault> {
    let found = scan.windows(2).rev().any(|pair| pair == END);
    if found { Ok(()) } else { Err(CodecFault::Truncated) }
}

/// The same of the file of a picture. A header that cannot be read is left to its decoder.
pub(crate) fn check_end(data: &[u8]) -> Result<(), CodecFault> {
    segments(data).map_or(Ok(()), |(_, start)| has_end(&data[start..]))
}

/// Whether all rows of a JPEG are in one scan without restart intervals: then every byte that is missing changes the picture.
pub(crate) fn is_one_scan(data: &[u8]) -> bool {
    let Ok((segments, _)) = segments(data) else { return false };
    let is_sequential = only_frame(&segments).is_ok_and(|frame| {
        let scanned = segments.last().and_then(|scan| scan.body.first());
        matches!(frame.kind, 0xC0 | 0xC1) && scanned == Some(&frame.components)
    });
    is_sequential && segments.iter().all(|segment| segment.kind != 0xDD)
}

/// One marker segment: kind and content.
pub(crate) struct Segment<'a> {
    pub kind: u8,
    pub body: &'a [u8],
    /// Where the next one begins.
    pub end: usize,
}

/// The segment that begins at a place.
fn segment(data: &[u8], start: usize) -> Result<Segment<'_>, CodecFault> {
    let mut at = start;
    if data.get(at).ok_or(CodecFault::Truncated)? != &0xFF {
        return Err(CodecFault::Header);
    }
    // Fill bytes may stand before a marker.
    while data.get(at) == Some(&0xFF) {
        at += 1;
    }
    let kind = *data.get(at).ok_or(CodecFault::Truncated)?;
    at += 1;
    if matches!(kind, 0x00 | 0x01 | 0xD0..=0xD9) {
        return Ok(Segment { kind, body: &[], end: at });
    }
    let length = data[at..].first_chunk::<2>().ok_or(CodecFault::Truncated)?;
    let length = usize::from(u16::from_be_bytes(*length));
    if length < 2 {
        return Err(CodecFault::Header);
    }
    let body = data.get(at + 2..at + length).ok_or(CodecFault::Truncated)?;
    Ok(Segment { kind, body, end: at + length })
}

/// The segment of a header that begins at a place: one that has a length.
pub(crate) fn header_segment(data: &[u8], start: usize) -> Result<Segment<'_>, CodecFault> {
    let found = segment(data, start)?;
    match found.kind {
        0x00 | 0x01 | 0xD0..=0xD9 => Err(CodecFault::Header),
        _ => Ok(found),
    }
}

/// All segments up to the first scan, its header included; then where its data begin.
fn segments(data: &[u8]) -> Result<(Vec<Segment<'_>>, usize), CodecFault> {
    if !data.starts_with(&[0xFF, 0xD8]) {
        return Err(CodecFault::Header);
    }
    let mut at = 2;
    let mut segments = Vec::new();
    loop {
        let next = header_segment(data, at)?;
        at = next.end;
        let scan = next.kind == 0xDA;
        segments.push(next);
        if scan {
            return Ok((segments, at));
        }
    }
}

/// The one frame header before the first scan.
pub(super) fn frame(data: &[u8]) -> Result<Frame, CodecFault> {
    let (segments, _) = segments(data)?;
    only_frame(&segments)
}

fn only_frame(segments: &[Segment<'_>]) -> Result<Frame, CodecFault> {
    let is_frame = |kind: u8| {
        kind == JPEG_LS || matches!(kind, 0xC0..=0xCF) && !matches!(kind, 0xC4 | 0xC8 | 0xCC)
    };
    let mut frames = segments.iter().filter(|segment| is_frame(segment.kind));
    let (Some(found), None) = (frames.next(), frames.next()) else {
        return Err(CodecFault::Header);
    };
    let &[bits, r1, r0, c1, c0, components, ref rest @ ..] = found.body else {
        return Err(CodecFault::Header);
    };
    if rest.len() != 3 * usize::from(components) {
        return Err(CodecFault::Header);
    }
    let (rows, columns) = (u16::from_be_bytes([r1, r0]), u16::from_be_bytes([c1, c0]));
    Ok(Frame { kind: found.kind, bits, columns, rows, components })
}
