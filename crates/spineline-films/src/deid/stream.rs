//! Removes comments and application segments, which may contain names, from compressed pictures.

use crate::codec::{END, header_segment};
use crate::error::{Codec, CodecFault, FilmError};

/// The one compressed picture of a film, with joined fragments, without comments, segments of applications, and
/// bytes after its end.
///
/// # Errors
/// [`FilmError::Codec`] for inconsistent headers: a picture that cannot be parsed cannot be cleaned. Boxes of a JP2
/// file, which DICOM does not allow around the picture, are such a case.
pub(super) fn cleaned(codec: Codec, fragments: &[Vec<u8>]) -> Result<Vec<u8>, FilmError> {
    let joined = fragments.concat();
    let clean = match (codec, joined.get(..4)) {
        (Codec::Jpeg2000, Some([0xFF, 0x4F, 0xFF, 0x51])) => clean_jpeg_2000(&joined),
        (Codec::Jpeg | Codec::JpegLossless | Codec::JpegLs, Some([0xFF, 0xD8, 0xFF, _])) => {
            clean_jpeg(&joined)
        }
        _ => Err(CodecFault::Header),
    };
    clean.map_err(|fault| fault.of(codec))
}

/// JPEG and JPEG-LS: marker segments up to the first scan, then the scans up to the end of the image.
fn clean_jpeg(data: &[u8]) -> Result<Vec<u8>, CodecFault> {
    const COMMENT: u8 = 0xFE;
    const SCAN: u8 = 0xDA;
    // Adobe's segment states the colours of the components.
    const ADOBE: u8 = 0xEE;
    let is_text = |kind| kind == COMMENT || (0xE0..=0xEF).contains(&kind) && kind != ADOBE;
    let (mut clean, scans) = clean_header(data, SCAN, is_text)?;
    // This pair cannot occur within a scan: the byte after 0xFF is below 0x80 there.
    let end = scans.windows(2).position(|pair| pair == END).ok_or(CodecFault::Truncated)?;
    clean.extend_from_slice(&scans[..end + 2]);
    Ok(clean)
}

/// JPEG 2000: marker segments of the main header, then the tiles up to the end of the codestream.
fn clean_jpeg_2000(data: &[u8]) -> Result<Vec<u8>, CodecFault> {
    const COMMENT: u8 = 0x64;
    const TILE: u8 = 0x90;
    let (mut clean, tiles) = clean_header(data, TILE, |kind| kind == COMMENT)?;
    let end = tiles.windows(2).rposition(|pair| pair == END).ok_or(CodecFault::Truncated)?;
    clean.extend_from_slice(&tiles[..end + 2]);
    Ok(clean)
}

/// The header up to the first segment of a kind, without segments of text; then the unchanged rest.
fn clean_header(
    data: &[u8],
    first: u8,
    is_text: impl Fn(u8) -> bool,
) -> Result<(Vec<u8>, &[u8]), CodecFault> {
    let mut clean = data[..2].to_vec();
    let mut at = 2;
    loop {
        let next = header_segment(data, at)?;
        // The marker and the length stand before the body; fill bytes before them may be dropped.
        let start = next.end - next.body.len() - 4;
        if next.kind == first {
            return Ok((clean, &data[start..]));
        }
        if !is_text(next.kind) {
            clean.extend_from_slice(&data[start..next.end]);
        }
        at = next.end;
    }
}

#[cfg(test)]
mod tests {
    use super::cleaned;
    use crate::error::Codec;

    fn segment(marker: u8, body: &[u8]) -> Vec<u8> {
        [&[0xFF, marker], &(body.len() as u16 + 2).to_be_bytes()[..], body].concat()
    }

    #[test]
    fn comments_and_application_segments_are_removed_and_the_picture_is_kept() {
        let (frame, scan) = (segment(0xC3, &[8; 9]), segment(0xDA, &[1; 6]));
        let pixels = [1, 2, 0xFF, 0, 3, 0xFF, 0xD9];
        let with = [
            &[0xFF, 0xD8][..],
            &segment(0xE0, b"JFIF DOE"),
            &segment(0xE1, b"Exif DOE"),
            &frame,
            &segment(0xFE, b"DOE^JANE"),
            &scan,
            &pixels,
            b"DOE after the end",
        ]
        .concat();
        let without = [&[0xFF, 0xD8][..], &frame, &scan, &pixels].concat();
        // In one fragment or in several.
        let halves = [with[..20].to_vec(), with[20..].to_vec()];
        assert_eq!(cleaned(Codec::Jpeg, &[with]).expect("sound"), without);
        assert_eq!(cleaned(Codec::Jpeg, &halves).expect("sound"), without);
    }

    #[test]
    fn comments_in_the_main_header_of_jpeg_2000_are_removed() {
        let size = segment(0x51, &[0; 36]);
        let tile = [0xFF, 0x90, 0, 10, 0, 0, 0, 0, 0, 0, 0, 1, 0xFF, 0x93, 7, 7, 0xFF, 0xD9];
        let with =
            [&[0xFF, 0x4F][..], &size, &segment(0x64, b"\0\x01DOE^JANE"), &tile, b"DOE"].concat();
        let without = [&[0xFF, 0x4F][..], &size, &tile].concat();
        assert_eq!(cleaned(Codec::Jpeg2000, &[with]).expect("sound"), without);
    }

    #[test]
    fn unknown_streams_are_refused() {
        assert!(cleaned(Codec::Jpeg, &[vec![0xFF, 0xD8, 0xFF, 0xE0, 0xFF]]).is_err());
        assert!(cleaned(Codec::Jpeg2000, &[b"\0\0\0\x0cjP  \r\n\x87\n".to_vec()]).is_err());
        assert!(cleaned(Codec::JpegLs, &[b"DOE^JANE".to_vec()]).is_err());
    }
}
