//! JPEG with losses, of 8 bits; 12 bits have no decoder here.

use jpeg_decoder::{Decoder, PixelFormat};

use super::super::error::CodecFault;
use super::super::pixels::{Coded, Format, by_pixel};
use super::{foreign, markers};

pub(super) fn decode(data: &[u8], format: Format) -> Result<Coded, CodecFault> {
    let frame = markers::frame(data)?;
    if !matches!(frame.kind, 0xC0..=0xC2) {
        return Err(CodecFault::Unsupported);
    }
    frame.check(format, format.samples)?;
    if frame.bits != 8 {
        return Err(CodecFault::Precision { bits: frame.bits });
    }
    let mut decoder = Decoder::new(data);
    decoder.set_max_decoding_buffer_size(format.pixels() * usize::from(format.samples));
    let bytes = foreign(|| decoder.decode())?;
    match decoder.info().map(|info| info.pixel_format) {
        Some(PixelFormat::L8) => Ok(Coded::Words(bytes.into_iter().map(u16::from).collect())),
        Some(PixelFormat::RGB24) => Ok(Coded::Colour(by_pixel(&bytes, format.pixels(), false))),
        _ => Err(CodecFault::Components { count: u16::from(frame.components) }),
    }
}
