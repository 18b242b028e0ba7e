//! Compressed pictures, decoded by the codecs of dicom-rs, and JPEG-LS by `jpegls`. Both trust the header of a picture, so it
//! is read here first and compared with the data set. Pictures that a codec is known to decode wrongly are refused, and a panic
//! of a codec is an error.

mod format;
mod markers;
mod runs;
mod wavelets;

pub(super) use format::{Coded, Format};
pub(super) use markers::{END, check_end, header_segment, is_one_scan};

use std::borrow::Cow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use dicom_encoding::Codec as Packing;
use dicom_encoding::adapters::{PixelDataObject, RawPixelData};
use dicom_transfer_syntax_registry::{TransferSyntaxIndex, TransferSyntaxRegistry};

use super::error::{Codec, CodecFault, FilmError};

/// Undoes the compression of one frame, whose fragments are `fragments`.
pub(super) fn decode<B: AsRef<[u8]>>(
    codec: Codec,
    transfer_syntax: &str,
    fragments: &[B],
    format: Format,
) -> Result<Coded, FilmError> {
    let data: Cow<'_, [u8]> = match fragments {
        [] => return Err(FilmError::Codec { codec, fault: CodecFault::Truncated }),
        [one] => Cow::Borrowed(one.as_ref()),
        many => Cow::Owned(many.iter().flat_map(|part| part.as_ref()).copied().collect()),
    };
    let coded = match codec {
        Codec::Rle => runs::check(&data, format).map(|()| format.allocated),
        Codec::JpegLossless => markers::check_lossless(&data, format),
        Codec::Jpeg => markers::check_lossy(&data, format),
        Codec::JpegLs => return jpeg_ls(&data, format).map_err(|fault| fault.of(codec)),
        Codec::Jpeg2000 => wavelets::check(&data, format).map(|()| format.allocated),
        Codec::Deflate | Codec::Raster => Err(CodecFault::Unsupported),
    };
    let frame = coded.map(|bits| Frame { transfer_syntax, data: &data, format, bits });
    frame.and_then(|frame| frame.decode(codec)).map_err(|fault| fault.of(codec))
}

/// Allocates this much and frees it. Without the memory the process ends as for every other allocation: external
/// readers report a lack of memory as damaged data.
pub(super) fn ensure_memory(bytes: usize) {
    std::hint::black_box(Vec::<u8>::with_capacity(bytes));
}

/// Calls an external decoder; its error or panic is returned without its text.
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

/// A picture with a checked header, as the codecs of dicom-rs need it.
struct Frame<'a> {
    transfer_syntax: &'a str,
    data: &'a [u8],
    format: Format,
    /// Bits of a sample that the codec gives back: 8 or 16, whatever the data set allocates.
    bits: u8,
}

impl Frame<'_> {
    fn decode(&self, codec: Codec) -> Result<Coded, CodecFault> {
        let syntax = TransferSyntaxRegistry.get(self.transfer_syntax);
        let Some(Packing::EncapsulatedPixelData(Some(reader), _)) = syntax.map(|ts| ts.codec())
        else {
            return Err(CodecFault::Unsupported);
        };
        let samples = self.format.pixels() * usize::from(self.format.samples);
        let mut bytes = Vec::with_capacity(samples * usize::from(self.bits / 8));
        // Buffer into which the codecs unpack before they sort it.
        ensure_memory(bytes.capacity());
        foreign(|| reader.decode_frame(self, 0, &mut bytes))?;
        Ok(match (self.format.samples, self.bits) {
            (3, 8) if codec == Codec::Rle && self.format.luminance_first => {
                Coded::Luminance(bytes.as_chunks::<3>().0.to_vec())
            }
            (3, 8) => Coded::Colour(bytes.as_chunks::<3>().0.to_vec()),
            (1, 8) => Coded::Words(bytes.into_iter().map(u16::from).collect()),
            (1, 16) => {
                let pairs = bytes.as_chunks::<2>().0;
                Coded::Words(pairs.iter().map(|&pair| u16::from_le_bytes(pair)).collect())
            }
            (samples, _) => return Err(CodecFault::Components { count: u16::from(samples) }),
        })
    }
}

impl PixelDataObject for Frame<'_> {
    fn transfer_syntax_uid(&self) -> &str {
        self.transfer_syntax
    }

    fn rows(&self) -> Option<u16> {
        Some(self.format.rows)
    }

    fn cols(&self) -> Option<u16> {
        Some(self.format.columns)
    }

    fn samples_per_pixel(&self) -> Option<u16> {
        Some(u16::from(self.format.samples))
    }

    fn bits_allocated(&self) -> Option<u16> {
        Some(u16::from(self.bits))
    }

    fn bits_stored(&self) -> Option<u16> {
        Some(u16::from(self.format.stored))
    }

    fn photometric_interpretation(&self) -> Option<&str> {
        None
    }

    fn number_of_frames(&self) -> Option<u32> {
        Some(1)
    }

    fn number_of_fragments(&self) -> Option<u32> {
        Some(1)
    }

    fn fragment(&self, fragment: usize) -> Option<Cow<'_, [u8]>> {
        (fragment == 0).then_some(Cow::Borrowed(self.data))
    }

    fn offset_table(&self) -> Option<Cow<'_, [u32]>> {
        None
    }

    fn raw_pixel_data(&self) -> Option<RawPixelData> {
        let fragments = std::iter::once(self.data.to_vec()).collect();
        Some(RawPixelData { fragments, offset_table: std::iter::empty().collect() })
    }
}
