//! The pixels of a film alone: text can hide behind them, between them, and in unused bits.

use dicom_core::value::Value;

use super::stream;
use crate::codec::{self, Coded, Format};
use crate::container::{Packing, Syntax};
use crate::element::DataSet;
use crate::error::{Codec, FilmError};
use crate::pixels::{self, fit, top};
use crate::scan::PIXEL_DATA;
use crate::{FilmLimits, Photometric, rle};

/// The pixels of a data set without surplus bytes, and with cleared unused bits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Clean {
    /// Uncompressed, in the byte order of the data set.
    Native(Vec<u8>),
    /// One fragment.
    Packed(Vec<u8>),
}

/// See [`Clean`]; `None` without pixels.
///
/// # Errors
/// As reading; [`FilmError::HiddenBits`] where a codec holds values beyond the stored bits, since it cannot be written again.
pub(super) fn clean(
    data: &DataSet<'_>,
    syntax: &Syntax,
    photometric: Photometric,
    limits: &FilmLimits,
) -> Result<Option<Clean>, FilmError> {
    let format = pixels::format(&data.object, photometric, limits)?;
    if let Some(native) = data.native {
        return Ok(Some(Clean::Native(clean_native(native.bytes, format, syntax))));
    }
    let packed = data.object.get(PIXEL_DATA.into()).map(|element| element.value());
    let (Packing::Codec(codec), Some(Value::PixelSequence(sequence))) = (syntax.packing, packed)
    else {
        return Ok(None);
    };
    if codec == Codec::Rle {
        let coded = codec::decode(codec, syntax.uid, sequence.fragments(), format)?;
        return Ok(Some(Clean::Packed(clean_runs(coded, format))));
    }
    let stream = stream::cleaned(codec, sequence.fragments())?;
    let coded = codec::decode(codec, syntax.uid, &[&stream], format)?;
    match coded {
        Coded::Words(words) if !fit(&words, format) => {
            Err(FilmError::HiddenBits { bits_stored: format.stored })
        }
        _ => Ok(Some(Clean::Packed(stream))),
    }
}

fn clean_native(bytes: &[u8], format: Format, syntax: &Syntax) -> Vec<u8> {
    let samples = format.pixels() * usize::from(format.samples);
    let needed = samples * usize::from(format.allocated / 8);
    let mut clean = bytes[..needed.min(bytes.len())].to_vec();
    let [high, low] = mask(format).to_be_bytes();
    let masks = match (format.allocated, syntax.encoding.big_endian) {
        (16, true) => [high, low],
        (16, false) => [low, high],
        _ => [low, low],
    };
    clean.iter_mut().zip(masks.into_iter().cycle()).for_each(|(byte, mask)| *byte &= mask);
    clean
}

/// Run lengths written again.
fn clean_runs(coded: Coded, format: Format) -> Vec<u8> {
    let planes: Vec<Vec<u8>> = match coded {
        Coded::Words(mut words) => {
            let mask = mask(format);
            words.iter_mut().for_each(|word| *word &= mask);
            let [high, low] = rle::planes(&words);
            if format.allocated == 16 { vec![high, low] } else { vec![low] }
        }
        Coded::Colour(pixels) | Coded::Luminance(pixels) => {
            (0..3).map(|sample| pixels.iter().map(|pixel| pixel[sample]).collect()).collect()
        }
    };
    rle::encode(&planes, usize::from(format.columns))
}

/// The stored bits within an allocated word.
fn mask(format: Format) -> u16 {
    top(format.stored) << (format.high + 1 - format.stored)
}
