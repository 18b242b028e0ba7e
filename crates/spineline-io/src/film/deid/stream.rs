//! Compressed pictures without what is no picture: comments and the segments of applications, which may name anybody.

use super::super::error::{Codec, CodecFault, FilmError};

/// The one compressed picture of a film, its fragments joined, without comments, segments of applications, and what
/// follows its end. Run lengths hold nothing else than pixels and come back as they are.
///
/// # Errors
/// [`FilmError::Codec`] where the headers do not hold together: what cannot be followed cannot be cleaned.
pub(super) fn cleaned(fragments: &[Vec<u8>]) -> Result<Option<Vec<u8>>, FilmError> {
    let joined = fragments.concat();
    let (codec, clean) = match joined.get(..4) {
        Some([0xFF, 0xD8, 0xFF, _]) => (Codec::Jpeg, clean_jpeg(&joined)),
        Some([0xFF, 0x4F, 0xFF, 0x51]) => (Codec::Jpeg2000, clean_jpeg_2000(&joined)),
        // The boxes of a JP2 file, which DICOM does not allow around the picture.
        Some([0, 0, 0, 0x0C]) if joined.get(4..8) == Some(b"jP  ") => (Codec::Jpeg2000, None),
        _ => return Ok(None),
    };
    match clean {
        Some(clean) => Ok(Some(clean)),
        None => Err(FilmError::Codec { codec, fault: CodecFault::Header }),
    }
}

/// JPEG and JPEG-LS: marker segments up to the first scan, then the scans up to the end of the image.
fn clean_jpeg(data: &[u8]) -> Option<Vec<u8>> {
    const COMMENT: u8 = 0xFE;
    const SCAN: u8 = 0xDA;
    // Adobe's says which colours the components are.
    const ADOBE: u8 = 0xEE;
    let mut clean = data.get(..2)?.to_vec();
    let mut at = 2;
    loop {
        let [0xFF, marker] = *data.get(at..at + 2)?.first_chunk()? else { return None };
        if marker == 0xFF {
            // Fill bytes may stand before a marker.
            at += 1;
            continue;
        }
        if marker == SCAN {
            break;
        }
        let length = usize::from(u16::from_be_bytes(*data.get(at + 2..at + 4)?.first_chunk()?));
        let segment = data.get(at..at + 2 + length).filter(|_| length >= 2)?;
        let is_application = (0xE0..=0xEF).contains(&marker) && marker != ADOBE;
        if marker != COMMENT && !is_application {
            clean.extend_from_slice(segment);
        }
        at += segment.len();
    }
    let scans = &data[at..];
    // Within a scan no such pair can stand: what follows 0xFF there is below 0x80.
    let end = scans.windows(2).position(|pair| pair == [0xFF, 0xD9])?;
    clean.extend_from_slice(&scans[..end + 2]);
    Some(clean)
}

/// JPEG 2000: marker segments of the main header, then the tiles up to the end of the codestream.
fn clean_jpeg_2000(data: &[u8]) -> Option<Vec<u8>> {
    const COMMENT: [u8; 2] = [0xFF, 0x64];
    const TILE: [u8; 2] = [0xFF, 0x90];
    let mut clean = data.get(..2)?.to_vec();
    let mut at = 2;
    loop {
        let marker: [u8; 2] = *data.get(at..at + 2)?.first_chunk()?;
        if marker == TILE {
            break;
        }
        let length = usize::from(u16::from_be_bytes(*data.get(at + 2..at + 4)?.first_chunk()?));
        let segment = data.get(at..at + 2 + length).filter(|_| length >= 2 && marker[0] == 0xFF)?;
        if marker != COMMENT {
            clean.extend_from_slice(segment);
        }
        at += segment.len();
    }
    let tiles = &data[at..];
    let end = tiles.windows(2).rposition(|pair| pair == [0xFF, 0xD9])?;
    clean.extend_from_slice(&tiles[..end + 2]);
    Some(clean)
}

#[cfg(test)]
mod tests {
    use super::cleaned;

    fn segment(marker: u8, body: &[u8]) -> Vec<u8> {
        [&[0xFF, marker], &(body.len() as u16 + 2).to_be_bytes()[..], body].concat()
    }

    #[test]
    fn comments_and_applications_go_and_the_picture_stays() {
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
        assert_eq!(cleaned(&[with]).expect("sound").expect("JPEG"), without);
        assert_eq!(cleaned(&halves).expect("sound").expect("JPEG"), without);
    }

    #[test]
    fn comments_of_jpeg_2000_go_from_its_main_header() {
        let size = segment(0x51, &[0; 36]);
        let tile = [0xFF, 0x90, 0, 10, 0, 0, 0, 0, 0, 0, 0, 1, 0xFF, 0x93, 7, 7, 0xFF, 0xD9];
        let with =
            [&[0xFF, 0x4F][..], &size, &segment(0x64, b"\0\x01DOE^JANE"), &tile, b"DOE"].concat();
        let without = [&[0xFF, 0x4F][..], &size, &tile].concat();
        assert_eq!(cleaned(&[with]).expect("sound").expect("JPEG 2000"), without);
    }

    #[test]
    fn what_cannot_be_followed_is_refused_and_run_lengths_are_left_alone() {
        assert!(cleaned(&[vec![0xFF, 0xD8, 0xFF, 0xE0, 0xFF]]).is_err());
        assert!(cleaned(&[b"\0\0\0\x0cjP  \r\n\x87\n".to_vec()]).is_err());
        assert_eq!(cleaned(&[vec![2, 0, 0, 0, 64]]).expect("no headers"), None);
    }
}
