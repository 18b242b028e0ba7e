//! Pictures without a data set: PNG, JPEG and TIFF. They have no spacing and no view, so the program asks for both. The
//! shape of their pixels follows from their resolutions.

use std::convert::Infallible;
use std::io::{Cursor, ErrorKind};

use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use spineline_marking::SpacingEvidence;

use super::codec::{END, check_end, foreign, is_one_scan};
use super::error::{Codec, CodecFault, FilmError, Measure, UnsupportedPhotometric};
use super::pixels::luminance;
use super::resolution;
use super::{
    FilmFile, FilmKind, FilmLimits, FilmRemark, FilmTags, Look, Photometric, StoredPixels,
};

pub(super) fn read(
    bytes: &[u8],
    kind: FilmKind,
    limits: &FilmLimits,
) -> Result<FilmFile, FilmError> {
    let mut remarks = vec![FilmRemark::NoModality, FilmRemark::BurnedInUnknown];
    let stated = resolution::stated(bytes, kind);
    if stated.pictures > 1 {
        return Err(FilmError::Frames { frames: stated.pictures });
    }
    let (image, orientation) = if kind == FilmKind::Jpeg && check_end(bytes).is_err() {
        remarks.push(FilmRemark::EndMissing);
        decode_without_end(bytes, limits)?
    } else {
        decode(bytes, kind, limits)?
    };
    let resolution =
        stated.resolution.map(|one| if is_turned(orientation) { one.turned() } else { one });
    if orientation != Orientation::NoTransforms {
        remarks.push(FilmRemark::CameraOrientation);
    }
    let unequal = resolution.filter(|one| !one.is_square());
    remarks.extend(match resolution {
        Some(one) if !one.is_square() => Some(FilmRemark::UnequalResolution(one)),
        Some(one) if one.is_meant() => Some(FilmRemark::ResolutionNotUsed(one)),
        _ => None,
    });
    let (columns, rows) = (image.width(), image.height());
    if image.color().has_alpha() {
        remarks.push(FilmRemark::Transparency);
    }
    let (photometric, bits_stored, words) = grey(image, &mut remarks)?;
    let tags = FilmTags {
        spacing: SpacingEvidence {
            pixel_aspect: unequal.map(|one| one.pixel_aspect()),
            ..SpacingEvidence::default()
        },
        photometric,
        is_phantom: stated.is_phantom,
        bits_stored,
        ..FilmTags::default()
    };
    let stored = StoredPixels::Unsigned(words);
    // Other programs show all of 8 bits. Values in 16 bits may use only a part, and are shown from the smallest to the largest.
    let full = f64::from(u8::MAX);
    let window = super::Window {
        center: full / 2.0,
        width: full,
        function: super::WindowFunction::LinearExact,
    };
    let voi = (bits_stored == 8).then_some(super::Voi::Window(window));
    let look = Look { voi: voi.into_iter().collect(), ..Look::plain() };
    Ok(FilmFile { kind, columns, rows, stored, tags, look, remarks })
}

/// The grey values of an image, with their kind and number of bits.
fn grey(
    image: DynamicImage,
    remarks: &mut Vec<FilmRemark>,
) -> Result<(Photometric, u8, Vec<u16>), FilmError> {
    Ok(match image {
        DynamicImage::ImageLuma8(_) | DynamicImage::ImageLumaA8(_) => {
            let words = image.into_luma8().into_raw().into_iter().map(u16::from).collect();
            (Photometric::Monochrome2, 8, words)
        }
        DynamicImage::ImageLuma16(_) | DynamicImage::ImageLumaA16(_) => {
            (Photometric::Monochrome2, 16, image.into_luma16().into_raw())
        }
        DynamicImage::ImageRgb8(_) | DynamicImage::ImageRgba8(_) => {
            let bytes = image.into_rgb8().into_raw();
            (Photometric::Colour, 8, luminance(bytes.as_chunks::<3>().0, remarks))
        }
        // Floating point and colour of 16 bits.
        _ => return Err(FilmError::Photometric { photometric: UnsupportedPhotometric::Deep }),
    })
}

fn decode(
    bytes: &[u8],
    kind: FilmKind,
    limits: &FilmLimits,
) -> Result<(DynamicImage, Orientation), FilmError> {
    let format = match kind {
        FilmKind::Jpeg => ImageFormat::Jpeg,
        FilmKind::Tiff => ImageFormat::Tiff,
        FilmKind::Png | FilmKind::Dicom => ImageFormat::Png,
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut caps = Limits::default();
    // Two copies of four samples of 16 bits.
    caps.max_alloc = Some(limits.pixels.saturating_mul(16));
    reader.limits(caps);
    let mut decoder = decoded(|| reader.into_decoder())?;
    let (columns, rows) = decoder.dimensions();
    let found = u64::from(columns) * u64::from(rows);
    Measure::Pixels.within(found, limits.pixels)?;
    if found == 0 {
        return Err(CodecFault::Header.of(Codec::Raster));
    }
    let orientation = foreign(|| decoder.orientation()).unwrap_or(Orientation::NoTransforms);
    let mut image = decoded(|| DynamicImage::from_decoder(decoder))?;
    image.apply_orientation(orientation);
    Ok((image, orientation))
}

/// Decodes a JPEG without its end. The decoder invents missing rows from the bytes that follow, so other bytes then change the picture.
fn decode_without_end(
    bytes: &[u8],
    limits: &FilmLimits,
) -> Result<(DynamicImage, Orientation), FilmError> {
    let truncated = || CodecFault::Truncated.of(Codec::Raster);
    if !is_one_scan(bytes) {
        return Err(truncated());
    }
    // The first half of the end.
    let scan = bytes.strip_suffix(&[0xFF]).unwrap_or(bytes);
    let with = |more: &[u8]| decode(&[scan, more, END.as_slice()].concat(), FilmKind::Jpeg, limits);
    let other_bits: Vec<u8> = (1..0xFF).rev().collect();
    let found = with(&[])?;
    match with(&other_bits) {
        Ok(other) if other.0 == found.0 => Ok(found),
        _ => Err(truncated()),
    }
}

/// Calls the decoder of pictures.
fn decoded<T>(decode: impl FnOnce() -> Result<T, ImageError>) -> Result<T, FilmError> {
    let found = foreign(|| Ok::<_, Infallible>(decode()));
    let fault = |error: ImageError| match error {
        ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            CodecFault::Truncated
        }
        ImageError::Unsupported(_) => CodecFault::Unsupported,
        _ => CodecFault::Corrupt,
    };
    found.and_then(|found| found.map_err(fault)).map_err(|fault| fault.of(Codec::Raster))
}

/// Whether rows become columns.
const fn is_turned(orientation: Orientation) -> bool {
    matches!(
        orientation,
        Orientation::Rotate90
            | Orientation::Rotate270
            | Orientation::Rotate90FlipH
            | Orientation::Rotate270FlipH
    )
}
