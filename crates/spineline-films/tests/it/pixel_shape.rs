//! Shapes of pixels as files state them: pairs in every spelling, Pixel Aspect Ratio, resolutions of pictures; and
//! files of several pictures.

use spineline::measure::SpacingPlane;
use spineline_films::{
    Codec, CodecFault, DeidOptions, FilmError, FilmFile, FilmKind, FilmLimits, FilmRemark,
    deidentify, spacing_question,
};
use spineline_marking::judge_spacing;

use crate::maker::{EXPLICIT, Maker};
use crate::reading::read;

const PIXEL_SPACING: (u16, u16) = (0x28, 0x30);
const ASPECT: (u16, u16) = (0x28, 0x34);

fn film(texts: &[((u16, u16), &'static str, &str)]) -> FilmFile {
    let mut maker = Maker::new(2, 2, &[0; 4]);
    for (tag, vr, text) in texts {
        maker.text(*tag, vr, text);
    }
    read(&maker.file(EXPLICIT)).expect("a film")
}

fn question(film: &FilmFile) -> Option<String> {
    spacing_question(&film.tags, &film.remarks)
}

#[test]
fn a_spacing_that_can_be_meant_in_one_way_is_read_with_its_text() {
    for text in ["0.500,0.250", "0,5\\0,25", "0,5;0,25", "0.5 0.25", "0,500,0,250"] {
        let film = film(&[(PIXEL_SPACING, "DS", text)]);
        assert_eq!(film.tags.spacing.pixel_mm, Some([0.5, 0.25]), "{text}");
        let said = film.remarks[0].to_string();
        assert!(said.contains(&format!("`{text}`")) && said.contains("--spacing"), "{said}");
        assert_eq!(question(&film), None, "{text}");
    }
}

#[test]
fn a_spacing_that_cannot_be_read_is_asked_for_with_its_text() {
    for text in
        ["0.5", "0,5", "1,2", "0.5\\0.25\\1", "nan\\nan", "inf\\inf", "1e400\\1", "0.5mm\\0.5mm"]
    {
        let film = film(&[(PIXEL_SPACING, "DS", text)]);
        assert_eq!(film.tags.spacing.pixel_mm, None, "{text}");
        let asked = question(&film).expect(text);
        let is_shown = text.bytes().all(|b| !b.is_ascii_alphabetic() || b == b'e' || b == b'm');
        assert_eq!(asked.contains(&format!("`{text}`")), is_shown, "{asked}");
        assert!(asked.contains("PixelSpacing (0028,0030)"), "{asked}");
    }
    for text in ["0\\0", "0.5\\0", "-0.5\\0.25"] {
        let asked = question(&film(&[(PIXEL_SPACING, "DS", text)])).expect(text);
        assert!(asked.contains("Pixel Spacing is") && asked.contains(text), "{asked}");
    }
    // Another spacing replaces it, and a name in the wrong place is not shown.
    let other = film(&[(PIXEL_SPACING, "DS", "0.5"), ((0x18, 0x1164), "DS", "0.2\\0.2")]);
    assert_eq!(question(&other), None);
    let named = film(&[(PIXEL_SPACING, "DS", "DOE^JANE")]);
    assert!(!format!("{:?}", named.remarks).contains("DOE"), "{:?}", named.remarks);
}

#[test]
fn a_pixel_aspect_ratio_gives_angles_without_a_spacing_and_is_compared_with_one() {
    // PS3.3, C.7.6.3.1.7: the vertical size comes first.
    let alone = film(&[(ASPECT, "IS", "1\\2")]);
    let spacing = judge_spacing(&alone.tags.spacing).spacing.expect("a shape");
    assert_eq!((spacing.aspect(), spacing.plane), (0.5, SpacingPlane::Pixels));
    assert_eq!(question(&alone), None);
    let agrees = film(&[(ASPECT, "IS", "1\\2"), (PIXEL_SPACING, "DS", "0.25\\0.5")]);
    assert_eq!(question(&agrees), None);
    let differs = film(&[(ASPECT, "IS", "1\\2"), (PIXEL_SPACING, "DS", "0.5\\0.5")]);
    let asked = question(&differs).expect("a contradiction");
    assert!(asked.contains("1.000") && asked.contains("0.500"), "{asked}");
    let odd = film(&[(ASPECT, "IS", "1:2")]);
    assert_eq!(judge_spacing(&odd.tags.spacing).spacing.map(|s| s.aspect()), Some(0.5));
    for bad in ["2", "0\\1", "1\\0", "1\\-1", "1\\100"] {
        assert!(question(&film(&[(ASPECT, "IS", bad)])).is_some(), "{bad}");
    }
}

/// A grey PNG with these chunks before its pixels.
fn png(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let grey = image::GrayImage::from_raw(3, 2, vec![9; 6]).expect("pixels");
    let mut file = std::io::Cursor::new(Vec::new());
    grey.write_to(&mut file, image::ImageFormat::Png).expect("a picture");
    let bytes = file.into_inner();
    // Signature and IHDR have 33 bytes.
    let mut with = bytes[..33].to_vec();
    for (name, data) in chunks {
        with.extend((data.len() as u32).to_be_bytes());
        let body = [&name[..], data].concat();
        with.extend(&body);
        with.extend(crc(&body).to_be_bytes());
    }
    with.extend(&bytes[33..]);
    with
}

/// CRC-32 of PNG, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |mut crc, byte| {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        }
        crc
    })
}

fn phys(across: u32, down: u32, unit: u8) -> Vec<u8> {
    [&across.to_be_bytes()[..], &down.to_be_bytes(), &[unit]].concat()
}

/// A TIFF of 3 × 2 grey pixels for each pair of resolutions; `kind` is its `NewSubfileType`.
fn tiff(pages: &[([u32; 2], u16, u32)], big_endian: bool) -> Vec<u8> {
    let two = |value: u16| if big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
    let four = |value: u32| if big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
    let mut bytes = if big_endian { b"MM".to_vec() } else { b"II".to_vec() };
    bytes.extend(two(42));
    bytes.extend(four(8));
    for (i, ([across, down], unit, kind)) in pages.iter().enumerate() {
        let start = bytes.len() as u32;
        let (pixels, ratios) = (start + 2 + 12 * 12 + 4, start + 2 + 12 * 12 + 4 + 6);
        let entries = [
            (254, 4, *kind),
            (256, 4, 3),
            (257, 4, 2),
            (258, 3, 8),
            (259, 3, 1),
            (262, 3, 1),
            (273, 4, pixels),
            (278, 4, 2),
            (279, 4, 6),
            (282, 5, ratios),
            (283, 5, ratios + 8),
            (296, 3, u32::from(*unit)),
        ];
        bytes.extend(two(12));
        for (tag, form, value) in entries {
            bytes.extend([two(tag), two(form)].concat());
            bytes.extend(four(1));
            if form == 3 {
                bytes.extend([two(value as u16), two(0)].concat());
            } else {
                bytes.extend(four(value));
            }
        }
        let next = if i + 1 < pages.len() { ratios + 16 } else { 0 };
        bytes.extend(four(next));
        bytes.extend([9; 6]);
        for value in [*across, 1, *down, 1] {
            bytes.extend(four(value));
        }
    }
    bytes
}

/// A `BigTIFF` of 3 × 2 grey pixels.
fn big_tiff() -> Vec<u8> {
    const PIXELS: u64 = 16 + 8 + 8 * 20 + 8;
    let mut bytes = b"II+\0\x08\0\0\0".to_vec();
    bytes.extend([16_u64, 8].map(u64::to_le_bytes).concat());
    let entries = [
        (256, 4, 3),
        (257, 4, 2),
        (258, 3, 8),
        (259, 3, 1),
        (262, 3, 1),
        (273, 4, PIXELS),
        (278, 4, 2),
        (279, 4, 6),
    ];
    for (tag, form, value) in entries {
        bytes.extend([tag, form].map(u16::to_le_bytes).concat());
        bytes.extend([1, value].map(u64::to_le_bytes).concat());
    }
    bytes.extend([0; 8]);
    bytes.extend([9; 6]);
    bytes
}

#[test]
fn a_large_tiff_is_read() {
    let film = read(&big_tiff()).expect("a picture");
    assert_eq!((film.kind, film.columns, film.rows), (FilmKind::Tiff, 3, 2));
    assert_eq!(film.stored.iter().collect::<Vec<_>>(), [9; 6]);
}

/// A JPEG whose JFIF segment states this.
fn jpeg(unit: u8, across: u16, down: u16) -> Vec<u8> {
    let grey = image::GrayImage::from_raw(8, 8, vec![9; 64]).expect("pixels");
    let mut file = std::io::Cursor::new(Vec::new());
    grey.write_to(&mut file, image::ImageFormat::Jpeg).expect("a picture");
    let mut bytes = file.into_inner();
    assert_eq!(&bytes[6..10], b"JFIF");
    bytes[13] = unit;
    bytes[14..16].copy_from_slice(&across.to_be_bytes());
    bytes[16..18].copy_from_slice(&down.to_be_bytes());
    bytes
}

#[test]
fn unequal_resolutions_give_the_shape_of_a_pixel() {
    // Twice as many pixels across as down: each is twice as high as wide.
    let pictures = [
        png(&[(b"pHYs", &phys(4000, 2000, 1))]),
        png(&[(b"pHYs", &phys(2, 1, 0))]),
        tiff(&[([300, 150], 2, 0)], false),
        tiff(&[([300, 150], 3, 0)], true),
        tiff(&[([2, 1], 1, 0)], true),
        jpeg(1, 300, 150),
        jpeg(0, 2, 1),
    ];
    for (i, bytes) in pictures.iter().enumerate() {
        let film = read(bytes).expect("a picture");
        let spacing = judge_spacing(&film.tags.spacing).spacing.expect("a shape");
        assert!((spacing.aspect() - 2.0).abs() < 1e-12, "{i}: {spacing:?}");
        assert_eq!(spacing.plane, SpacingPlane::Pixels);
        let said = film.remarks.iter().find(|r| matches!(r, FilmRemark::UnequalResolution(_)));
        let said = said.expect("a remark").to_string();
        assert!(said.contains("across") && said.contains("--spacing"), "{said}");
        for end in 0..bytes.len() {
            // Anything but a panic.
            let _ = read(&bytes[..end]).is_ok();
        }
    }
}

#[test]
fn a_picture_of_a_film_keeps_the_shape_of_the_pixels_and_the_word_synthetic() {
    for (origin, is_phantom) in [("YES", true), ("NO", false)] {
        // Rows at twice the distance of columns, on the detector.
        let dicom = film(&[((0x18, 0x1164), "DS", "0.2\\0.1"), ((0x28, 0x300), "CS", origin)]);
        let shown = dicom.display(None, false);
        let options =
            DeidOptions { case_id: "P07".to_owned(), salt: [7; 32], retain_sex_and_age: false };
        let preview = shown.to_png();
        let clean = deidentify(&preview, &options, &FilmLimits::default()).expect("a picture");
        for bytes in [&preview, &clean.bytes] {
            let picture = read(bytes).expect("a picture");
            let spacing = judge_spacing(&picture.tags.spacing).spacing.expect("a shape");
            assert!((spacing.aspect() - 2.0).abs() < 1e-6, "{spacing:?}");
            // The millimetres of the detector are not the patient's.
            assert_eq!(spacing.plane, SpacingPlane::Pixels);
            assert_eq!(picture.tags.is_phantom, is_phantom);
            assert!(picture.stored.iter().eq(shown.grey.iter().map(|&grey| i32::from(grey))));
        }
        let small = read(&shown.thumbnail(2, 2.0).to_png()).expect("a picture");
        assert_eq!((small.tags.spacing.pixel_aspect, small.tags.is_phantom), (None, is_phantom));
    }
}

#[test]
fn an_equal_resolution_is_said_and_not_used_and_one_without_a_meaning_is_neither() {
    let of = |bytes: &[u8]| {
        let film = read(bytes).expect("a picture");
        assert_eq!(judge_spacing(&film.tags.spacing).spacing, None);
        let said = film.remarks.iter().find(|r| matches!(r, FilmRemark::ResolutionNotUsed(_)));
        said.map(ToString::to_string)
    };
    let said = of(&tiff(&[([300, 300], 2, 0)], false)).expect("a remark");
    assert!(said.contains("--spacing 0.0847,0.0847,unknown"), "{said}");
    for bytes in [
        png(&[(b"pHYs", &phys(2835, 2835, 1))]),
        png(&[(b"pHYs", &phys(1, 1, 0))]),
        tiff(&[([72, 72], 2, 0)], true),
        tiff(&[([0, 0], 2, 0)], true),
        jpeg(1, 96, 96),
        jpeg(0, 1, 1),
    ] {
        assert_eq!(of(&bytes), None);
    }
}

#[test]
fn a_truncated_a_damaged_and_an_unsupported_picture_are_told_apart_with_advice_for_pictures() {
    use image::ImageFormat::{Jpeg, Png, Tiff};
    let noise = |place: u32| (place.wrapping_mul(2_654_435_761) >> 24) as u8;
    let grey = image::GrayImage::from_raw(64, 48, (0..64 * 48).map(noise).collect());
    let grey = grey.expect("pixels");
    let said = |bytes: &[u8], of: &[CodecFault]| {
        let error = read(bytes).expect_err("no picture");
        let FilmError::Codec { codec: Codec::Raster, fault } = error else { panic!("{error}") };
        assert!(of.contains(&fault), "{error}");
        error.help()
    };
    for format in [Jpeg, Png, Tiff] {
        let mut file = std::io::Cursor::new(Vec::new());
        grey.write_to(&mut file, format).expect("a picture");
        let mut bytes = file.into_inner();
        // A decoder of JPEG invents the rest of the picture.
        let cut = &bytes[..bytes.len() * 3 / 4];
        assert!(said(cut, &[CodecFault::Truncated]).starts_with("copy the picture again"));
        if format == Png {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 0x55;
            assert!(said(&bytes, &[CodecFault::Corrupt]).starts_with("copy the picture again"));
        }
    }
    // Samples of 12 and of 32 bits.
    for bits in [12, 32] {
        let mut bytes = tiff(&[([300, 300], 2, 0)], false);
        let entry = [2, 1, 3, 0, 1, 0, 0, 0, 8];
        let place = bytes.windows(9).position(|nine| nine == entry).expect("BitsPerSample");
        bytes[place + 8] = bits;
        assert!(said(&bytes, &[CodecFault::Unsupported]).contains("PNG"), "{bits}");
    }
}

#[test]
fn a_jpeg_without_its_end_is_read_with_a_remark_where_all_rows_are_there() {
    let noise = |place: u32| (place.wrapping_mul(2_654_435_761) >> 24) as u8;
    let grey = image::GrayImage::from_raw(64, 48, (0..64 * 48).map(noise).collect());
    let mut file = std::io::Cursor::new(Vec::new());
    let written = grey.expect("pixels").write_to(&mut file, image::ImageFormat::Jpeg);
    written.expect("a picture");
    let bytes = file.into_inner();
    let whole = read(&bytes).expect("a picture");
    assert!(!whole.remarks.contains(&FilmRemark::EndMissing));
    // Oracle: the end of a JPEG is its last two bytes.
    for missing in [1, 2] {
        let cut = read(&bytes[..bytes.len() - missing]).expect("all rows");
        assert_eq!(cut.stored, whole.stored, "{missing}");
        assert!(cut.remarks.contains(&FilmRemark::EndMissing), "{missing}");
    }
    // 40 bytes are less than one of 48 blocks of noise, in the last row.
    let fault = CodecFault::Truncated;
    let truncated = Err(FilmError::Codec { codec: Codec::Raster, fault });
    assert_eq!(read(&bytes[..bytes.len() - 40]), truncated);
    // Between two restart intervals nothing shows whether more of them follow.
    let restarts = [&bytes[..2], &[0xFF, 0xDD, 0, 4, 0xFF, 0xFF], &bytes[2..]].concat();
    assert!(read(&restarts).is_ok());
    assert_eq!(read(&restarts[..restarts.len() - 2]), truncated);
}

#[test]
fn a_file_of_several_pictures_is_refused_with_their_number() {
    let page = ([300, 300], 2, 0);
    for (bytes, frames) in [
        (tiff(&[page; 2], false), 2),
        (tiff(&[page; 3], true), 3),
        (png(&[(b"acTL", &[0, 0, 0, 2, 0, 0, 0, 0])]), 2),
    ] {
        assert_eq!(read(&bytes), Err(FilmError::Frames { frames }));
    }
    // A copy at a lower resolution and a mask are not counted.
    let with_copy = tiff(&[page, ([30, 30], 2, 1), ([300, 300], 2, 4)], false);
    assert!(read(&with_copy).is_ok());
}
