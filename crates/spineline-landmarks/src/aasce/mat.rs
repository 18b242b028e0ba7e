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
    Err(LandmarkError::missing("the file", "the variable `p2`"))
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
    let flags = word(flags, 0, little).unwrap_or_default();
    let (class, complex) = (flags & 0xff, flags & 0x800 != 0);
    if !(6..=15).contains(&class) || complex {
        return Err(wrong("`p2` is not a real numeric matrix"));
    }
    let [rows, columns] = [0, 1].map(|place| word(dimensions, place, little));
    let size = (rows, columns, dimensions.len());
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
    Some(match kind {
        1 => f64::from(i8::from_le_bytes(bytes_at(bytes, place, little)?)),
        2 => f64::from(u8::from_le_bytes(bytes_at(bytes, place, little)?)),
        3 => f64::from(i16::from_le_bytes(bytes_at(bytes, place, little)?)),
        4 => f64::from(u16::from_le_bytes(bytes_at(bytes, place, little)?)),
        5 => f64::from(i32::from_le_bytes(bytes_at(bytes, place, little)?)),
        6 => f64::from(u32::from_le_bytes(bytes_at(bytes, place, little)?)),
        7 => f64::from(f32::from_le_bytes(bytes_at(bytes, place, little)?)),
        9 => f64::from_le_bytes(bytes_at(bytes, place, little)?),
        12 => i64::from_le_bytes(bytes_at(bytes, place, little)?) as f64,
        13 => u64::from_le_bytes(bytes_at(bytes, place, little)?) as f64,
        _ => return None,
    })
}

/// The bytes of a number in a row of numbers of this size, the lowest one first.
fn bytes_at<const N: usize>(bytes: &[u8], place: usize, little: bool) -> Option<[u8; N]> {
    let mut own: [u8; N] = bytes.get(N * place..N * (place + 1))?.try_into().ok()?;
    if !little {
        own.reverse();
    }
    Some(own)
}

fn word(bytes: &[u8], place: usize, little: bool) -> Option<u32> {
    bytes_at(bytes, place, little).map(u32::from_le_bytes)
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
        let [first, second] = [0, 1].map(|place| word(tag, place, self.little).unwrap_or_default());
        let (kind, data, rest) = if first >> 16 != 0 {
            // A small element has its length and its data inside of the tag.
            let length = (first >> 16) as usize;
            let data = tag[4..].get(..length).ok_or_else(|| wrong("an element is cut off"))?;
            (first & 0xffff, data, rest)
        } else {
            let length = second as usize;
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

fn wrong(reason: &str) -> LandmarkError {
    LandmarkError::Syntax { at: "the MATLAB file".to_owned(), reason: reason.to_owned() }
}
