//! Variables of MATLAB files, version 5, limited to real numeric matrices.
//!
//! # References
//! The MathWorks, MAT-File Format.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::{CORNERS, film_of, patient_left};
use crate::{LandmarkError, LandmarkFile, LandmarkFormat, LandmarkHint};

/// Real files have 0.4 kB, with 272 bytes of coordinates.
const MAX_BYTES: usize = 1 << 20;
const HEADER: usize = 128;
/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// The variable with the corners.
const VARIABLE: &[u8] = b"p2";

/// Reads the corners of one film from the bytes of a MATLAB file.
///
/// # Errors
/// [`LandmarkError::Needs`] without the side of the patient's left; [`LandmarkError`] for anything other than a real
/// matrix `p2` of 68 × 2 numbers.
pub fn parse_mat(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    if bytes.len() > MAX_BYTES {
        let (found, limit) = (bytes.len() as u64, MAX_BYTES as u64);
        return Err(LandmarkError::TooLarge { what: "bytes of a MATLAB file", found, limit });
    }
    let side = patient_left(hint)?;
    let points = points(bytes)?;
    let film = film_of(&points, hint, side, "p2")?;
    Ok(LandmarkFile { format: LandmarkFormat::AasceMat, films: vec![film], remarks: Vec::new() })
}

fn points(bytes: &[u8]) -> Result<[[f64; 2]; CORNERS], LandmarkError> {
    let (version, rest) = (bytes.get(124..HEADER), bytes.get(HEADER..).unwrap_or_default());
    let little = match version {
        Some([_, 1, b'I', b'M']) => true,
        Some([1, _, b'M', b'I']) => false,
        _ => return Err(wrong("it lacks the header of a MATLAB file of version 5")),
    };
    let mut elements = Elements { rest, little };
    while let Some((kind, data)) = elements.next()? {
        if kind == COMPRESSED {
            let mut inside = Vec::new();
            let limit = MAX_BYTES as u64;
            let read = ZlibDecoder::new(data).take(limit + 1).read_to_end(&mut inside);
            read.map_err(|_| wrong("a compressed variable cannot be decompressed"))?;
            if inside.len() > MAX_BYTES {
                let found = inside.len() as u64;
                return Err(LandmarkError::TooLarge { what: "bytes of a variable", found, limit });
            }
            // A compressed element holds one matrix, and never another compressed element.
            let mut inside = Elements { rest: &inside, little };
            if let Some((MATRIX, data)) = inside.next()?
                && let Some(found) = matrix(data, little)?
            {
                return Ok(found);
            }
        } else if kind == MATRIX
            && let Some(found) = matrix(data, little)?
        {
            return Ok(found);
        }
    }
    Err(LandmarkError::Missing { at: "the file".to_owned(), what: "the variable `p2`".to_owned() })
}

/// The corners, if the matrix is `p2`.
fn matrix(data: &[u8], little: bool) -> Result<Option<[[f64; 2]; CORNERS]>, LandmarkError> {
    let mut parts = Elements { rest: data, little };
    let mut part = || parts.next().map(|part| part.unwrap_or((0, &[])));
    let (_, flags) = part()?;
    let (_, dimensions) = part()?;
    let (_, name) = part()?;
    if name != VARIABLE {
        return Ok(None);
    }
    let word =
        |bytes: &[u8], place: usize| Some(number32(bytes.get(4 * place..4 * place + 4)?, little));
    let flags = word(flags, 0).unwrap_or_default();
    let (class, complex) = (flags & 0xff, flags & 0x800 != 0);
    if !(6..=15).contains(&class) || complex {
        return Err(wrong("`p2` is not a real numeric matrix"));
    }
    let size = (word(dimensions, 0), word(dimensions, 1), dimensions.len());
    if size != (Some(CORNERS as u32), Some(2), 8) {
        return Err(wrong("`p2` must have 68 rows and 2 columns"));
    }
    let (kind, values) = part()?;
    let mut points = [[0.0; 2]; CORNERS];
    // Columns first, as in MATLAB.
    for (place, point) in points.iter_mut().enumerate() {
        for (column, value) in point.iter_mut().enumerate() {
            *value = value_at(values, kind, CORNERS * column + place, little)
                .ok_or_else(|| wrong("`p2` has fewer values than it declares"))?;
        }
    }
    Ok(Some(points))
}

/// A number of an element's type.
fn value_at(bytes: &[u8], kind: u32, place: usize, little: bool) -> Option<f64> {
    let size = match kind {
        1 | 2 => 1,
        3 | 4 => 2,
        5..=7 => 4,
        9 | 12 | 13 => 8,
        _ => return None,
    };
    let mut all = [0; 8];
    let own = bytes.get(size * place..size * (place + 1))?;
    all[..size].copy_from_slice(own);
    if !little {
        all[..size].reverse();
    }
    let [a, b, c, d, ..] = all;
    Some(match kind {
        1 => f64::from(a as i8),
        2 => f64::from(a),
        3 => f64::from(i16::from_le_bytes([a, b])),
        4 => f64::from(u16::from_le_bytes([a, b])),
        5 => f64::from(i32::from_le_bytes([a, b, c, d])),
        6 => f64::from(u32::from_le_bytes([a, b, c, d])),
        7 => f64::from(f32::from_le_bytes([a, b, c, d])),
        9 => f64::from_le_bytes(all),
        12 => i64::from_le_bytes(all) as f64,
        _ => u64::from_le_bytes(all) as f64,
    })
}

/// The data elements in a part of a file, in their order.
struct Elements<'a> {
    rest: &'a [u8],
    little: bool,
}

impl<'a> Elements<'a> {
    /// The next type and its data; `None` at the end.
    fn next(&mut self) -> Result<Option<(u32, &'a [u8])>, LandmarkError> {
        let Some((tag, rest)) = self.rest.split_at_checked(8) else {
            // Fewer bytes than a tag are padding.
            self.rest = &[];
            return Ok(None);
        };
        let first = number32(&tag[..4], self.little);
        let (kind, data, rest) = if first >> 16 != 0 {
            // A small element has its length and its data inside of the tag.
            let length = (first >> 16) as usize;
            let data = tag[4..].get(..length).ok_or_else(|| wrong("an element is cut off"))?;
            (first & 0xffff, data, rest)
        } else {
            let length = number32(&tag[4..], self.little) as usize;
            let (data, rest) =
                rest.split_at_checked(length).ok_or_else(|| wrong("an element is cut off"))?;
            // Compressed elements are not padded; others end on a multiple of 8.
            let padding = if first == COMPRESSED { 0 } else { length.wrapping_neg() % 8 };
            (first, data, rest.get(padding..).unwrap_or_default())
        };
        self.rest = rest;
        Ok(Some((kind, data)))
    }
}

fn number32(bytes: &[u8], little: bool) -> u32 {
    let four = [0, 1, 2, 3].map(|i| bytes.get(i).copied().unwrap_or_default());
    if little { u32::from_le_bytes(four) } else { u32::from_be_bytes(four) }
}

fn wrong(reason: &str) -> LandmarkError {
    LandmarkError::Syntax { at: "the MATLAB file".to_owned(), reason: reason.to_owned() }
}
