//! Run lengths (DICOM PS3.5, annex G): one segment per byte of a sample, the most significant first.

use super::super::error::CodecFault;
use super::super::pixels::{Coded, Format};

pub(super) fn decode(data: &[u8], format: Format) -> Result<Coded, CodecFault> {
    let bytes_per_sample = usize::from(format.allocated / 8);
    let wanted = bytes_per_sample * usize::from(format.samples);
    let header = data.first_chunk::<64>().ok_or(CodecFault::Truncated)?;
    let words = header.as_chunks::<4>().0;
    let offset = |index: usize| u32::from_le_bytes(words[index]) as usize;
    if offset(0) != wanted {
        return Err(CodecFault::Header);
    }
    let mut planes = Vec::with_capacity(wanted);
    for index in 1..=wanted {
        let start = offset(index);
        let end = if index == wanted { data.len() } else { offset(index + 1) };
        if start < 64 || start > end {
            return Err(CodecFault::Header);
        }
        let segment = data.get(start..end).ok_or(CodecFault::Truncated)?;
        planes.push(unpack(segment, format.pixels())?);
    }
    let shift = format.high + 1 - format.stored;
    let cut = |word: u16| (word >> shift) & (u16::MAX >> (16 - format.stored));
    match &planes[..] {
        [low] => Ok(Coded::Words(low.iter().map(|&byte| cut(u16::from(byte))).collect())),
        [high, low] => {
            let words = high.iter().zip(low).map(|(&high, &low)| u16::from_be_bytes([high, low]));
            Ok(Coded::Words(words.map(cut).collect()))
        }
        [a, b, c] => {
            let pixels = a.iter().zip(b).zip(c).map(|((&a, &b), &c)| [a, b, c]).collect();
            Ok(if format.luminance_first {
                Coded::Luminance(pixels)
            } else {
                Coded::Colour(pixels)
            })
        }
        _ => Err(CodecFault::Components { count: u16::from(format.samples) }),
    }
}

fn unpack(mut segment: &[u8], pixels: usize) -> Result<Vec<u8>, CodecFault> {
    let mut plane = Vec::with_capacity(pixels.min(segment.len().saturating_mul(64)));
    while plane.len() < pixels {
        let (&control, rest) = segment.split_first().ok_or(CodecFault::Truncated)?;
        segment = rest;
        match control {
            0..=127 => {
                let count = usize::from(control) + 1;
                let (literal, rest) =
                    segment.split_at_checked(count).ok_or(CodecFault::Truncated)?;
                plane.extend_from_slice(literal);
                segment = rest;
            }
            128 => {}
            129..=255 => {
                let (&byte, rest) = segment.split_first().ok_or(CodecFault::Truncated)?;
                plane.resize(plane.len() + 257 - usize::from(control), byte);
                segment = rest;
            }
        }
    }
    if plane.len() > pixels {
        return Err(CodecFault::Corrupt);
    }
    Ok(plane)
}
