//! Checks of run lengths (DICOM PS3.5, annex G), because the decoder trusts the number and length of segments.

use super::Format;
use crate::error::CodecFault;

/// Checks that each byte of a pixel has a segment, and that each segment unpacks to one byte per pixel.
pub(super) fn check(data: &[u8], format: Format) -> Result<(), CodecFault> {
    let wanted = usize::from(format.allocated / 8) * usize::from(format.samples);
    let header = data.first_chunk::<64>().ok_or(CodecFault::Truncated)?;
    let words = header.as_chunks::<4>().0;
    let offset = |index: usize| u32::from_le_bytes(words[index]) as usize;
    if offset(0) != wanted {
        return Err(CodecFault::Header);
    }
    for index in 1..=wanted {
        let start = offset(index);
        let end = if index == wanted { data.len() } else { offset(index + 1) };
        if start < 64 || start > end {
            return Err(CodecFault::Header);
        }
        let segment = data.get(start..end).ok_or(CodecFault::Truncated)?;
        check_length(segment, format.pixels())?;
    }
    Ok(())
}

/// Checks that a segment unpacks to this number of bytes, or exceeds it only by a part of the last run.
fn check_length(mut segment: &[u8], pixels: usize) -> Result<(), CodecFault> {
    let mut unpacked = 0;
    while let Some((&control, rest)) = segment.split_first() {
        if unpacked > pixels + 128 {
            return Err(CodecFault::Corrupt);
        }
        let (count, packed) = match control {
            0..=127 => (usize::from(control) + 1, usize::from(control) + 1),
            128 => (0, 0),
            129..=255 => (257 - usize::from(control), 1),
        };
        let Some(after) = rest.get(packed..) else { break };
        unpacked += count;
        segment = after;
    }
    if unpacked < pixels { Err(CodecFault::Truncated) } else { Ok(()) }
}
