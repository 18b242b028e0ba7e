//! Pixels of a DICOM data set, exact.

use dicom_core::value::Value;
use dicom_core::{Tag, VR};
use dicom_dictionary_std::tags;
use dicom_object::InMemDicomObject;

use super::codec::{self, Coded, Format};
use super::container::{Packing, Syntax};
use super::element::{Attributes, DataSet};
use super::error::{FilmError, Measure, UnsupportedPhotometric};
use super::scan::PIXEL_DATA;
use super::{Codec, CodecFault, FilmLimits, FilmRemark, Photometric, StoredPixels};

pub(super) struct Picture {
    pub columns: u32,
    pub rows: u32,
    pub bits_stored: u8,
    pub stored: StoredPixels,
}

pub(super) fn read(
    data: &DataSet<'_>,
    syntax: &Syntax,
    photometric: Photometric,
    limits: &FilmLimits,
    remarks: &mut Vec<FilmRemark>,
) -> Result<Picture, FilmError> {
    let format = format(&data.object, photometric, limits)?;
    let packed = data.object.get(PIXEL_DATA.into()).map(|element| element.value());
    let words = match (syntax.packing, data.native, packed) {
        (Packing::Native, Some(pixels), _) => {
            let big_endian = syntax.encoding.big_endian;
            let swapped = big_endian && pixels.vr == VR::OW;
            native(pixels.bytes, format, big_endian, swapped, remarks)?
        }
        (Packing::Codec(codec), None, Some(Value::PixelSequence(sequence))) => {
            let coded = codec::decode(codec, syntax.uid, sequence.fragments(), format)?;
            coded.into_words(codec, format, remarks)?
        }
        _ => return Err(FilmError::NoPixels { missing: PIXEL_DATA }),
    };
    let bits_stored = format.stored;
    let fits = fit(&words, format);
    if !fits {
        remarks.push(FilmRemark::BeyondBitsStored { bits_stored });
    }
    let stored = if format.signed {
        // Two's complement of this number of bits; of all 16 if a value does not fit.
        let shift = if fits { 16 - u32::from(bits_stored) } else { 0 };
        let extended = |word: u16| (word << shift).cast_signed() >> shift;
        StoredPixels::Signed(words.into_iter().map(extended).collect())
    } else {
        StoredPixels::Unsigned(words)
    };
    let (columns, rows) = (u32::from(format.columns), u32::from(format.rows));
    Ok(Picture { columns, rows, bits_stored, stored })
}

/// The largest unsigned value of this number of bits.
pub(super) const fn top(bits: u8) -> u16 {
    u16::MAX >> (16 - bits)
}

/// Whether all words use only their stored bits, with the sign extended.
pub(super) fn fit(words: &[u16], format: Format) -> bool {
    let top = top(format.stored);
    let beyond = !top | (top & !(top >> 1));
    words.iter().all(|&word| word <= top || format.signed && word & beyond == beyond)
}

/// The values of the image pixel module, checked.
pub(super) fn format(
    data: &InMemDicomObject,
    photometric: Photometric,
    limits: &FilmLimits,
) -> Result<Format, FilmError> {
    let needed = |tag: Tag| data.word(tag)?.ok_or(FilmError::NoPixels { missing: tag.into() });
    let wrong = |tag: Tag, value: u16| FilmError::PixelFormat {
        attribute: tag.into(),
        value: u32::from(value),
    };
    let (rows, columns) = (needed(tags::ROWS)?, needed(tags::COLUMNS)?);
    for (tag, value) in [(tags::ROWS, rows), (tags::COLUMNS, columns)] {
        if value == 0 {
            return Err(wrong(tag, value));
        }
    }
    Measure::Pixels.within(u64::from(rows) * u64::from(columns), limits.pixels)?;
    let samples = data.word(tags::SAMPLES_PER_PIXEL)?.unwrap_or(1);
    let colour = photometric == Photometric::Colour;
    if samples != if colour { 3 } else { 1 } {
        return Err(wrong(tags::SAMPLES_PER_PIXEL, samples));
    }
    let allocated = needed(tags::BITS_ALLOCATED)?;
    if colour && allocated > 8 {
        let photometric = UnsupportedPhotometric::Deep;
        return Err(FilmError::Photometric { photometric });
    }
    if !matches!(allocated, 8 | 16) {
        return Err(wrong(tags::BITS_ALLOCATED, allocated));
    }
    let stored = needed(tags::BITS_STORED)?;
    if stored == 0 || stored > allocated || colour && stored != 8 {
        return Err(wrong(tags::BITS_STORED, stored));
    }
    let high = data.word(tags::HIGH_BIT)?.unwrap_or(stored - 1);
    if high >= allocated || high + 1 < stored {
        return Err(wrong(tags::HIGH_BIT, high));
    }
    let signed = match data.word(tags::PIXEL_REPRESENTATION)?.unwrap_or(0) {
        0 => false,
        1 if !colour => true,
        other => return Err(wrong(tags::PIXEL_REPRESENTATION, other)),
    };
    let planar = colour && data.word(tags::PLANAR_CONFIGURATION)?.unwrap_or(0) == 1;
    // All of these are at most 16 now.
    let [samples, allocated, stored, high] = [samples, allocated, stored, high].map(|v| v as u8);
    let luminance_first =
        colour && data.text(tags::PHOTOMETRIC_INTERPRETATION).is_some_and(|p| p.starts_with("YBR"));
    Ok(Format { columns, rows, samples, planar, luminance_first, allocated, stored, high, signed })
}

/// Uncompressed samples: cut to their bits, or, in colour, to their luminance.
fn native(
    bytes: &[u8],
    format: Format,
    big_endian: bool,
    swapped: bool,
    remarks: &mut Vec<FilmRemark>,
) -> Result<Vec<u16>, FilmError> {
    let samples = format.pixels() * usize::from(format.samples);
    let needed = samples * usize::from(format.allocated / 8);
    if bytes.len() < needed {
        let found = bytes.len() as u64;
        return Err(FilmError::PixelsMissing { needed: needed as u64, found });
    }
    // The standard pads an odd length with one byte.
    let surplus = bytes.len() - needed;
    if surplus > needed % 2 {
        remarks.push(FilmRemark::PixelsLeftOver { bytes: surplus as u64 });
    }
    let (whole, bytes) = (bytes, &bytes[..needed]);
    if format.samples == 3 {
        let bytes = if swapped { swap(bytes) } else { bytes.to_vec() };
        let pixels = by_pixel(&bytes, format.pixels(), format.planar);
        return Ok(if format.luminance_first {
            first_samples(&pixels, remarks)
        } else {
            luminance(&pixels, remarks)
        });
    }
    if format.allocated == 8 {
        let bytes = if swapped { swap(whole) } else { bytes.to_vec() };
        return Ok(cut(bytes[..needed].iter().map(|&byte| u16::from(byte)).collect(), format));
    }
    let pairs = bytes.as_chunks::<2>().0;
    let words = if big_endian {
        pairs.iter().map(|&pair| u16::from_be_bytes(pair)).collect()
    } else {
        pairs.iter().map(|&pair| u16::from_le_bytes(pair)).collect()
    };
    Ok(cut(words, format))
}

/// The stored bits of words.
fn cut(mut words: Vec<u16>, format: Format) -> Vec<u16> {
    let shift = format.high + 1 - format.stored;
    words.iter_mut().for_each(|word| *word = (*word >> shift) & top(format.stored));
    words
}

/// Bytes of big-endian words in the order of pixels.
fn swap(bytes: &[u8]) -> Vec<u8> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let swapped = pairs.iter().flat_map(|&[a, b]| [b, a]);
    swapped.chain(rest.iter().copied()).collect()
}

/// Samples of colour, pixel by pixel.
fn by_pixel(bytes: &[u8], pixels: usize, planar: bool) -> Vec<[u8; 3]> {
    if planar {
        (0..pixels).map(|i| [bytes[i], bytes[pixels + i], bytes[2 * pixels + i]]).collect()
    } else {
        bytes.as_chunks::<3>().0.to_vec()
    }
}

/// Luminance of pixels that carry it first, and two colour differences around 128.
fn first_samples(pixels: &[[u8; 3]], remarks: &mut Vec<FilmRemark>) -> Vec<u16> {
    let difference = |&[_, b, r]: &[u8; 3]| b.abs_diff(128).max(r.abs_diff(128)).saturating_mul(2);
    let largest_difference = pixels.iter().map(difference).max().unwrap_or(0);
    remarks.push(FilmRemark::Colour { largest_difference });
    pixels.iter().map(|&[luminance, ..]| u16::from(luminance)).collect()
}

/// Luminance of red, green and blue as ITU-R BT.601 weighs them.
pub(super) fn luminance(pixels: &[[u8; 3]], remarks: &mut Vec<FilmRemark>) -> Vec<u16> {
    let difference = |[r, g, b]: &[u8; 3]| r.max(g).max(b) - r.min(g).min(b);
    let largest_difference = pixels.iter().map(difference).max().unwrap_or(0);
    remarks.push(FilmRemark::Colour { largest_difference });
    let weigh = |&[r, g, b]: &[u8; 3]| {
        let sum = 299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b);
        // At most 255.
        ((sum + 500) / 1000) as u16
    };
    pixels.iter().map(weigh).collect()
}

impl Coded {
    fn into_words(
        self,
        codec: Codec,
        format: Format,
        remarks: &mut Vec<FilmRemark>,
    ) -> Result<Vec<u16>, FilmError> {
        match self {
            Self::Words(words) if words.len() == format.pixels() && format.samples == 1 => {
                // Run lengths keep all bits of a word; the other codecs return only the bits of the sample.
                Ok(if codec == Codec::Rle { cut(words, format) } else { words })
            }
            Self::Colour(pixels) if pixels.len() == format.pixels() && format.samples == 3 => {
                Ok(luminance(&pixels, remarks))
            }
            Self::Luminance(pixels) if pixels.len() == format.pixels() && format.samples == 3 => {
                Ok(first_samples(&pixels, remarks))
            }
            Self::Colour(_) if format.samples == 1 => {
                let photometric = UnsupportedPhotometric::Compressed;
                Err(FilmError::Photometric { photometric })
            }
            _ => Err(FilmError::Codec { codec, fault: CodecFault::Corrupt }),
        }
    }
}

/// 16-bit words as bytes.
pub(super) fn little_endian(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}
