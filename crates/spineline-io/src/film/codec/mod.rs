//! Compressed pictures. Their headers are read by hand and compared with the data set before a decoder, own or foreign,
//! sees them; a foreign decoder that panics ends in an error.

mod huffman;
mod jpeg;
mod jpeg2000;
mod lossless;
mod markers;
mod rle;

use std::borrow::Cow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::error::{Codec, CodecFault, FilmError};
use super::pixels::{Coded, Format};

/// Undoes the compression of one frame.
pub(super) fn decode(
    codec: Codec,
    fragments: &[&[u8]],
    format: Format,
) -> Result<Coded, FilmError> {
    let data: Cow<'_, [u8]> = match fragments {
        [] => return Err(FilmError::Codec { codec, fault: CodecFault::Truncated }),
        [one] => Cow::Borrowed(one),
        many => Cow::Owned(many.concat()),
    };
    let coded = match codec {
        Codec::Rle => rle::decode(&data, format),
        Codec::JpegLossless => lossless::decode(&data, format),
        Codec::Jpeg => jpeg::decode(&data, format),
        Codec::JpegLs => jpeg_ls(&data, format),
        Codec::Jpeg2000 => jpeg2000::decode(&data, format),
        Codec::Deflate | Codec::Raster => Err(CodecFault::Unsupported),
    };
    coded.map_err(|fault| FilmError::Codec { codec, fault })
}

/// Calls a foreign decoder; its error, or its panic, becomes a fault without its words.
pub(super) fn foreign<T, E>(decode: impl FnOnce() -> Result<T, E>) -> Result<T, CodecFault> {
    match catch_unwind(AssertUnwindSafe(decode)) {
        Ok(Ok(decoded)) => Ok(decoded),
        Ok(Err(_)) => Err(CodecFault::Corrupt),
        Err(_) => Err(CodecFault::Panicked),
    }
}

fn jpeg_ls(data: &[u8], format: Format) -> Result<Coded, CodecFault> {
    let frame = markers::frame(data)?;
    if frame.kind != markers::JPEG_LS {
        return Err(CodecFault::Header);
    }
    frame.check(format, 1)?;
    let (columns, rows) = (u32::from(format.columns), u32::from(format.rows));
    let (words, _, _) = foreign(|| jpegls::decode(data, columns, rows))?;
    Ok(Coded::Words(words))
}
