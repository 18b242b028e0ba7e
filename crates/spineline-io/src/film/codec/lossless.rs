//! Lossless JPEG with Huffman codes (ITU-T T.81, annex H; process 14 of DICOM), one component.
//!
//! Of our own: the decoder in the tree takes a third of a second for what this one does in a tenth, and this is how most
//! archives keep their films.

use super::super::error::CodecFault;
use super::super::pixels::{Coded, Format};
use super::huffman::{Bits, Table};
use super::markers::{self, LOSSLESS, Segment};

struct Scan {
    predictor: u8,
    /// Low bits that were dropped.
    point_transform: u8,
    /// Lines between restart markers; 0 for none.
    restart_lines: usize,
    table: Table,
}

pub(super) fn decode(data: &[u8], format: Format) -> Result<Coded, CodecFault> {
    let (segments, start) = markers::segments(data)?;
    let frame = markers::only_frame(&segments)?;
    if frame.kind != LOSSLESS {
        return Err(CodecFault::Unsupported);
    }
    frame.check(format, 1)?;
    let columns = usize::from(format.columns);
    let scan = scan(&segments, frame.bits, columns)?;
    let mut words = vec![0_u16; format.pixels()];
    let mut bits = Bits::new(data, start);
    let first = 1_u16 << (frame.bits - scan.point_transform - 1);
    let mut above: &[u16] = &[];
    for (row, line) in words.chunks_exact_mut(columns).enumerate() {
        if scan.restart_lines > 0 && row > 0 && row % scan.restart_lines == 0 {
            // At most 255 are counted modulo 8.
            bits.restart(((row / scan.restart_lines - 1) % 8) as u8)?;
            above = &[];
        }
        if above.is_empty() {
            first_line(line, first, &scan.table, &mut bits)?;
        } else {
            next_line(line, above, scan.predictor, &scan.table, &mut bits)?;
        }
        if bits.overdrawn() {
            return Err(CodecFault::Truncated);
        }
        above = line;
    }
    if scan.point_transform > 0 {
        words.iter_mut().for_each(|word| *word <<= scan.point_transform);
    }
    Ok(Coded::Words(words))
}

fn scan(segments: &[Segment<'_>], bits: u8, columns: usize) -> Result<Scan, CodecFault> {
    let mut tables: [Option<Table>; 4] = [const { None }; 4];
    let mut restart_interval = 0;
    for segment in segments {
        match segment.kind {
            0xC4 => {
                let mut rest = segment.body;
                while !rest.is_empty() {
                    let (number, table, next) = Table::read(rest)?;
                    let slot = tables.get_mut(usize::from(number)).ok_or(CodecFault::Header)?;
                    *slot = Some(table);
                    rest = next;
                }
            }
            0xDD => {
                let interval = segment.body.first_chunk::<2>().ok_or(CodecFault::Header)?;
                restart_interval = usize::from(u16::from_be_bytes(*interval));
            }
            _ => {}
        }
    }
    let Some(&[1, _, selectors, predictor @ 1..=7, 0, shifts]) = segments.last().map(|s| s.body)
    else {
        return Err(CodecFault::Unsupported);
    };
    let point_transform = shifts & 0x0F;
    if point_transform >= bits {
        return Err(CodecFault::Header);
    }
    // The standard wants whole lines between restarts (H.1.1).
    if restart_interval % columns != 0 {
        return Err(CodecFault::Unsupported);
    }
    let table = tables.get_mut(usize::from(selectors >> 4)).and_then(Option::take);
    Ok(Scan {
        predictor,
        point_transform,
        restart_lines: restart_interval / columns,
        table: table.ok_or(CodecFault::Header)?,
    })
}

/// A difference, modulo 2¹⁶.
#[inline]
fn difference(table: &Table, bits: &mut Bits<'_>) -> Result<u16, CodecFault> {
    bits.fill();
    let length = u32::from(table.next(bits)?);
    Ok(match length {
        0 => 0,
        16 => 32768,
        _ => {
            let value = bits.peek(length);
            bits.skip(length);
            // A leading zero means a negative difference.
            let negative = value >> (length - 1) == 0;
            let value = if negative { value.wrapping_sub((1 << length) - 1) } else { value };
            value as u16
        }
    })
}

fn first_line(
    line: &mut [u16],
    first: u16,
    table: &Table,
    bits: &mut Bits<'_>,
) -> Result<(), CodecFault> {
    let mut left = first;
    for word in line {
        left = left.wrapping_add(difference(table, bits)?);
        *word = left;
    }
    Ok(())
}

fn next_line(
    line: &mut [u16],
    above: &[u16],
    predictor: u8,
    table: &Table,
    bits: &mut Bits<'_>,
) -> Result<(), CodecFault> {
    type Predict = fn(i32, i32, i32) -> i32;
    // Left, above, and above left.
    let predict: Predict = match predictor {
        1 => return rest_of_line(line, above, table, bits, |a, _, _| a),
        2 => |_, b, _| b,
        3 => |_, _, c| c,
        4 => |a, b, c| a + b - c,
        5 => |a, b, c| a + ((b - c) >> 1),
        6 => |a, b, c| b + ((a - c) >> 1),
        _ => |a, b, _| (a + b) >> 1,
    };
    rest_of_line(line, above, table, bits, predict)
}

#[inline]
fn rest_of_line(
    line: &mut [u16],
    above: &[u16],
    table: &Table,
    bits: &mut Bits<'_>,
    predict: impl Fn(i32, i32, i32) -> i32,
) -> Result<(), CodecFault> {
    let mut above_left = above[0];
    let mut left = above_left.wrapping_add(difference(table, bits)?);
    line[0] = left;
    for (word, &above) in line.iter_mut().zip(above).skip(1) {
        let prediction = predict(i32::from(left), i32::from(above), i32::from(above_left));
        // Modulo 2¹⁶ is what the standard asks for.
        left = (prediction as u16).wrapping_add(difference(table, bits)?);
        *word = left;
        above_left = above;
    }
    Ok(())
}
